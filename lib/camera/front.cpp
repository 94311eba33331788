// SPDX-License-Identifier: Apache-2.0
#include "front.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.hpp"
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

}  // namespace petzval::camera_detail
