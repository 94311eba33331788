// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Sharpness against film position, as SVG text: the RMS spot radius of each field and of all fields together, over the
/// distance of the film from the paraxial focus. Lines mark the paraxial focus, the film, and the minima of the axial
/// spot and of all fields; the numbers are printed below.
///
/// RMS radii are about the centroid, over all compiled wavelengths with equal weight and the vignetted pupil by area.
/// Their square is a parabola in the film position, found from three positions. The same lens gives the same bytes.
///
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does, and for no fields.
PETZVAL_API std::string focus_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad);

}  // namespace petzval::inline v0
