// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

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
/// beam, or if the entrance pupil lies at infinity. compile() computes apertures in the same way, for its configuration
/// and wavelengths; readers of files call this function.
///
/// @param prescription  the prescription
/// @param options       glasses, and the treatment of missing glasses; the wavelength is the primary one of the design,
///                      or else the reference wavelength
/// @return              the prescription; `semi_diameter_computed` is true in rows with a computed aperture
/// @throws Error        if compile() does
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
