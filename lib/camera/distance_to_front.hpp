// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace petzval::camera_detail {

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

/// Distance along a ray to the front. The ray travels towards the scene; coordinates are relative to the vertex of the
/// front.
///
/// A sphere of curvature c is c |p|^2 = 2 p_z. With b = d_z - c p.d and e = c |p|^2 - 2 p_z, the ray leaves a convex
/// sphere and meets a concave sphere at the distance
///     s = (b + sqrt(b^2 - c e)) / c = e / (b - sqrt(b^2 - c e)).
/// The second form also holds for planes. A ray that misses the sphere starts on the tangent plane at the vertex; a ray
/// that leaves neither starts at its point nearest to the vertex.
template <class T>
inline T distance_to_front(const T& curvature, const T& x, const T& y, const T& z, const T& dx, const T& dy,
                           const T& dz) noexcept {
  using std::sqrt;
  const T along = x * dx + y * dy + z * dz;
  const T e = curvature * (x * x + y * y + z * z) - T(2) * z;
  const T b = dz - curvature * along;
  const T square = b * b - curvature * e;
  const bool outward = b < T(0);
  const bool curved = curvature != T(0);
  const bool reaches = square > T(0);
  const bool meets = reaches & (outward | curved);
  const T root = sqrt(meets ? square : T(1));
  const T over = meets ? (outward ? e : T(b + root)) : T(-z);
  const T under = meets ? (outward ? T(b - root) : curvature) : dz;
  return (meets | (dz < T(0))) ? T(over / under) : T(-along);
}

}  // namespace

}  // namespace petzval::camera_detail
