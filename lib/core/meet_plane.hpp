// SPDX-License-Identifier: Apache-2.0
// Intersections of rays with planes: the plane at z perpendicular to the axis (an upright film), and a tilted plane.
// Rays are infinite lines. A ray parallel to the plane gives non-finite numbers, so that loops need no branch.
#pragma once

#include <glm/geometric.hpp>

#include <cstddef>
#include <type_traits>

#include "petzval/core/ray.hpp"

namespace petzval::core_detail {

template <class T>
Ray<std::remove_const_t<T>> ray_at(const RayArrays<T>& rays, std::size_t i) noexcept {
  return {{rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}};
}

/// Intersection of a ray with the plane at z.
template <class T>
Vec3<T> meet_plane(const Ray<T>& ray, T z) noexcept {
  const T t = (z - ray.origin.z) / ray.direction.z;
  return {ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y, z};
}

/// Intersection of a ray with the plane through `point` with normal `normal`.
template <class T>
Vec3<T> meet_plane(const Ray<T>& ray, const Vec3<T>& point, const Vec3<T>& normal) noexcept {
  const T t = glm::dot(point - ray.origin, normal) / glm::dot(ray.direction, normal);
  return ray.origin + ray.direction * t;
}

/// A ray given by its point in a plane perpendicular to the axis and its slopes per mm of z. For rays that meet several
/// such planes: the slopes need one division, and each plane only two products.
template <class T>
struct SlopeRay {
  T x, y, slope_x, slope_y;

  /// The same ray, with its point in the plane at the distance `away` along z.
  SlopeRay moved(T away) const noexcept { return {x + away * slope_x, y + away * slope_y, slope_x, slope_y}; }
};

/// The ray in the plane of its origin.
template <class T>
SlopeRay<T> slope_ray(const Ray<T>& ray) noexcept {
  return {ray.origin.x, ray.origin.y, ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
}

/// The ray in the plane at z.
template <class T>
SlopeRay<T> slope_ray(const Ray<T>& ray, T z) noexcept {
  return slope_ray(ray).moved(z - ray.origin.z);
}

}  // namespace petzval::core_detail
