// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace petzval::inline v0::camera_detail {

// Local names: this is compiled for several instruction sets, and the linker must not take one for another.
namespace {

/// How far a ray in the direction of the scene is from the front, along it, given from the front's vertex. A sphere of
/// curvature c is c |p|^2 = 2 p_z; the ray leaves it at the larger root for a convex one and at the smaller for a
/// hollow one, both as one fraction that holds for planes too. A line that passes the sphere by leaves the plane that
/// touches it; one that leaves neither stays where it is nearest to the vertex.
template <class T>
inline T way_to_front(const T& curvature, const T& x, const T& y, const T& z, const T& dx, const T& dy,
                      const T& dz) noexcept {
  using std::sqrt;
  const T along = x * dx + y * dy + z * dz;
  const T qx = x - along * dx, qy = y - along * dy, qz = z - along * dz;
  const T plane = T(-2) * qz, sphere = plane + curvature * (qx * qx + qy * qy + qz * qz);
  const T square = dz * dz - curvature * sphere;
  const bool meets = square > T(0);
  const T across = meets ? T(dz - sqrt(meets ? square : T(1))) : (dz < T(0) ? T(T(2) * dz) : T(0));
  const T numerator = meets ? sphere : plane;
  return (across < T(0) ? T(numerator / across) : T(0)) - along;
}

}  // namespace

}  // namespace petzval::inline v0::camera_detail
