// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// Geometry of pupil polygons, for one polygon of a table and for loops over many polygons, in float, in double, or
/// with derivatives.
///
/// A polygon has a middle point and corners around it, in order from +y towards +x; sector k is the triangle between
/// the middle and the corners k and k + 1. An interval of a sector may be obscured, between two lines parallel to its
/// outer edge. The "way" of a point is its radial fraction: 0 at the middle and 1 at the outer edge. Samples (u, v) are
/// uniform by area: u selects the sector and the position along its edge, v the squared relative radius.
namespace petzval::pupil_table_detail {

inline constexpr std::size_t polygon_corners = 64;

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

template <class T>
struct Point {
  T x{}, y{};

  friend inline Point operator+(const Point& a, const Point& b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend inline Point operator-(const Point& a, const Point& b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend inline Point operator*(const T& s, const Point& a) noexcept { return {s * a.x, s * a.y}; }
};

/// Twice the area of the triangle from the middle to a and b; positive in the order of corners.
template <class T>
inline T turn(const Point<T>& a, const Point<T>& b) noexcept {
  return b.x * a.y - a.x * b.y;
}

template <class T>
struct Sector {
  Point<T> a, b;              ///< the corners, relative to the middle
  T obscured_from, obscured;  ///< begin and width of the obscured interval of squared relative radii

  T area() const noexcept { return T(0.5) * turn(a, b) * (T(1) - obscured); }

  /// Squared relative radius of a sample.
  T squared_radius(const T& v) const noexcept {
    const T within = (T(1) - obscured) * v;
    return within < obscured_from ? within : T(within + obscured);
  }
  /// Inverse of squared_radius(): v of a squared relative radius; inside the obscured interval, v at its begin.
  T fraction_within(const T& squared_radius) const noexcept {
    const T past = squared_radius - obscured > obscured_from ? squared_radius - obscured : obscured_from;
    const T left = T(1) - obscured;
    return (squared_radius < obscured_from ? squared_radius : past) / (left > T(0) ? left : T(1));
  }
  /// Position at a relative radius and at a fraction of the outer edge, from a (0) to b (1).
  Point<T> at(const T& radius, const T& along) const noexcept {
    return {radius * (a.x + along * (b.x - a.x)), radius * (a.y + along * (b.y - a.y))};
  }

  /// True if the position lies between the lines from the middle through the corners.
  bool faces(const Point<T>& q) const noexcept { return turn(a, q) >= T(0) && turn(q, b) >= T(0) && turn(a, b) > T(0); }
  /// Relative radius of a position that the sector faces.
  T relative_radius(const Point<T>& q) const noexcept { return (turn(a, q) + turn(q, b)) / turn(a, b); }
  /// Fraction along the outer edge, from a (0) to b (1), where the line from the middle through q crosses it.
  T along_to(const Point<T>& q) const noexcept {
    const T before = turn(a, q), after = turn(q, b);
    return before + after > T(0) ? before / (before + after) : T(0);
  }
  bool obscures(const T& squared_radius) const noexcept {
    return squared_radius >= obscured_from && squared_radius < obscured_from + obscured;
  }
};

/// Index of the sector that contains a sample, for sectors of nearly equal areas.
/// @param area area before the sample
/// @param before function; before(k) is the area before sector k, before(polygon_corners) the area of the polygon
template <class AreaBefore>
inline std::size_t sector_of_area(double area, const AreaBefore& before) noexcept {
  constexpr double last = polygon_corners - 1;
  const double expected = area / before(polygon_corners) * static_cast<double>(polygon_corners);
  auto k = expected > 0 ? static_cast<std::size_t>(expected < last ? expected : last) : 0;
  while (k > 0 && area < before(k)) --k;
  while (k + 1 < polygon_corners && area >= before(k + 1)) ++k;
  return k;
}

/// Index of the sector that faces a position, searched from sector `first` on; polygon_corners if there is no such
/// sector.
template <class Sectors>
inline std::size_t sector_facing(const Point<double>& q, const Sectors& sector, std::size_t first = 0) noexcept {
  for (std::size_t i = 0; i < polygon_corners; ++i) {
    const std::size_t k = (first + i) % polygon_corners;
    if (sector(k).faces(q)) return k;
  }
  return polygon_corners;
}

}  // namespace
}  // namespace petzval::pupil_table_detail
