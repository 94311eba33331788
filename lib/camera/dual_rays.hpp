// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/dual.hpp"
#include "petzval/core/ray.hpp"
#include "pupil_table/two_plane_rays.hpp"

/// Rays over dual numbers from rays and derivatives, and back.
namespace petzval::camera_detail {

/// @param by_u, by_v derivatives with respect to variables 0 and 1
template <class T>
RayOf<kernel::Dual> dual_ray(const Ray<T>& ray, const Ray<T>& by_u, const Ray<T>& by_v) noexcept {
  const auto vector = [&](Vec3<T> Ray<T>::*of) -> kernel::Vec<kernel::Dual> {
    const Vec3<double> a(ray.*of), u(by_u.*of), v(by_v.*of);
    return {{a.x, {u.x, v.x}}, {a.y, {u.y, v.y}}, {a.z, {u.z, v.z}}};
  };
  return {vector(&Ray<T>::origin), vector(&Ray<T>::direction)};
}

/// One number of each component of a ray.
/// @param number value_only, by_first or by_second
template <class T = double>
Ray<T> ray_of(const RayOf<kernel::Dual>& ray, const auto& number) noexcept {
  const auto vector = [&](const kernel::Vec<kernel::Dual>& v) {
    return Vec3<T>(Vec3<double>(number(v.x), number(v.y), number(v.z)));
  };
  return {vector(ray.origin), vector(ray.direction)};
}
inline constexpr auto value_only = [](const kernel::Dual& x) noexcept { return x.a; };
inline constexpr auto by_first = [](const kernel::Dual& x) noexcept { return x.v.x; };
inline constexpr auto by_second = [](const kernel::Dual& x) noexcept { return x.v.y; };

}  // namespace petzval::camera_detail
