// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "load_lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"

namespace examples {

/// Wavelengths of a report and their weights.
struct ReportLight {
  std::vector<double> wavelengths_nm, weights;
  double primary_nm = petzval::d_line_nm;
  bool of_file = false;  ///< true: from the file; false: from the command line, or F, d and C
};

/// The wavelengths of the file; by default F, d and C, or only the reference wavelength if a medium has no dispersion.
/// The defaults also replace wavelengths of the file at which a medium has no index, with a note.
ReportLight light_of(const LensFile& file);

/// Fields of a report in degrees towards +y, seen from the paraxial entrance pupil.
struct ReportFields {
  std::vector<double> degrees;
  bool of_file = false;  ///< false: from the command line, or the axis, 0.7 and 1 of half_field_deg()
};

/// The fields of the file as angles at the entrance pupil, without repetitions; by default the axis, 0.7 and 1 of
/// half_field_deg(). For a lens of revolution the angle is the distance of a field from the axis; for other lenses only
/// the fields in the section y-z remain, and a note gives the number of the fields left out.
///
/// @param lens  the lens at the primary wavelength, with the film that image heights refer to
ReportFields fields_of(const LensFile& file, const petzval::Lens& lens);

/// The entrance pupil according to the declared aperture of a file.
struct DeclaredPupil {
  double diameter = 0;  ///< "EPD" of OpticStudio, mm
  double f_number = 0;  ///< |EFL| / diameter, its "Image Space F/#"; infinite for an afocal lens
};

/// The declared pupil by paraxial rays at the wavelength of the lens; nullopt if the file declares no aperture.
std::optional<DeclaredPupil> declared_pupil(const petzval::DesignData& design, const petzval::Lens& lens);

/// True if a ray of the point passes the lens at one of its wavelengths.
bool reached_by_light(const petzval::Lens& lens, const petzval::FieldPoint& point);

/// @throws petzval::Error that names the flag and the field in degrees, if no light of the point passes the lens
void want_light(const petzval::Lens& lens, const petzval::FieldPoint& point, const std::string& flag);

}  // namespace examples
