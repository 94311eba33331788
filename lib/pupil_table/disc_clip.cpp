// SPDX-License-Identifier: Apache-2.0
#include "disc_clip.hpp"

#include <algorithm>
#include <cmath>

namespace petzval::pupil_table_detail {
namespace {

/// Distance from the middle of the polygon to its edge in a direction; 0 if no sector faces the direction.
double reach(const PupilPolygon& polygon, const Vec2<double>& d) {
  const auto sectors = [&](std::size_t k) { return polygon.sector(k); };
  // On the line to a corner, rounding may exclude the direction from both adjacent sectors.
  for (const double aside : {0.0, 1e-9}) {
    const Point<double> q{d.x + aside * d.y, d.y - aside * d.x};
    const std::size_t found = sector_facing(q, sectors);
    if (found != polygon_corners) return 1 / polygon.sector(found).relative_radius(q);
  }
  return 0;
}

}  // namespace

PupilPolygon clipped_by_disc(const PupilPolygon& polygon, double centre, double radius) {
  constexpr Vec2<double> towards{0, 1};
  // Common interval of polygon and disc along y through the middle.
  const double from_middle = centre - polygon.middle.y;
  const double low = std::max(-reach(polygon, -towards), from_middle - radius);
  const double high = std::min(reach(polygon, towards), from_middle + radius);
  const double step = low < high ? (low + high) / 2 : from_middle;
  PupilPolygon about_middle = polygon;
  about_middle.middle = {0, polygon.middle.y + step};
  for (auto& corner : about_middle.corners) corner -= step * towards;
  if (!(low < high)) return {.middle = about_middle.middle};
  const double to_centre = from_middle - step, square_margin = radius * radius - to_centre * to_centre;
  // Fraction of d at which a line outwards leaves the polygon or the disc: square t^2 - 2 t along - margin = 0.
  return polygon_within(about_middle.middle, (high - low) / 2, [&](const Vec2<double>& d) {
    const double square = d.x * d.x + d.y * d.y, along = d.y * to_centre;
    return std::min(reach(about_middle, d), (along + std::sqrt(along * along + square * square_margin)) / square);
  });
}

}  // namespace petzval::pupil_table_detail
