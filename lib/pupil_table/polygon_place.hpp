// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/loop_math.hpp"
#include "film_pupil_table_loops.hpp"
#include "petzval/core/geometry.hpp"
#include "pupil_table/sector.hpp"

/// Polygons of tables for one film point, as loops have them for many: double or derivatives.
namespace petzval::pupil_table_detail {

/// The polygon at the fraction t of a strip (StripLayout).
template <class T>
struct InStrip {
  const double* strip = nullptr;
  T t{};

  static Point<T> along(const double* from, const T& t) { return {from[0] + t * from[2], from[1] + t * from[3]}; }
  Point<T> corner(std::size_t k) const { return along(strip + StripLayout::sectors + StripLayout::sector * k, t); }
  Point<T> middle() const { return {T(0.0), strip[StripLayout::middle_y] + t * strip[StripLayout::middle_y + 1]}; }
  /// Begin and width.
  Point<T> obscured(std::size_t k) const { return along(strip + StripLayout::obscured + 4 * k, t); }
  /// Area before a sector; `polygon_corners`: the whole.
  T area_before(std::size_t k) const {
    const double* f = strip + StripLayout::sectors + StripLayout::sector * k + StripLayout::area;
    return f[0] + t * (f[1] + t * (f[2] + t * f[3]));
  }
  /// In sectors, where a share of the area is expected to end.
  double expected(double share) const { return share * polygon_corners; }
  static constexpr std::size_t corners = polygon_corners;
};

/// The polygon at fractions of a cell (CellLayout, BladedLayout).
template <class T>
struct InCell {
  const double* cell = nullptr;
  T t{}, s{};
  std::size_t corners = polygon_corners;  ///< fewer of a bladed iris
  bool bladed = false;                    ///< with a guide; else corners are even in halves

  T bilinear(const double* f) const { return f[0] + t * f[1] + s * (f[2] + t * f[3]); }
  Point<T> corner(std::size_t k) const {
    const double* f = cell + CellLayout::sectors + CellLayout::sector * k;
    return {bilinear(f), bilinear(f + 4)};
  }
  Point<T> middle() const { return {bilinear(cell + CellLayout::middle_x), bilinear(cell + CellLayout::middle_y)}; }
  Point<T> obscured(std::size_t) const { return {T(0.0), T(0.0)}; }
  T area_before(std::size_t k) const {
    const double* f = cell + CellLayout::sectors + CellLayout::sector * k + CellLayout::area;
    const auto quadratic = [this](const double* g) { return g[0] + t * (g[1] + t * g[2]); };
    return quadratic(f) + s * (quadratic(f + 3) + s * quadratic(f + 6));
  }
  /// Of the half at +x.
  T right_share() const { return area_before(polygon_corners / 2) / area_before(polygon_corners); }
  double expected(double share) const {
    if (!bladed) return sectors_in_halves(share, right_share());
    const double place = core_detail::clamped(share) * BladedLayout::guide_steps;  // areas between nodes may turn over
    const std::size_t k = std::min(static_cast<std::size_t>(place), BladedLayout::guide_steps - 1);
    const double* guide = cell + BladedLayout::guide + k;
    return guide[0] + (place - static_cast<double>(k)) * (guide[1] - guide[0]);
  }
};

template <template <class> class In, class T>
Sector<T> sector_at(const In<T>& polygon, std::size_t k) {
  const Point<T> obscured = polygon.obscured(k);
  return {polygon.corner(k), polygon.corner(k + 1), obscured.x, obscured.y};
}

/// The sector in which a sample lies. area: before it.
template <template <class> class In>
std::size_t sector_with(const In<double>& polygon, double area) {
  return sector_of_area(area, [&](std::size_t k) { return polygon.area_before(k); });
}

/// The place of a sample in the sector k, from the middle.
template <template <class> class In, class T>
Point<T> sample_place(const In<T>& polygon, std::size_t k, const T& u, double v) {
  using std::sqrt;
  const Sector<T> sector = sector_at(polygon, k);
  T along = (polygon.area_before(polygon_corners) * u - polygon.area_before(k)) / sector.area();
  if (!(along <= 1.0)) along = T(1.0);
  const T squared = sector.squared_way(T(v));
  return sector.at(squared > 0.0 ? T(sqrt(squared)) : T(0.0), along);  // no derivative in the middle
}

/// The last corner before a place, seen from the middle, of corners in order.
template <template <class> class In>
std::size_t corner_before(const In<double>& polygon, const Point<double>& q) {
  const Point<double> first = polygon.corner(0);
  const bool first_half = turn(first, q) >= 0;
  std::size_t low = 0, high = polygon.corners;
  while (high - low > 1) {
    const std::size_t k = (low + high) / 2;
    const Point<double> corner = polygon.corner(k);
    const bool own_half = turn(first, corner) >= 0;
    (own_half == first_half ? turn(corner, q) >= 0 : own_half) ? low = k : high = k;
  }
  return low;
}

/// The sector that faces a place, seen from the middle; polygon_corners: none does.
template <template <class> class In>
std::size_t sector_towards(const In<double>& polygon, const Point<double>& q) {
  return sector_facing(
      q, [&](std::size_t k) { return sector_at(polygon, k); }, corner_before(polygon, q));
}

/// The squared way outwards to a place, seen from the middle, and the sector that faces it; none: no sector does.
template <template <class> class In>
std::optional<std::pair<double, Sector<double>>> way_to_place(const In<double>& polygon, const Point<double>& q) {
  const std::size_t k = sector_towards(polygon, q);
  if (k == polygon_corners) return {};
  const Sector<double> sector = sector_at(polygon, k);
  const double way = sector.way_to(q);
  return std::pair{way * way, sector};
}

/// The inverse of sample_place: the share of the area before a place and v, which is above 1 outside. Outside of a
/// polygon without sectors there: v is 2.
template <template <class> class In>
Point<double> position_of_place(const In<double>& polygon, const Point<double>& q) {
  const std::size_t k = sector_towards(polygon, q);
  const double whole = polygon.area_before(polygon_corners);
  if (k == polygon_corners || !(whole > 0)) return {0, 2};
  const Sector<double> sector = sector_at(polygon, k);
  const double way = sector.way_to(q);
  return {(polygon.area_before(k) + sector.along_to(q) * sector.area()) / whole, sector.share_within(way * way)};
}

template <template <class> class In>
bool contains_place(const In<double>& polygon, const Point<double>& q) {
  const auto found = way_to_place(polygon, q);
  return found && found->first <= 1 && !found->second.obscures(found->first);
}

/// As FilmPupilTable::clearances(). facing: the sector that probably faces the place, replaced by the one that does.
template <template <class> class In>
double clearance_of_place(const In<double>& polygon, const Point<double>& q, std::size_t& facing) {
  Sector<double> sector = sector_at(polygon, facing);
  if (!sector.faces(q)) {
    const std::size_t k = sector_towards(polygon, q);
    if (k == polygon_corners) return -1;
    facing = k;
    sector = sector_at(polygon, k);
  }
  constexpr double farthest = 1e150;  // whose square is a number
  const double way = std::min(sector.way_to(q), farthest), squared = way * way;
  double least = 1 - squared;
  if (sector.obscured > 0) {
    const double inner = sector.obscured_from - squared, outer = squared - sector.obscured_from - sector.obscured;
    least = std::min(least, std::max(inner, outer));
  }
  return least < 0 ? least / (1 - least) : least;
}

/// By how many sectors equal shares of the area miss the right one, at most: as tables have it (StripTable).
template <template <class> class In>
int corrections_of(const In<double>& polygon) {
  int corrections = 0;
  const double whole = polygon.area_before(polygon_corners);
  for (std::size_t k = 0; whole > 0 && k < polygon.corners; ++k) {
    const double off = std::abs(polygon.expected(polygon.area_before(k) / whole) - static_cast<double>(k));
    constexpr double most = 64;
    if (off > 0.49) corrections = std::max(corrections, static_cast<int>(std::min(std::ceil(off), most)));
  }
  return corrections;
}

}  // namespace petzval::pupil_table_detail
