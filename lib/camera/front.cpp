// SPDX-License-Identifier: Apache-2.0
#include "front.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/dual.hpp"
#include "core/text.hpp"
#include "distance_to_front.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "pupil/surface_box.hpp"

namespace petzval::camera_detail {

Front front_of(const Lens& lens) {
  const Pupil entrance = has_pupils(lens) ? pupils(lens).entrance : Pupil{};
  double frontmost = std::numeric_limits<double>::infinity(), behind_first = frontmost;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const double z = pupil_detail::surface_box(lens, i, entrance).z_min;
    frontmost = std::min(frontmost, z);
    if (i > 0) behind_first = std::min(behind_first, z);
  }
  constexpr double farthest = 1e12;  // mm
  if (!(std::abs(frontmost) <= farthest)) {
    throw Error(lens.name() + ": the glass of the lens begins at z = " + to_text(frontmost) + " mm; must be within " +
                to_text(farthest) + " mm for a camera");
  }
  const LensSurface& first = lens.surfaces().front();
  const double half = pupil_detail::half_height(lens, 0, entrance), depth = sag(lens, 0, 0, half);
  const bool foremost = behind_first > std::min(first.vertex_z, first.vertex_z + depth);
  if (first.curved_in != Section::both || !foremost || std::isnan(depth)) return {frontmost, 0, false};
  const bool spherical = first.conic == 0 && first.aspheric.empty();
  return {first.vertex_z, spherical ? first.curvature : 2 * depth / (half * half + depth * depth), spherical};
}

double distance_to_front(const Front& front, const Ray<double>& ray) noexcept {
  const auto& [o, d] = ray;
  return distance_to_front(front.curvature, o.x, o.y, o.z - front.vertex_z, d.x, d.y, d.z);
}

RayDerivatives at_front(const Front& front, const RayDerivatives& ray) noexcept {
  using kernel::Dual;
  const auto jet = [&](Vec3<double> Ray<double>::*component, int axis) {
    Dual x((ray.ray.*component)[axis]);
    x.v[0] = (ray.by_u.*component)[axis];
    x.v[1] = (ray.by_v.*component)[axis];
    return x;
  };
  const std::array o{jet(&Ray<double>::origin, 0), jet(&Ray<double>::origin, 1), jet(&Ray<double>::origin, 2)};
  const std::array d{jet(&Ray<double>::direction, 0), jet(&Ray<double>::direction, 1), jet(&Ray<double>::direction, 2)};
  const Dual distance = distance_to_front(Dual(front.curvature), o[0], o[1], o[2] - front.vertex_z, d[0], d[1], d[2]);
  RayDerivatives result = ray;
  for (int axis = 0; axis < 3; ++axis) {
    const Dual moved = o[axis] + distance * d[axis];
    result.ray.origin[axis] = moved.a;
    result.by_u.origin[axis] = moved.v[0];
    result.by_v.origin[axis] = moved.v[1];
  }
  return result;
}

}  // namespace petzval::camera_detail
