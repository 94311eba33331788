// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/iris/iris_weights.hpp"

namespace petzval {

/// What an artist asks of a bokeh, by the names of "Recreating realistic bokeh by biasing lens-sample positions", 2017.
/// Every model of a Camera takes it; the defaults change nothing.
///
/// Exact models and polynomials apply the weights on the real stop, also for a vignetted pupil. The stop point of a ray
/// comes from FilmPupilTable::stop_points(): a weight on a narrow ring is off by up to 2 % behind a lens of f/1.35.
/// Other first-order models apply the weights on the image of the stop. The model thin_two_disc behind a round stop,
/// custom models, and lenses whose stop has no rim apply them on the pupil of each film point: a cat's eye then has its
/// own bright rim. The pupils of polynomials have the stop's area and nearly its shape: they keep the light within 1 %
/// up to a distribution of 200, and have 8 % too much at 1000.
///
/// Samples follow the weights (EdgeWeight): where the stop is the pupil, all rays of a film point weigh within 1 % the
/// same, but for the few where weights fall to 0, as of a strength near 1; of a map, as far as 256 x 256 cells of the
/// iris show it. Behind real lenses a quarter of the samples is uniform, which bounds the weights where pupils are
/// vignetted. A weight follows the stop on the scene's side too. In batches a ray takes 11 ns more, with a
/// map 40 to 50 (tests/bench/camera_bench.cpp).
struct BokehControls {
  int lens_elements = 0;  ///< straight blades in place of the lens's own iris, 3 to 20; 0: that iris
  /// The radius of a second rim, which cuts cat's eyes, over that of the pupil on the axis. (In the text's program the
  /// rim has 1 / sqrt of this number.) Error for a rim in a lens with cylinders, and in exact models and polynomials of
  /// a lens with a central obscuration.
  double lens_ratio = 1;
  /// By how many of these radii it moves against the film point from the axis to half of the film's longer side: over
  /// the same length in all directions, so that cat's eyes lie around the axis of a film that is not square, or
  /// shifted. Error where it moves by more than 1e6 radii over the film.
  double rate_of_change = 0;
  /// Weights make up for the area that the rim takes; else light falls with it. (What is left of the pupil of a fast
  /// lens sees the film under other angles: 12 % of an f/2's light are still lost where half of its pupil is, 30 % of
  /// an f/1.1's.)
  bool keep_light = false;
  double weight_distribution = 0, weight_strength = 0.5;  ///< EdgeWeight
  IrisMap weight_map{};                                   ///< empty: none

  bool vignettes() const noexcept { return lens_ratio != 1 || rate_of_change != 0; }
  EdgeWeight edge() const noexcept { return {weight_distribution, weight_strength}; }
};

}  // namespace petzval
