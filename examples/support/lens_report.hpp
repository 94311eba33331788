// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli.hpp"
#include "design.hpp"
#include "files.hpp"
#include "load_lens.hpp"
#include "petzval/analysis/aberrations.hpp"
#include "petzval/analysis/seidel.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/io/lint.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace examples {

/// One number of the report: its key in JSON, its label and unit in the table.
struct Entry {
  const char* key;
  const char* label;
  const char* unit;
  double value;
};

/// First-order data of a lens in one meridian.
struct MeridianReport {
  petzval::Meridian meridian;
  petzval::FirstOrder first_order;
  std::optional<petzval::Pupils> pupils;  ///< nullopt if no rim limits the beam
  std::vector<Entry> entries;
};

/// The conditions of a report: subject, film, light and fields.
struct ReportSubject {
  double distance_mm = std::numeric_limits<double>::infinity();  ///< subject distance from the origin of `focus`, mm
  bool distance_of_file = false;
  FocusFlags focus{};
  bool film_of_file = true;
  ReportLight light{};
  ReportFields fields{};
};

struct Report {
  LoadedLens loaded;  ///< at the primary wavelength of the light, with its stop and film
  ReportSubject subject;
  std::optional<DeclaredPupil> declared_pupil;
  std::vector<MeridianReport> meridians;   ///< main meridian first; only one for a lens of revolution
  std::vector<petzval::Finding> findings;  ///< messages with surface_number()

  const MeridianReport& main() const { return meridians.front(); }
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

/// The object of the report and its largest field, for paraxial rays and Seidel sums.
petzval::ParaxialField largest_field(const ReportSubject& subject, const petzval::Lens& lens);

/// Wavefront errors of each field and wavelength, ordered by field; nullopt if no ray passes. colours: as in to_json().
///
/// @throws petzval::Error under the conditions of petzval::wavefront()
std::vector<std::optional<petzval::Wavefront>> report_wavefronts(const Report& r, const petzval::Lens& colours);

/// The aberrations of a report. A quantity that fails is null, and `failures` holds the reason under its key. colours:
/// as in to_json().
Json exact_aberrations(const Report& report, const petzval::Lens& colours);

/// colours: the lens of the report at all wavelengths of its light, for the chromatic sums.
Json to_json(const Report& report, const petzval::Lens& colours);
/// Seidel sums for the largest field of the report, with colour from the shortest to the longest wavelength; nullopt if
/// the lens has none. colours: as in to_json().
std::optional<petzval::SeidelSums> report_seidel(const Report& report, const petzval::Lens& colours);
/// The rays from the fields of the report for its spots, MTF and encircled energy. colours: as in to_json().
std::vector<petzval::Spot> report_spots(const Report& report, const petzval::Lens& colours);
/// Geometric MTF of report_spots(), 0 to 100 line pairs per mm.
std::vector<petzval::MtfPoint> report_mtf(const Report& report, std::span<const petzval::Spot> spots);
/// Geometric MTF at 10, 20 and 40 line pairs per mm at eleven fields up to the largest field of the report; empty if
/// all fields are 0. colours: as in to_json().
std::vector<petzval::MtfPoint> report_mtf_over_field(const Report& report, const petzval::Lens& colours);
/// Film shifts for spots through focus, mm: two steps to both sides; empty if the spots have no focus.
std::vector<double> report_film_shifts(const Report& report, const petzval::Lens& colours,
                                       std::span<const petzval::Spot> spots);
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
