// SPDX-License-Identifier: Apache-2.0
// Pupils of film points, interpolated between polygons at the nodes of a grid: for single samples and for loops, in
// float or in double. Names are local: compiled for several instruction sets, which
// the linker must not mix.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/loop_math.hpp"
#include "core/simd.hpp"
#include "iris/iris_sample.hpp"
#include "pupil_table/sector.hpp"

namespace petzval::pupil_table_detail {

/// Numbers of one cell of a grid with one or two dimensions. Values are linear in t, the fraction along a row of the
/// cell, and in s, the fraction from row to row: coefficients of 1, t, s, st (one dimension: 1, t). Areas are
/// polynomials: coefficients of 1, t, t^2, t^3, or of 1, t, t^2, s, st, st^2, s^2, s^2 t, s^2 t^2.
template <int dimensions>
struct CellLayout {
  static constexpr std::int32_t linear = 1 << dimensions, area_terms = dimensions == 1 ? 4 : 9;
  static constexpr std::int32_t middle = 0;               ///< x and y
  static constexpr std::int32_t total_area = 2 * linear;  ///< area
  static constexpr std::int32_t sectors = total_area + area_terms, sector = 2 * linear + area_terms;
  static constexpr std::int32_t area = 2 * linear;  ///< in a sector, after x and y of its first corner
  /// [64] begin and width of the obscured interval of each sector; only with one dimension.
  static constexpr std::int32_t obscured = sectors + sector * (static_cast<std::int32_t>(polygon_corners) + 1);
  static constexpr std::int32_t size =
      obscured + (dimensions == 1 ? 2 * linear * static_cast<std::int32_t>(polygon_corners) : 0);
};

/// Stop data of one cell, in semi-diameters.
template <int dimensions>
struct StopLayout {
  static constexpr std::int32_t linear = 1 << dimensions;
  /// Terms of the map from stop point (x, y) to pupil position, with r = x^2 + y^2. One dimension: for pupil y (even in
  /// x) 1, y, x^2, y^2, x^2 y, y^3, r^2, r y^2, r^2 y; for pupil x divided by x: 1, y, x^2, y^2, r y, r^2. Two
  /// dimensions: for pupil x, then for pupil y: 1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3.
  static constexpr std::int32_t terms = dimensions == 1 ? 15 : 20;
  static constexpr std::int32_t samples_iris = 0;  ///< 1 to sample the iris; 0 to sample the polygon inside the iris
  static constexpr std::int32_t scale = 1;         ///< enlarges the iris, so that no ray is missed
  static constexpr std::int32_t map = 2;           ///< the terms, each linear in t and s
  static constexpr std::int32_t middle = map + linear * terms, corners = middle + 2 * linear;
  static constexpr std::int32_t size = corners + 2 * linear * (static_cast<std::int32_t>(polygon_corners) + 1);
};

/// The stop of a lens for the pupils of a grid, borrowed. cells: null if the stop is round.
template <class R>
struct GridStop {
  const R* cells = nullptr;  ///< StopLayout, in the order of PolygonGrid::cells
  iris_detail::IrisSectors<R> iris;
  R area = 0;  ///< area of the iris, in squares of the semi-diameter
};

/// The cells of all wavelengths, borrowed. With one dimension, rows are equally spaced in the distance from the axis;
/// polygons belong to film points on +y and rotate with the film point. With two dimensions, cells cover the quadrant
/// x, y >= 0: rows are equally spaced in y, the nodes of a row in x up to half_widths; pupils of the other quadrants
/// are mirror images. Corner 0 is in the direction +y from the middle, corner 32 in the direction -y.
template <int number_of_dimensions, class R>
struct PolygonGrid {
  static constexpr int dimensions = number_of_dimensions;
  const R* cells = nullptr;        ///< [(wavelength * rows + row) * columns + column] CellLayout
  const R* half_widths = nullptr;  ///< [rows + 1] mm; only with two dimensions
  std::int32_t rows = 0, columns = 1, wavelengths = 0, primary = 0;
  R reach = 0, rows_per_mm = 0;  ///< distance of the farthest film point, mm
  bool obscured = false;         ///< true if at least one sector is partly obscured
  int corrections = 0;  ///< largest error, in sectors, of the sector number expected for equal areas; 0 if below half
  GridStop<R> stop;
};

/// Film points within this squared distance from the axis, mm^2, count as on the axis: smaller squares have too few
/// digits for a direction.
template <class R>
inline constexpr R axis_r2 = std::numeric_limits<R>::min() / std::numeric_limits<R>::epsilon();

namespace {

/// Angle of a direction from +y towards +x, as a fraction of a full turn in [-1/2, 1/2], within 6e-8. u starts at +y of
/// the film, not at the direction of the film point: near the axis, adjacent film points get adjacent samples.
template <class T>
PETZVAL_INLINE T turn_of(const T& sine, const T& cosine) noexcept {
  // Without branches, which would be unpredictable.
  using core_detail::sign_of, std::abs;
  const T across = abs(sine), along = abs(cosine), a = along < across ? along : across;
  const T s = a * a;
  // asin(a) / 2 pi up to an eighth of a turn: fit of least maximum error, exactly 1/8 at the end.
  const T s2 = s * s;
  const T first = T(0.15915393812486814) + s * T(0.0265771964583);
  const T second = T(0.0111934983367) + s * T(0.0116048821993);
  const T third = T(-0.0077339762488) + s * T(0.0181935231706);
  T turn = a * (first + s2 * (second + s2 * third));
  const T octant = sign_of(T(along - across)), half = sign_of(cosine);
  turn = T(0.125) * (T(1) - octant) + octant * turn;
  turn = T(0.25) * (T(1) - half) + half * turn;
  return sign_of(sine) * turn;
}

/// The fractional part of a number from -1 to 2, without branches.
template <class T>
PETZVAL_INLINE T fraction_of(const T& x) noexcept {
  const T from_0 = x + T(0.5) * (T(1) - core_detail::sign_of(x));
  return from_0 - T(0.5) * (T(1) - core_detail::sign_of(T(T(1) - from_0)));
}

/// The cell that contains a film point; cell 0 if there is no such cell.
template <class T>
struct CellPosition {
  T t, s;                    ///< fractions in the cell
  T cosine, sine;            ///< direction of the film point; with two dimensions, signs of its y and x
  std::int32_t known, cell;  ///< known: 1 if the film point has a cell; cell: index
};

// Inlined: a call would copy the grid with wide registers. Compilers do not clear these registers (vzeroupper), and
// later code for narrow registers would stall.
template <class R, class T>
PETZVAL_INLINE CellPosition<T> cell_position(const PolygonGrid<1, R>& grid, const T& film_x, const T& film_y,
                                             std::int32_t sound, std::int32_t wavelength) noexcept {
  const std::int32_t last = grid.rows - 1;
  const T r2 = film_x * film_x + film_y * film_y;
  const T r = core_detail::square_root(r2);
  const std::int32_t known = (r <= grid.reach) & (wavelength >= 0) & sound;
  const std::int32_t off_axis = known & (r2 > axis_r2<R>);
  const T per_length = T(1) / (off_axis ? r : T(1));
  const T position = known ? T(r * grid.rows_per_mm) : T(0);
  const auto at = static_cast<std::int32_t>(position);
  const std::int32_t inner = at < last ? at : last;
  return {position - static_cast<R>(inner),         T(0),  off_axis ? T(film_y * per_length) : T(1),
          off_axis ? T(film_x * per_length) : T(0), known, known ? inner + wavelength * grid.rows : 0};
}

template <class R, class T>
PETZVAL_INLINE CellPosition<T> cell_position(const PolygonGrid<2, R>& grid, const T& film_x, const T& film_y,
                                             std::int32_t sound, std::int32_t wavelength) noexcept {
  const T sign_x = film_x < R(0) ? T(-1) : T(1), sign_y = film_y < R(0) ? T(-1) : T(1);
  const T x = film_x < R(0) ? T(-film_x) : film_x, y = film_y < R(0) ? T(-film_y) : film_y;
  constexpr R end = R(1) + R(1e-6);  // the rounded edge still belongs to the film
  const T row = y * grid.rows_per_mm;
  const std::int32_t on_film = x * x + y * y <= grid.reach * grid.reach;
  const std::int32_t below_last = row <= end * static_cast<R>(grid.rows);
  const std::int32_t in_rows = on_film & below_last & sound;
  const auto above = static_cast<std::int32_t>(in_rows ? row : T(0));
  const std::int32_t i = above < grid.rows - 1 ? above : grid.rows - 1;
  const T s = (in_rows ? row : T(0)) - static_cast<R>(i);
  const T width = grid.half_widths[i] + s * (grid.half_widths[i + 1] - grid.half_widths[i]);
  const std::int32_t known = in_rows & (x <= end * width) & (wavelength >= 0);
  const T column = known ? T(x / (width > R(0) ? width : T(1)) * static_cast<R>(grid.columns)) : T(0);
  const auto right = static_cast<std::int32_t>(column);
  const std::int32_t j = right < grid.columns - 1 ? right : grid.columns - 1;
  const std::int32_t cell = known ? (wavelength * grid.rows + i) * grid.columns + j : 0;
  return {column - static_cast<R>(j), s, sign_y, sign_x, known, cell};
}

/// Rotates a point from the frame of the grid to the frame of the film, and back.
template <int dimensions, class T>
PETZVAL_INLINE Point<T> to_film(const T& cosine, const T& sine, const Point<T>& p) noexcept {
  if constexpr (dimensions == 1) {
    return {cosine * p.x + sine * p.y, cosine * p.y - sine * p.x};
  } else {
    return {sine * p.x, cosine * p.y};
  }
}
template <int dimensions, class T>
PETZVAL_INLINE Point<T> to_grid(const T& cosine, const T& sine, const Point<T>& p) noexcept {
  if constexpr (dimensions == 1) {
    return {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y};
  } else {
    return {sine * p.x, cosine * p.y};
  }
}

/// An interpolated value of a cell. Indices have 32 bits, as gather instructions need.
template <int dimensions, class R, class T>
PETZVAL_INLINE T linear_in_cell(const R* all, std::int32_t at, const T& t, const T& s) noexcept {
  if constexpr (dimensions == 1) {
    return all[at] + t * all[at + 1];
  } else {
    return all[at] + t * all[at + 1] + s * (all[at + 2] + t * all[at + 3]);
  }
}
template <int dimensions, class R, class T>
PETZVAL_INLINE Point<T> point_in_cell(const R* all, std::int32_t at, const T& t, const T& s) noexcept {
  constexpr std::int32_t y = CellLayout<dimensions>::linear;
  return {linear_in_cell<dimensions>(all, at, t, s), linear_in_cell<dimensions>(all, at + y, t, s)};
}

/// The polygon of one position in the grid. obscured: PolygonGrid::obscured.
template <int dimensions, bool obscured, class R, class T>
struct CellPolygon {
  using L = CellLayout<dimensions>;
  const R* all;
  std::int32_t begin;
  T t, s;

  /// Corner relative to the middle.
  Point<T> corner(std::int32_t k) const noexcept {
    return point_in_cell<dimensions>(all, begin + L::sectors + L::sector * k, t, s);
  }
  Point<T> middle() const noexcept {
    if constexpr (dimensions == 1) {
      return {T(0), linear_in_cell<1>(all, begin + L::middle + L::linear, t, s)};
    } else {
      return point_in_cell<dimensions>(all, begin + L::middle, t, s);
    }
  }
  /// Area of the sectors before sector k.
  T area_before(std::int32_t k) const noexcept { return area_at(begin + L::sectors + L::sector * k + L::area); }
  T total_area() const noexcept { return area_at(begin + L::total_area); }
  Sector<T> sector(std::int32_t k) const noexcept {
    Sector<T> result{corner(k), corner(k + 1), T(0), T(0)};
    if constexpr (obscured && dimensions == 1) {
      const Point<T> interval = point_in_cell<dimensions>(all, begin + L::obscured + 2 * L::linear * k, t, s);
      result.obscured_from = interval.x, result.obscured = interval.y;
    }
    return result;
  }
  /// Fraction of the polygon's area in the half towards +x.
  /// @param total_area area of the polygon
  T right_fraction(const T& total_area) const noexcept {
    return area_before(static_cast<std::int32_t>(polygon_corners / 2)) / (total_area > R(0) ? total_area : T(1));
  }
  /// Expected sector number at which a fraction `fraction` of the area ends, if all sectors (or the sectors of each
  /// half) have equal areas.
  T expected(const T& fraction, const T& total_area) const noexcept {
    if constexpr (dimensions == 1) {
      return fraction * R(polygon_corners);
    } else {
      // Branch-free: select the half that contains the share, then scale within the half.
      const T right = right_fraction(total_area);
      const T in_left = fraction < right ? T(0) : T(1);
      const T first = in_left * right, own = right + in_left * (T(1) - T(2) * right);
      return T(polygon_corners) / T(2) * (in_left + (fraction - first) / (own > R(0) ? own : T(1)));
    }
  }
  /// Converts u, which starts at +y of the film, to the fraction of the area from corner 0 in the order of corners, and
  /// back. With two dimensions, the order is reversed in every second quadrant.
  T fraction_of_sample(const T& u, const T& total_area, const T& cosine, const T& sine) const noexcept {
    if constexpr (dimensions == 1) {
      return fraction_of(T(u - turn_of(sine, cosine)));
    } else {
      const T across = (T(1) - sine) / T(2) + sine * u;
      return fraction_of(T((T(1) - cosine) / T(2) * right_fraction(total_area) + cosine * across));
    }
  }
  T u_of(const T& fraction, const T& total_area, const T& cosine, const T& sine) const noexcept {
    if constexpr (dimensions == 1) {
      return fraction_of(T(fraction + turn_of(sine, cosine)));
    } else {
      const T across = cosine * (fraction - (T(1) - cosine) / T(2) * right_fraction(total_area));
      return fraction_of(T(sine * (across - (T(1) - sine) / T(2))));
    }
  }

 private:
  T area_at(std::int32_t at) const noexcept {
    if constexpr (dimensions == 1) {
      const R cubic = obscured ? all[at + 3] : R(0);  // areas of triangles are quadratic in t
      return all[at] + t * (all[at + 1] + t * (all[at + 2] + t * cubic));
    } else {
      const T one = all[at] + t * (all[at + 1] + t * all[at + 2]);
      const T by_s = all[at + 3] + t * (all[at + 4] + t * all[at + 5]);
      const T by_s2 = all[at + 6] + t * (all[at + 7] + t * all[at + 8]);
      return one + s * (by_s + s * by_s2);
    }
  }
};

/// Image of a stop point in the pupil plane, in the frame of the grid, with derivatives by the stop point.
template <class T>
struct SeenPoint {
  Point<T> position, by_x, by_y;
  PETZVAL_INLINE T area() const noexcept {  ///< area of the image of a unit area of the stop
    const T determinant = by_x.x * by_y.y - by_y.x * by_x.y;
    return determinant < T(0) ? T(-determinant) : determinant;
  }
};

/// The polynomials of StopLayout.
/// @param number function; number(i) is term i
template <int dimensions, class T, class Number>
PETZVAL_INLINE SeenPoint<T> seen_point(const Number& number, const Point<T>& stop) noexcept {
  const T &x = stop.x, &y = stop.y;
  const T xx = x * x, yy = y * y;
  if constexpr (dimensions == 1) {
    const T r = xx + yy, r2 = r * r;
    const T b1 = number(1), b2 = number(2), b3 = number(3), b4 = number(4), b5 = number(5), b6 = number(6),
            b7 = number(7), b8 = number(8);
    const T a0 = number(9), a1 = number(10), a2 = number(11), a3 = number(12), a4 = number(13), a5 = number(14);
    const T across = a0 + y * (a1 + a4 * r) + a2 * xx + a3 * yy + a5 * r2;
    const T across_by_x = T(2) * x * (a2 + a4 * y + T(2) * a5 * r);
    const T across_by_y = a1 + T(2) * a3 * y + a4 * (r + T(2) * yy) + T(4) * a5 * r * y;
    return {{x * across, number(0) + y * (b1 + b3 * y + b4 * xx + b5 * yy + b8 * r2) + b2 * xx + b6 * r2 + b7 * r * yy},
            {across + x * across_by_x, T(2) * x * (b2 + b4 * y + T(2) * b6 * r + b7 * yy + T(2) * b8 * y * r)},
            {x * across_by_y, b1 + T(2) * y * (b3 + T(2) * b6 * r + b7 * (r + yy)) + b4 * xx + T(3) * b5 * yy +
                                  b8 * (r2 + T(4) * yy * r)}};
  } else {
    const auto along = [&](int o, T& by_x, T& by_y) {
      const T c1 = number(o + 1), c2 = number(o + 2), c3 = number(o + 3), c4 = number(o + 4), c5 = number(o + 5);
      const T c6 = number(o + 6), c7 = number(o + 7), c8 = number(o + 8), c9 = number(o + 9);
      by_x = c1 + T(2) * c3 * x + c4 * y + T(3) * c6 * xx + T(2) * c7 * x * y + c8 * yy;
      by_y = c2 + c4 * x + T(2) * c5 * y + c7 * xx + T(2) * c8 * x * y + T(3) * c9 * yy;
      return number(o) + x * (c1 + c3 * x + c4 * y + c6 * xx + c8 * yy) + y * (c2 + c5 * y + c7 * xx + c9 * yy);
    };
    SeenPoint<T> result;
    result.position.x = along(0, result.by_x.x, result.by_y.x);
    result.position.y = along(10, result.by_x.y, result.by_y.y);
    return result;
  }
}

/// A step of Newton's method towards the stop point whose image is `position`.
template <class T>
PETZVAL_INLINE Point<T> newton_step(const SeenPoint<T>& seen, const Point<T>& position) noexcept {
  const auto& [at, by_x, by_y] = seen;
  const T determinant = by_x.x * by_y.y - by_y.x * by_x.y;
  const T per = T(1) / determinant;
  const Point<T> miss = position - at;
  return {(by_y.y * miss.x - by_y.x * miss.y) * per, (by_x.x * miss.y - by_x.y * miss.x) * per};
}

/// A stop point found by Newton's method, and the square of the last step.
template <class T>
struct StopSolution {
  Point<T> point;
  T step2;
};
template <int dimensions, class T, class Number>
PETZVAL_INLINE StopSolution<T> solve_stop_point(const Number& number, const Point<T>& position) noexcept {
  StopSolution<T> result{{T(0), T(0)}, T(0)};
  for (int i = 0; i < 4; ++i) {
    const Point<T> step = newton_step(seen_point<dimensions>(number, result.point), position);
    result.step2 = step.x * step.x + step.y * step.y;
    // Stay near the rim: outside, the polynomials are not fitted.
    const T x = result.point.x + step.x, y = result.point.y + step.y, r2 = x * x + y * y;
    constexpr double farthest = 1.5;
    const T shorter = r2 > T(farthest * farthest) ? T(T(farthest) / core_detail::square_root(r2)) : T(1);
    result.point = {shorter * x, shorter * y};
  }
  return result;
}

/// Clips the interval [from, to] of a line from a to a + d to the inside of a straight edge of the iris.
template <class R, class T>
PETZVAL_INLINE void clip_by_edge(R nx, R ny, R distance, const Point<T>& a, const Point<T>& d, T& from,
                                 T& to) noexcept {
  const T outside = nx * a.x + ny * a.y - distance, linear = nx * d.x + ny * d.y;
  // The quotient is not used if the line is parallel to the edge.
  const T crosses = -outside / linear;
  const bool begins_outside = outside > T(0), outwards = linear > T(0), inwards = linear < T(0);
  const T last = outwards ? crosses : T(2), beyond = inwards ? crosses : T(2);
  const T first = begins_outside ? beyond : T(0);
  to = last < to ? last : to;
  from = first > from ? first : from;
}
/// Clips the interval [from, to] of a line from a to a + d to the inside of an edge of the iris (IrisEdge).
template <class R, class T>
PETZVAL_INLINE void clip_by_edge(R nx, R ny, R bend, R distance, const Point<T>& a, const Point<T>& d, T& from,
                                 T& to) noexcept {
  const T square = bend * (d.x * d.x + d.y * d.y);
  const T linear = (nx * d.x + ny * d.y) + T(2) * bend * (a.x * d.x + a.y * d.y);
  const T outside = (nx * a.x + ny * a.y) + bend * (a.x * a.x + a.y * a.y) - distance;
  const T inner = linear * linear - T(4) * square * outside;
  const bool crosses = inner >= T(0), begins_outside = outside > T(0);
  // Root and quotients are not used if the line does not cross the edge.
  const T root = core_detail::square_root(inner), entering = root - linear;
  const T leaves = T(-2) * outside / (linear + root), enters = T(2) * outside / entering;
  const bool leaves_ahead = crosses & (leaves > T(0)), enters_ahead = crosses & (entering > T(0));
  const T last = leaves_ahead ? leaves : T(2), beyond = enters_ahead ? enters : T(2);
  const T first = begins_outside ? beyond : T(0);
  to = last < to ? last : to;
  from = first > from ? first : from;
}

}  // namespace
}  // namespace petzval::pupil_table_detail
