// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/iris/iris_weights.hpp"

namespace petzval {

/// Artistic controls of the bokeh of a Camera; the defaults change nothing.
///
/// Every ray model supports the controls. Names and formulas follow "Recreating realistic bokeh by biasing lens-sample
/// positions", 2017. Film samples are distributed by the weights; the importance of rays from the scene includes the
/// weights.
///
/// Accuracy: exact models and polynomials weight the points of the real stop (FilmPupilTable::stop_points()); a weight
/// on a narrow ring is off by up to 2 % at f/1.35. Polynomials keep the irradiance within 1 % for distributions up to
/// 200 and are 8 % too bright at 1000.
///
/// Limitations: the model thin_two_disc with a round stop, custom models, and lenses whose stop has no rim apply the
/// weights to the clipped pupil of each film point, so that a cat's eye gets a bright rim of its own. The other
/// first-order models apply them to the paraxial image of the stop.
struct BokehControls {
  int lens_elements = 0;  ///< number of straight blades, 3 to 20; 0: the iris of the lens
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

}  // namespace petzval
