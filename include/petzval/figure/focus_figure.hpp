// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Sharpness against film position, as SVG text: the RMS radius of the spot of each field, and the root of the mean
/// square of all, over shifts of the film from the paraxial focus. Lines mark the paraxial focus, the film, and where
/// the axial spot and the mean are least; the numbers stand below.
///
/// RMS is about the centroid, over all compiled wavelengths with equal weight and the vignetted pupil by area. Its
/// square is a parabola in the film position, exactly, and is known from three. The same lens gives the same bytes.
///
/// subject_z: lens frame, mm, -inf at infinity. Throws Error where pupil_boundary does, and for no fields.
PETZVAL_API std::string focus_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad);

}  // namespace petzval::inline v0
