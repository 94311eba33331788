// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// The pupil that each field sees, as SVG text: a cell with the region of the entrance-pupil plane that passes, its
/// edge in a colour for each surface that limits there, and dashed the paraxial entrance pupil. All cells have one
/// scale, x to the right and +y up, seen as the PupilPlane is laid; below each stand its area over that of the axis,
/// and the relative illumination. Where the pupil has moved far from its paraxial place, the cell shows the pupil and
/// says how far.
///
/// At the compiled wavelength nearest to the d line. The same lens gives the same bytes.
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does, and for no fields.
PETZVAL_API std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad);

}  // namespace petzval::inline v0
