// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "load_lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace examples {

/// Wavelengths of a report and the light in each.
struct ReportLight {
  std::vector<double> wavelengths_nm, weights;
  double primary_nm = petzval::d_line_nm;
  bool of_file = false;  ///< true: from the file; false: from the command line, or F, d and C
};

/// The wavelengths of the file; without any F, d and C, or the reference wavelength alone if a medium has no
/// dispersion. Wavelengths of the file that its media have no index for are left out for the latter, with a note.
ReportLight light_of(const LensFile& file);

/// Fields of a report, degrees towards +y, seen from the paraxial entrance pupil.
struct ReportFields {
  std::vector<double> degrees;
  bool of_file = false;  ///< false: of the command line, or the axis, 0.7 and 1 of half_field_deg()
};

/// The fields of the file as angles at the entrance pupil, each once: of a lens of revolution by their distance from
/// the axis, else those in the section y-z (a note tells if others are left out). Without any the axis, 0.7 and 1 of
/// half_field_deg(). lens: at the primary wavelength, with the film that image heights refer to.
ReportFields fields_of(const LensFile& file, const petzval::Lens& lens);

/// The entrance pupil by the declared aperture of a file.
struct DeclaredPupil {
  double diameter = 0;  ///< "EPD" of OpticStudio, mm
  double f_number = 0;  ///< |EFL| / diameter, its "Image Space F/#"; infinite for an afocal lens
};

/// By paraxial rays at the wavelength of the lens. nullopt without a declared aperture.
std::optional<DeclaredPupil> declared_pupil(const petzval::DesignData& design, const petzval::Lens& lens);

/// True if a ray of a point passes the lens, at one of its wavelengths.
bool reached_by_light(const petzval::Lens& lens, const petzval::FieldPoint& point);

/// Throws petzval::Error that names the flag and the field, in degrees, of a point that no light reaches.
void want_light(const petzval::Lens& lens, const petzval::FieldPoint& point, const std::string& flag);

}  // namespace examples
