// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Artistic controls of the bokeh of a Camera; the defaults change nothing.
///
/// Every ray model supports the controls. Names and formulas follow "Recreating realistic bokeh by biasing lens-sample
/// positions", 2017. Film samples are distributed by the weights; the importance of rays from the scene includes the
/// weights.
///
/// Accuracy: exact models and polynomials weight the points of the real stop; a weight on a narrow ring is
/// off by up to 2 % at f/1.35. Polynomials keep the irradiance within 1 % for distributions up to 200 and are 8 % too
/// bright at 1000.
///
/// Limitations: the model thin_two_disc with a round stop, and lenses whose stop has no rim apply the weights
/// to the clipped pupil of each film point, so that a cat's eye gets a bright rim of its own. The other
/// first-order models apply them to the paraxial image of the stop.
struct BokehControls {
  int blades = 0;  ///< number of straight blades, 3 to 20; 0: the iris of the lens
  /// Radius of a second rim that clips the pupils to cat's eyes, divided by the radius of the pupil on the axis. (The
  /// program in the source uses 1 / sqrt of this number.) A Camera throws Error for such a rim if the lens has
  /// cylinders, and in exact models and polynomials if it has a central obscuration.
  double lens_ratio = 1;
  /// Displacement of the second rim, opposite to the film point, at half of the longer side of the film from the axis;
  /// in pupil radii on the axis. The displacement per mm is equal in all directions, so that cat's eyes are symmetric
  /// about the axis on every film. A Camera throws Error if the rim moves by more than 1e6 radii over the film.
  double rate_of_change = 0;
  /// true: the weights compensate for the pupil area that the rim clips. false: the irradiance falls with the area.
  /// Limitations: a clipped pupil sees the film at other angles. With half of the pupil left, the compensated
  /// irradiance is still 12 % too low at f/2 and 30 % at f/1.1.
  bool keep_light = false;
  double weight_distribution = 0, weight_strength = 0.5;  ///< as in EdgeWeight
  IrisMap weight_map{};                                   ///< empty: no map

  /// True if the second rim clips pupils.
  bool vignettes() const noexcept { return lens_ratio != 1 || rate_of_change != 0; }
  EdgeWeight edge() const noexcept { return {weight_distribution, weight_strength}; }
};

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
