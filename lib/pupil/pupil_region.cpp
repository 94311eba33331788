// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "pupil_region.hpp"

namespace petzval::inline v0 {

Vec2<double> PupilRegion::unit(std::size_t direction) const noexcept {
  const double angle = 2 * std::numbers::pi * (static_cast<double>(direction) + 0.5) / static_cast<double>(directions);
  return {std::sin(angle), std::cos(angle)};
}

Vec2<double> PupilRegion::at(std::size_t direction, double radius) const noexcept {
  const Vec2<double> p = unit(direction);
  return {middle.x + half_axes.x * radius * p.x, middle.y + half_axes.y * radius * p.y};
}

double PupilRegion::area() const noexcept {
  double sum = 0;
  for (const PupilSpan& s : spans) sum += (s.to_radius - s.from_radius) * (s.to_radius + s.from_radius);
  return directions == 0 ? 0 : pupil_detail::area_of(*this, sum);
}

namespace pupil_detail {

double area_of(const PupilRegion& region, double squared_radii) noexcept {
  return squared_radii * std::numbers::pi / static_cast<double>(region.directions) * region.half_axes.x *
         region.half_axes.y;
}

std::vector<Extent> extents(const PupilRegion& region) {
  std::vector<Extent> result(region.directions);
  for (const PupilSpan& span : region.spans) {
    Extent& e = result[span.direction];
    if (!e.lit) {
      e.obscured_to = span.from_radius;
    } else if (e.obscured_from > 0 || e.obscured_to == 0) {  // not dark from the middle on
      if (span.from_radius - e.to > e.obscured_to - e.obscured_from) {
        e.obscured_from = e.to, e.obscured_to = span.from_radius;
      }
    }
    e.to = span.to_radius, e.rim = span.to, e.lit = true;
  }
  return result;
}

}  // namespace pupil_detail
}  // namespace petzval::inline v0
