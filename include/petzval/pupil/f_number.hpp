// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/prescription/prescription.hpp"

// | f-number | beam | header |
// |---|---|---|
// | paraxial_f_number() | first order: focal length by entrance pupil | paraxial/first_order.hpp |
// | film_side_f_number() | first order: exit pupil to film by exit pupil | paraxial/first_order.hpp |
// | real_f_number() | exact ray at the rim of the stop; the number of with_f_number() | this |
// | fastest_f_number() | the same, wide open | this |
// | equal_area_f_number() | for with_f_number(): an iris with blades has the area of a round one | iris/iris.hpp |
// | area_f_number() | area of the exact pupil: with blades and obscurations | analysis/transmittance.hpp |
// | ApertureState::t_number | area_f_number() with losses | analysis/transmittance.hpp |

namespace petzval {

/// f-number |EFL| / (2 y), with the entrance height y of the axis-parallel ray that meets the rim of the stop.
///
/// The ray is traced exactly, in the main meridian, from the front to the stop, without clear apertures. If no ray
/// reaches the rim, y is the height of the last ray that reaches the stop. Infinite if the lens is afocal or the stop
/// has radius 0; 0 if y has no limit.
///
/// @throws Error  if pupils() does
PETZVAL_API double real_f_number(const Lens& lens, Wavelength wavelength = {});

/// f-number of the widest axial beam: the limit of with_f_number().
///
/// It equals real_f_number() if the stop has a rim. If the marked stop has no rim, the last axis-parallel ray that
/// reaches the stop sets the limit; 0 if every ray reaches the stop.
///
/// @throws Error  if the lens is afocal or no surface limits the axial beam
PETZVAL_API double fastest_f_number(const Lens& lens, Wavelength wavelength = {});

/// The lens stopped down to the f-number N.
///
/// The axis-parallel ray of height |EFL| / (2 N) meets the new rim of the stop; a marked stop without a rim gets a rim.
/// The lens stays wide open if N is too fast by up to 0.5 % (1e-9 if the marked stop has no rim), because declared
/// f-numbers are rounded; real_f_number() gives the exact value.
///
/// @throws Error  if N is faster than that (fastest_f_number() gives the limit), not positive or not finite; if the
///                lens is afocal or transmits no axial beam; if N is so slow that a central obscuration covers the
///                axial beam; or if no stop gives N, because spherical aberration folds the beam
///
/// Accuracy: real_f_number() returns N within 1e-12.
PETZVAL_API Lens with_f_number(const Lens& lens, double f_number, Wavelength wavelength = {});

/// Computes the clear aperture of each surface without a given one: the smallest aperture that passes the beam.
///
/// Other programs call these automatic semi-diameters or default apertures. The beam fills the stop, for the axis and
/// for fields up to the largest one that the prescription declares: `half_field_deg`, the fields of `design`, or the
/// field whose image lies at half of `image_diagonal_mm`; 20 degrees if it declares no field. Exact rays are aimed at
/// the rim of the stop, or at the last point towards it from which a ray passes the given apertures and the edges of
/// the elements. The heights at which they meet a surface, and 5 % more, are its aperture. For a zoom lens the largest
/// of all positions counts.
///
/// A stop without an aperture gets the one of the f-number or the entrance pupil that the prescription declares, or
/// else of the axial beam that the other apertures and the edges pass. Dummy surfaces, which change no rays, stay
/// unlimited. All surfaces stay unlimited if neither the stop nor another surface nor an f-number limits the axial
/// beam, or if the entrance pupil lies at infinity. compile() and readers of files call this function.
///
/// @param prescription  the prescription
/// @param options       glasses and the policy of indices; n_d and V_d replace missing glasses. The wavelength is the
///                      primary one of the design, or else the reference wavelength
/// @return              the prescription; `semi_diameter_computed` is true in rows with a computed aperture. No
/// aperture
///                      is computed if a medium has no index at these wavelengths
/// @throws Error        if the prescription is invalid
PETZVAL_API Prescription with_apertures(const Prescription& prescription, const CompileOptions& options = {});

/// Angle from the axis under which the entrance pupil sees a field of a design, to first order.
///
/// @param rows   gives the distance of the object
/// @param lens   the lens compiled from `rows`
/// @param kind   kind of the value
/// @param value  field angle (degrees), or object or image height (mm)
/// @return       the angle (rad); nullopt for an object height at infinity, and for an image height of an afocal lens
PETZVAL_API std::optional<double> declared_field(const Prescription& rows, const Lens& lens, FieldKind kind,
                                                 double value);

/// The largest field that a prescription declares (rad): `half_field_deg`, the fields of `design`, or the field whose
/// image lies at half of `image_diagonal_mm`; nullopt if the prescription declares no field.
PETZVAL_API std::optional<double> declared_half_field(const Prescription& rows, const Lens& lens);

}  // namespace petzval
