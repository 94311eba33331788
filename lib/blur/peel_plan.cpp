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
    throw Error("plan_peel: depths are " + to_text(nearest_mm) + " to " + to_text(farthest_mm) +
                " mm, wanted 0 < nearest < farthest");
  }
  const double nearest = 1 / nearest_mm, farthest = 1 / farthest_mm, reach = rays.reach_px(farthest, nearest);
  if (!(reach <= most_reach_px)) {
    throw Error("plan_peel: rays reach " + to_text(reach) + " px beyond the picture, wanted at most " +
                to_text(most_reach_px) + ": is the nearest depth, " + to_text(nearest_mm) + " mm, right?");
  }
  PeelPlan plan{.camera = rays.camera(), .nearest_mm = nearest_mm, .farthest_mm = farthest_mm};
  // A ray may land half a pixel beside its line, and lies in the tolerance of the next one.
  plan.camera.overscan = static_cast<int>(std::ceil(reach)) + 2;
  // Of a pinhole nothing behind the first layer is seen.
  plan.bias = rays.largest_slope() > 0 ? 1 / rays.largest_slope() : 2 * nearest;
  plan.most_layers = 1 + static_cast<int>(std::min(1e6, (nearest - farthest) / plan.bias));
  return plan;
}

}  // namespace petzval
