// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pupil_table/sector.hpp"

/// Positions in the polygon of one film point, in double.
namespace petzval::pupil_table_detail {

/// Index of the last corner whose direction from the middle is before the direction of a position, by bisection.
template <class Polygon>
std::size_t corner_before(const Polygon& polygon, const Point<double>& q) {
  const Point<double> first = polygon.corner(0);
  const bool first_half = turn(first, q) >= 0;
  std::size_t low = 0, high = polygon_corners;
  while (high - low > 1) {
    const std::size_t k = (low + high) / 2;
    const Point<double> corner = polygon.corner(k);
    const bool own_half = turn(first, corner) >= 0;
    (own_half == first_half ? turn(corner, q) >= 0 : own_half) ? low = k : high = k;
  }
  return low;
}

/// Index of the sector in the direction of a position from the middle; polygon_corners if there is no such sector.
template <class Polygon>
std::size_t sector_towards(const Polygon& polygon, const Point<double>& q) {
  return sector_facing(
      q, [&](std::size_t k) { return polygon.sector(k); }, corner_before(polygon, q));
}

/// Clearance as in FilmPupilTable::clearances().
/// @param facing on input, the first sector to try; on output, the sector that faces the position
template <class Polygon>
double clearance_at(const Polygon& polygon, const Point<double>& q, std::size_t& facing) {
  Sector<double> sector = polygon.sector(facing);
  if (!sector.faces(q)) {
    const std::size_t k = sector_towards(polygon, q);
    if (k == polygon_corners) return -1;
    facing = k;
    sector = polygon.sector(k);
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
