// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::detail {

/// The film plane as a ray that left the lens sees it.
class Film {
 public:
  explicit Film(const Lens& lens) : z_(lens.film_z()) {
    for (const LensSurface& surface : lens.surfaces()) {
      if (surface.mirror) sense_ = -sense_;
    }
  }

  /// Where the ray meets the film; nothing if it runs away from it or along it. A film in front of the last surface is
  /// met in the ray's continuation backwards.
  std::optional<std::array<double, 2>> meet(const Ray<double>& ray) const noexcept {
    if (!(ray.direction.z * sense_ > 0)) return {};
    const double t = (z_ - ray.origin.z) / ray.direction.z;
    const double x = ray.origin.x + t * ray.direction.x, y = ray.origin.y + t * ray.direction.y;
    if (!std::isfinite(x) || !std::isfinite(y)) return {};
    return std::array{x, y};
  }

 private:
  double z_;
  double sense_ = 1;
};

}  // namespace petzval::detail
