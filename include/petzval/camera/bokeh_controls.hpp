// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/iris/iris_weights.hpp"

namespace petzval::inline v0 {

/// What an artist asks of a bokeh, by the names of "Recreating realistic bokeh by biasing lens-sample positions", 2017.
/// Every model of a Camera takes it; the defaults change nothing.
///
/// Weights act on the stop, where exact rays meet it: in exact models and polynomials on the real one, also of a
/// vignetted pupil; in first-order models on its image. Those of two discs, of a renderer's own model and of a lens
/// without a stop act on the pupil of each film point instead, so that a cat's eye has a rim of its own.
///
/// Samples follow the weights (EdgeWeight): where the stop is the pupil, all rays of a film point weigh within 1 % the
/// same; of a map, as far as 256 x 256 cells of the iris show it. Behind real lenses a quarter of the samples is
/// uniform, which bounds the weights where pupils are vignetted. A weight follows the stop on the scene's side too.
struct BokehControls {
  int lens_elements = 0;  ///< straight blades in place of the lens's own iris, 3 to 20; 0: that iris
  double weight_distribution = 0, weight_strength = 0.5;  ///< EdgeWeight
  IrisMap weight_map{};                                   ///< empty: none

  EdgeWeight edge() const noexcept { return {weight_distribution, weight_strength}; }
};

}  // namespace petzval::inline v0
