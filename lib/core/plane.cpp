// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/geometry.hpp"

#include <cmath>

namespace petzval {

std::optional<Line3> line_at(const Plane& plane, double z) {
  const Vec3<double>& n = plane.normal;
  const double across = std::hypot(n.x, n.y);
  const double reach = (plane.offset - n.z * z) / across;  // distance from the axis along the normal
  if (!(across > 0) || !std::isfinite(reach)) return {};
  const double ux = n.x / across, uy = n.y / across;
  const bool turned = uy < 0 || (uy == 0 && ux > 0);
  return Line3{{reach * ux, reach * uy, z}, turned ? Vec3<double>(-uy, ux, 0) : Vec3<double>(uy, -ux, 0)};
}

}  // namespace petzval
