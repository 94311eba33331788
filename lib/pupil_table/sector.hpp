// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/scalar.hpp"
#include "core/simd.hpp"

/// Geometry of pupil polygons over a scalar: a double, a number with derivatives, or lanes.
///
/// A polygon has a middle point and corners around it, in order from +y towards +x; sector k is the triangle between
/// the middle and the corners k and k + 1. An interval of a sector may be obscured, between two lines parallel to its
/// outer edge. Samples (u, v) are uniform in each sector: u selects the sector and the position along its edge, v the
/// squared relative radius, which is 0 at the middle and 1 at the outer edge.
namespace petzval::pupil_table_detail {

inline constexpr std::size_t polygon_corners = 64;

using kernel::all_of;
using kernel::select;
using std::sqrt;

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

template <class V>
struct Point {
  V x{}, y{};

  friend PETZVAL_INLINE Point operator+(const Point& a, const Point& b) noexcept { return {a.x + b.x, a.y + b.y}; }
  friend PETZVAL_INLINE Point operator-(const Point& a, const Point& b) noexcept { return {a.x - b.x, a.y - b.y}; }
  friend PETZVAL_INLINE Point operator*(const V& s, const Point& a) noexcept { return {s * a.x, s * a.y}; }
};

/// Twice the area of the triangle from the middle to a and b; positive in the order of corners.
template <class V>
PETZVAL_INLINE V turn(const Point<V>& a, const Point<V>& b) noexcept {
  return b.x * a.y - a.x * b.y;
}

template <class V>
PETZVAL_INLINE V lesser(const V& a, const V& b) noexcept {
  return select(a < b, a, b);
}
template <class V>
PETZVAL_INLINE V greater(const V& a, const V& b) noexcept {
  return select(a > b, a, b);
}
/// x clamped to [0, 1]; 0 for NaN.
template <class V>
PETZVAL_INLINE V clamped(const V& x) noexcept {
  return lesser(greater(x, V(0)), V(1));
}
/// x, or 1 unless x is positive: a denominator.
template <class V>
PETZVAL_INLINE V positive_or_one(const V& x) noexcept {
  return select(x > V(0), x, V(1));
}

template <class V>
struct Sector {
  Point<V> a, b;              ///< the corners, relative to the middle
  V obscured_from, obscured;  ///< begin and width of the obscured interval of squared relative radii

  PETZVAL_INLINE V area() const noexcept { return V(0.5f) * turn(a, b) * (V(1) - obscured); }
  /// Area that a sample of this sector represents, because all sectors get equal numbers of samples.
  PETZVAL_INLINE V sampled_area() const noexcept { return V(static_cast<float>(polygon_corners)) * area(); }

  /// Squared relative radius of a sample.
  PETZVAL_INLINE V squared_radius(const V& v) const noexcept {
    const V within = (V(1) - obscured) * v;
    return select(within < obscured_from, within, V(within + obscured));
  }
  /// Inverse of squared_radius(): v of a squared relative radius; inside the obscured interval, v at its begin.
  PETZVAL_INLINE V fraction_within(const V& squared_radius) const noexcept {
    const V past = greater(V(squared_radius - obscured), obscured_from);
    return select(squared_radius < obscured_from, squared_radius, past) / positive_or_one(V(V(1) - obscured));
  }
  /// Position at a relative radius and at a fraction of the outer edge, from a (0) to b (1).
  PETZVAL_INLINE Point<V> at(const V& radius, const V& along) const noexcept {
    return {radius * (a.x + along * (b.x - a.x)), radius * (a.y + along * (b.y - a.y))};
  }

  /// True if the position lies between the lines from the middle through the corners.
  PETZVAL_INLINE auto faces(const Point<V>& q) const noexcept {
    return all_of(turn(a, q) >= V(0), turn(q, b) >= V(0), turn(a, b) > V(0));
  }
  /// Relative radius of a position that the sector faces.
  PETZVAL_INLINE V relative_radius(const Point<V>& q) const noexcept { return (turn(a, q) + turn(q, b)) / turn(a, b); }
  /// Fraction along the outer edge, from a (0) to b (1), where the line from the middle through q crosses it.
  PETZVAL_INLINE V along_to(const Point<V>& q) const noexcept {
    const V before = turn(a, q), both = before + turn(q, b);
    return select(both > V(0), V(before / positive_or_one(both)), V(0));
  }
  PETZVAL_INLINE auto obscures(const V& squared_radius) const noexcept {
    return all_of(squared_radius >= obscured_from, squared_radius < obscured_from + obscured);
  }
};

/// Maps uniform numbers to uniform points of a polygon, as PupilSampler does for a PupilBoundary, but with triangles
/// instead of ring sectors.
class PolygonSampler {
 public:
  /// @param sector function; sector(k) is sector k
  template <class Sectors>
  explicit PolygonSampler(const Sectors& sector) noexcept {
    for (std::size_t k = 0; k < polygon_corners; ++k) {
      sectors_[k] = sector(k);
      before_[k + 1] = before_[k] + greater(sectors_[k].area(), 0.0);
    }
  }
  /// Area, mm^2; 0 if there is nothing to sample.
  double area() const noexcept { return before_[polygon_corners]; }
  /// The point, relative to the middle, for u and v in [0, 1] (clamped).
  Point<double> operator()(double u, double v) const noexcept {
    // Areas of sectors are nearly equal.
    constexpr double last = polygon_corners - 1;
    const double area_before = clamped(u) * area(), expected = area_before / area() * (last + 1);
    auto k = expected > 0 ? static_cast<std::size_t>(lesser(expected, last)) : 0;
    while (k > 0 && area_before < before_[k]) --k;
    while (k + 1 < polygon_corners && area_before >= before_[k + 1]) ++k;
    const double own = before_[k + 1] - before_[k];
    const double along = own > 0 ? clamped((area_before - before_[k]) / own) : 0;
    return sectors_[k].at(sqrt(sectors_[k].squared_radius(clamped(v))), along);
  }

 private:
  std::array<Sector<double>, polygon_corners> sectors_;
  std::array<double, polygon_corners + 1> before_{};  // area of all sectors before each sector
};

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
