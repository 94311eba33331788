// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/geometry.hpp"

namespace petzval::polynomial_detail {

/// A line in object space as two vectors, which rotate with the line about the axis.
///
/// s is the stereographic projection of its direction d towards the scene, d = (2 s, |s|^2 - 1) / (1 + |s|^2): 0 along
/// the axis, of length 1 at 90 degrees, infinite only for a line along +z. o points from a reference point on the axis
/// to the foot of the perpendicular on the line, rotated back by the shortest rotation R that takes -z to d. R takes a
/// vector v across the axis to v - (v.h) h / (1 - d_z), h = d - z, which is (v, 0) + 2 (s.v) (-s, 1) / (1 + |s|^2). The
/// inverse of R takes a vector w across d to w_xy + w_z s.
struct SceneLine {
  double sx = 0, sy = 0, ox = 0, oy = 0;
};

/// @param direction a unit vector towards the scene
/// @param point a point of the line, relative to the reference point
inline SceneLine scene_line(const Vec3<double>& direction, const Vec3<double>& point) noexcept {
  const double per_length = 1 / (1 - direction.z);
  const double sx = direction.x * per_length, sy = direction.y * per_length;
  const double along = point.x * direction.x + point.y * direction.y + point.z * direction.z;
  const double foot_z = point.z - along * direction.z;
  return {sx, sy, point.x - along * direction.x + foot_z * sx, point.y - along * direction.y + foot_z * sy};
}

}  // namespace petzval::polynomial_detail
