// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "design.hpp"
#include "files.hpp"
#include "load_lens.hpp"
#include "petzval/analysis/report.hpp"
#include "petzval/io/lint.hpp"

namespace examples {

/// One number of the report: its label and unit in the table.
struct Entry {
  std::string label;
  const char* unit;
  double value;
};

/// The conditions of a report: subject, film, light and fields.
struct ReportSubject {
  double distance_mm = std::numeric_limits<double>::infinity();  ///< subject distance from the origin of `focus`, mm
  bool distance_of_file = false;
  petzval::FocusOptions focus{};
  bool film_of_file = true;
  ReportLight light{};
  ReportFields fields{};
};

struct Report {
  LoadedLens loaded;  ///< at the primary wavelength of the light, with its stop and film
  ReportSubject subject;
  std::optional<DeclaredPupil> declared_pupil;
  petzval::LensReport first_order;         ///< of `loaded`, without fields
  std::vector<petzval::Finding> findings;  ///< messages with surface_number()

  const petzval::LensReport::Section& main() const { return first_order.sections.front(); }
  /// The number of a surface in texts and JSON.
  int surface_number(std::size_t index) const { return static_cast<int>(index) + loaded.first_surface_number; }
};

/// Builds the report. declared_pupil: the pupil of the unmodified lens by the aperture that the file declares.
Report report(LoadedLens loaded, ReportSubject subject, const std::optional<DeclaredPupil>& declared_pupil);

/// z of the subject in the frame of a focused lens, mm; -inf at infinity.
double subject_z(const ReportSubject& subject, const petzval::Lens& lens);

/// "subject at infinity (as in the file); film as in the file".
std::string in_words(const ReportSubject& subject);
/// "486.133 nm (weight 1), ..." and "0, 14, 20 degrees".
std::string in_words(const ReportLight& light);
std::string in_words(const ReportFields& fields);

/// The conditions of the report for a lens at all wavelengths of its light.
petzval::LensReport::Conditions conditions(const Report& report, const petzval::Lens& colours);

/// The numbers of one section.
std::vector<Entry> entries(const Report& report, const petzval::LensReport::Section& section);

/// aberrations: lens_report() of the lens at all wavelengths of the light.
Json to_json(const Report& report, const petzval::LensReport& aberrations);
std::string to_text(const Report& report);

/// "y-z" or "x-z".
const char* section_name(petzval::Meridian meridian);
/// The stop: "surface 5", with a remark if it is inferred.
std::string stop_in_words(const Report& report);
/// "surfaces are numbered from 0".
std::string numbering_in_words(const Report& report);
/// Four decimals; scientific notation for very small and large numbers.
std::string in_words(double value);

}  // namespace examples
