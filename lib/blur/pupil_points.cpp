// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "core/text.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"

namespace petzval {

std::vector<PupilPoint> vogel_points(int count, double turn) {
  if (count < 1 || count > (1 << 20)) {
    throw Error("vogel_points: " + std::to_string(count) + " points; must be 1 to " + std::to_string(1 << 20));
  }
  if (!std::isfinite(turn)) throw Error("vogel_points: turn = " + to_text(turn) + "; must be finite");
  constexpr double golden = 0.38196601125010515;  // turns; 2 minus the golden ratio
  std::vector<PupilPoint> points(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double u = i * golden + turn;
    points[static_cast<std::size_t>(i)] = {u - std::floor(u), (i + 0.5) / count};
  }
  return points;
}

std::vector<PupilPoint> vogel_sets(int count, int sets) {
  if (sets < 1 || count < 1 || count > (1 << 20) / sets) {
    throw Error("vogel_sets: " + std::to_string(sets) + " sets of " + std::to_string(count) +
                " points; must be 1 or more of each, and " + std::to_string(1 << 20) + " points at most in all");
  }
  std::vector<PupilPoint> points;
  for (int set = 0; set < sets; ++set) {
    // The radii and directions of a set lie between the radii and directions of the other sets.
    const double outwards = ((set + 0.5) / sets - 0.5) / count;
    for (const PupilPoint& p : vogel_points(count, static_cast<double>(set) / sets)) {
      points.push_back({p.u, p.v + outwards});
    }
  }
  return points;
}

}  // namespace petzval
