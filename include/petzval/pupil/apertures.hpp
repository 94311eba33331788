// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

/// Compiles a prescription for a list of wavelengths.
///
/// Surfaces without a clear aperture get a computed aperture, as by with_apertures().
///
/// @param prescription    the lens; options.configuration selects one of its configurations
/// @param wavelengths_nm  at least one wavelength (nm)
/// @param options         glasses, their treatment, configuration and primary wavelength
/// @throws Error with lens and surface if the prescription is invalid; if a wavelength occurs twice (within
///               1e-6 nm) or lies outside the range of a glass (unless clamp_wavelengths is set); if a glass is missing
///               (see MissingGlass; always if the medium states no index); if an index is outside 0.1 to 5; if
///               primary_nm is not a compiled wavelength
PETZVAL_API Lens compile(const Prescription& prescription, std::span<const double> wavelengths_nm,
                         const CompileOptions& options = {});

/// Compiles a prescription for its reference wavelength only.
PETZVAL_API Lens compile(const Prescription& prescription, const CompileOptions& options = {});

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
///                      aperture is computed if a medium has no index at these wavelengths
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
