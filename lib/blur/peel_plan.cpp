// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"
#include "ray_table.hpp"

namespace petzval {

using blur_detail::most_reach_px;

PeelPlan plan_peel(const LensRays& rays, double nearest_mm, double farthest_mm) {
  if (!(nearest_mm > 0 && nearest_mm < farthest_mm)) {
    throw Error("plan_peel: depths = " + to_text(nearest_mm) + " to " + to_text(farthest_mm) +
                " mm; must be 0 < nearest < farthest");
  }
  const double nearest = 1 / nearest_mm, farthest = 1 / farthest_mm, reach = rays.reach_px(farthest, nearest);
  if (!(reach <= most_reach_px)) {
    throw Error("plan_peel: rays reach " + to_text(reach) + " px beyond the picture; must be at most " +
                to_text(most_reach_px) + " (nearest depth: " + to_text(nearest_mm) + " mm)");
  }
  PeelPlan plan{.camera = rays.camera(), .nearest_mm = nearest_mm, .farthest_mm = farthest_mm};
  // The pixel of a ray may be half a pixel away from its line, and rounding may select the next pixel.
  plan.camera.overscan = static_cast<int>(std::ceil(reach)) + 2;
  // A pinhole sees only the first layer.
  plan.bias = rays.largest_slope() > 0 ? 1 / rays.largest_slope() : 2 * nearest;
  plan.most_layers = 1 + static_cast<int>(std::min(1e6, (nearest - farthest) / plan.bias));
  return plan;
}

}  // namespace petzval
