// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// The two discs whose overlap is nearest to the pupils of a lens's film points, as BokehControls has them: the smaller
/// one is the pupil.
struct TwoDiscs {
  double lens_ratio = 1;
  /// Over film_radius, as on a film whose longer side ends there; below 0 the larger disc moves with the film point.
  double rate_of_change = 0;
  /// The area between the edges of the pupil and of the overlap, over the pupil's: at film points at these distances
  /// from the axis, equal steps of the film's area from 0 to where the light ends, and their mean. Where edges cross,
  /// as for thin cat's eyes, it counts distances along their normals.
  std::vector<double> film_mm, errors;
  double error = 0;
};

/// Fits the round stop's pupils of a film up to film_radius (mm) from the axis; the camera of two discs
/// (ModelKind::thin_two_disc) uses the same fit, scaled to the real light. Mean error: below 3 % for the
/// double Gauss lenses of 100 mm f/2 and f/1.35 and a Tessar on 36 x 24 mm and a fisheye of 156 degrees up to 11 mm
/// (tests/camera/two_discs_test.cpp), 3 to 5 % for faster or shorter ones, 5 to 7 % where the light ends within the
/// film or pupils move as a fisheye's of 180 degrees do.
///
/// Limit: the fit holds for film points. The pupil that a far point of the scene sees is the shape of its blur. It is
/// larger on the axis by 3 % (Tessar 100 mm f/2.8), 6 % (double Gauss 100 mm f/2) and 14 % (f/1.35) of its area,
/// because the real pupil of a corrected lens is a sphere about the focus and a disc is flat. Over the field the area
/// between the edges of both is 3 to 18 % of the pupil's area. Throws Error for a lens with cylinders, without pupils
/// or dark, a wavelength that is not compiled, and a film_radius that is no length.
PETZVAL_API TwoDiscs fit_two_discs(const Lens& lens, double film_radius, Wavelength wavelength = {});

}  // namespace petzval
