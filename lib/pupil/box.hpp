// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/common.hpp>
#include <limits>

#include "petzval/core/geometry.hpp"

namespace petzval::pupil_detail {

/// The smallest box, parallel to the axes, around some positions in a plane.
struct Box {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec2<double> low{infinity, infinity}, high{-infinity, -infinity};

  void take(const Vec2<double>& p) noexcept { low = glm::min(low, p), high = glm::max(high, p); }
  bool empty() const noexcept { return low.x > high.x; }
  Vec2<double> middle() const noexcept { return (low + high) / 2.0; }
  Vec2<double> half() const noexcept { return (high - low) / 2.0; }
};

}  // namespace petzval::pupil_detail
