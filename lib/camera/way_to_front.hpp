// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace petzval::camera_detail {

// Local names: this is compiled for several instruction sets, and the linker must not take one for another.
namespace {

/// How far a ray in the direction of the scene is from the front, along it, given from the front's vertex. A sphere of
/// curvature c is c |p|^2 = 2 p_z, and s = (b + sqrt(b^2 - c e)) / c = e / (b - sqrt(b^2 - c e)) with b = d_z - c p.d
/// and e = c |p|^2 - 2 p_z is where the ray leaves a convex one and meets a hollow one; the latter form holds for
/// planes too. A line that passes the sphere by leaves the plane that touches it; one that leaves neither stays where
/// it is nearest to the vertex.
template <class T>
inline T way_to_front(const T& curvature, const T& x, const T& y, const T& z, const T& dx, const T& dy,
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
