// SPDX-License-Identifier: Apache-2.0
// Compiled for each instruction set; see petzval_loops in cmake/module.cmake.
#include "local_focus_loops.hpp"

namespace petzval::camera_detail {
namespace {

template <class T>
void bend(const FocusRules<T>& given, const EntranceMaps<T>& given_maps, T dispersion, T z, std::size_t count,
          const FilmPointFocuses<T>& points, const RayArrays<T>& rays) noexcept {
  const FocusRules<T> rules = given;
  const EntranceMaps<T> maps = given_maps;
  const auto [excess, surface, offset, scale] = points;
  const auto [ox, oy, oz, dx, dy, dz] = rays;
  T radius[bend_block], by_radius[bend_block];
  if (rules.spline.knots > 0) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) {
      const FilmPointFocus<T> point{excess[i], surface[i], offset[i], scale[i]};
      const auto ray = at_entrance(maps, z, RayOf<T>{{ox[i], oy[i], z}, {dx[i], dy[i], dz[i]}});
      radius[i] = within_knots(rules.spline, radius_of(maps, point, ray));
      by_radius[i] = beyond_one_at_first(rules.spline, radius[i]);
    }
    for (std::size_t j = 0; j + 1 < rules.spline.knots; ++j) {
      for (std::size_t i = 0; i < count; ++i) by_radius[i] += of_knot(rules.spline, j, radius[i]);
    }
    for (std::size_t i = 0; i < count; ++i) by_radius[i] *= rules.power;
  } else {
    for (std::size_t i = 0; i < count; ++i) by_radius[i] = T(0);
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const FilmPointFocus<T> point{excess[i], surface[i], offset[i], scale[i]};
    RayOf<T> ray{{ox[i], oy[i], z}, {dx[i], dy[i], dz[i]}};
    bend_ray(rules, maps, dispersion, z, point, by_radius[i], ray);
    ox[i] = ray.origin.x, oy[i] = ray.origin.y, oz[i] = ray.origin.z;
    dx[i] = ray.direction.x, dy[i] = ray.direction.y, dz[i] = ray.direction.z;
  }
}

}  // namespace

extern const LocalFocusLoops PETZVAL_LOOPS;
const LocalFocusLoops PETZVAL_LOOPS{&bend<float>, &bend<double>};

}  // namespace petzval::camera_detail
