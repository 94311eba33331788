// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set: see petzval_loops in cmake/module.cmake.
#include "local_focus_loops.hpp"

namespace petzval::inline v0::camera_detail {
namespace {

template <class T>
void bend(const FocusRules<T>& rules, const EntranceMaps<T>& maps, T dispersion, T z, std::size_t count,
          const FilmPointFocuses<T>& points, const RayArrays<T>& rays) noexcept {
  const auto [nearer, surface, offset, scale] = points;
  const auto [ox, oy, oz, dx, dy, dz] = rays;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPointFocus<T> point{nearer[i], surface[i], offset[i], scale[i]};
    const auto bent = bent_ray(rules, maps, dispersion, z, point, BentRay<T>{ox[i], oy[i], dx[i], dy[i], dz[i]});
    ox[i] = bent.x, oy[i] = bent.y, oz[i] = z;
    dx[i] = bent.dx, dy[i] = bent.dy, dz[i] = bent.dz;
  }
}

}  // namespace

extern const LocalFocusLoops PETZVAL_LOOPS;
const LocalFocusLoops PETZVAL_LOOPS{&bend<float>, &bend<double>};

}  // namespace petzval::inline v0::camera_detail
