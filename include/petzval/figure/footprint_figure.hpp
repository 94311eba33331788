// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// The vignetted pupil of each field, as SVG text. A cell shows the region of the PupilPlane that passes, its boundary
/// in a colour for each limiting surface, and the paraxial entrance pupil dashed. All cells have the same scale, x to
/// the right and +y up. The area over that on the axis and the relative illumination are printed below. Where the pupil
/// lies far from the paraxial one, the cell shows the pupil and prints the distance.
///
/// At the primary wavelength. The same lens gives the same bytes.
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does, and for no fields.
PETZVAL_API std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad);

}  // namespace petzval::inline v0
