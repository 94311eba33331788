// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Two discs whose overlap approximates the pupils of a lens's film points, in the terms of BokehControls. The smaller
/// disc is the pupil, the larger one the second rim.
struct TwoDiscs {
  double lens_ratio = 1;
  /// For a film whose longer side is 2 * film_radius; negative if the larger disc moves in the direction of the film
  /// point.
  double rate_of_change = 0;
  /// Area between the edges of pupil and overlap, divided by the pupil's area, at these distances from the axis: equal
  /// steps of film area from 0 to the end of the light. For edges that cross, as of thin cat's eyes, distances along
  /// the normals count.
  std::vector<double> film_mm, errors;
  double error = 0;  ///< mean of errors
};

/// Fits two discs to the pupils of a lens with its stop taken as round.
///
/// ModelKind::thin_two_disc uses the same fit, scaled to the exact exposure.
///
/// @param lens         the lens
/// @param film_radius  largest distance of a film point from the axis (mm); above 0
/// @param wavelength   a compiled wavelength
/// @throws Error       if the lens has cylinders, has no pupils or passes no light, if the wavelength is not compiled,
///                     or if film_radius is not positive and finite
///
/// Accuracy: the mean error is below 3 % for the double Gauss 100 mm f/2 and f/1.35 and a Tessar on 36 x 24 mm, and for
/// a fisheye of 156 degrees up to 11 mm (tests/camera/two_discs_test.cpp). Faster or shorter lenses have 3 to 5 %. If
/// the light ends within the film, or pupils move as in a fisheye of 180 degrees, it is 5 to 7 %.
///
/// Limitations: the fit holds for film points. A far scene point sees a larger pupil, and its blur has the shape of
/// this pupil. The area on the axis is 3 % (Tessar 100 mm f/2.8), 6 % (double Gauss 100 mm f/2) or 14 % (f/1.35) too
/// large, because the real pupil of a corrected lens is a sphere about the focus and not a disc. Over the field, the
/// area between the edges of both is 3 to 18 % of the pupil's area.
PETZVAL_API TwoDiscs fit_two_discs(const Lens& lens, double film_radius, Wavelength wavelength = {});

}  // namespace petzval
