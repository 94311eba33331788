// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "pupil_table/pupil_grid.hpp"

/// Positions in the polygon of one film point, in double.
namespace petzval::pupil_table_detail {

/// Index of the sector in the direction of a position from the middle; polygon_corners if there is no such sector.
template <class Polygon>
std::size_t sector_towards(const Polygon& polygon, const Point<double>& q) {
  const std::int32_t first = sector_before(q, [&](std::int32_t k) { return polygon.corner(k); });
  return sector_facing(
      q, [&](std::size_t k) { return polygon.sector(static_cast<std::int32_t>(k)); }, static_cast<std::size_t>(first));
}

/// Clearance as in FilmPupilTable::clearances().
/// @param facing on input, the first sector to try; on output, the sector that faces the position
template <class Polygon>
double clearance_at(const Polygon& polygon, const Point<double>& q, std::size_t& facing) {
  Sector<double> sector = polygon.sector(static_cast<std::int32_t>(facing));
  if (!sector.faces(q)) {
    const std::size_t k = sector_towards(polygon, q);
    if (k == polygon_corners) return -1;
    facing = k;
    sector = polygon.sector(static_cast<std::int32_t>(k));
  }
  constexpr double farthest = 1e150;  // its square is finite
  const double radius = std::min(sector.relative_radius(q), farthest), squared = radius * radius;
  double least = 1 - squared;
  if (sector.obscured > 0) {
    const double inner = sector.obscured_from - squared, outer = squared - sector.obscured_from - sector.obscured;
    least = std::min(least, std::max(inner, outer));
  }
  return least < 0 ? least / (1 - least) : least;
}

}  // namespace petzval::pupil_table_detail
