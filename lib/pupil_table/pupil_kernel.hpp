// SPDX-License-Identifier: Apache-2.0
// Samples of the pupils of film points, and their inverse: functions over a scalar. Names are local: compiled for
// several instruction sets, which the linker must not mix.
#pragma once

#include <type_traits>

#include "pupil_table/pupil_grid.hpp"

namespace petzval::pupil_table_detail {
namespace {

/// Image of a stop point in the pupil plane, in the frame of the grid, with derivatives by the stop point.
template <class V>
struct SeenPoint {
  Point<V> position, by_x, by_y;

  PETZVAL_INLINE V determinant() const noexcept { return by_x.x * by_y.y - by_y.x * by_x.y; }
  /// Area of the image of a unit area of the stop.
  PETZVAL_INLINE V area() const noexcept { return kernel::absolute(determinant()); }
  /// A step of Newton's method towards the stop point whose image is at `target`.
  PETZVAL_INLINE Point<V> step_to(const Point<V>& target) const noexcept {
    const V per = V(1) / determinant();
    const Point<V> miss = target - position;
    return {(by_y.y * miss.x - by_y.x * miss.y) * per, (by_x.x * miss.y - by_x.y * miss.x) * per};
  }
};

/// The polynomials of StopLayout.
/// @param number function; number(i) is term i
template <int terms, class V, class Number>
PETZVAL_INLINE SeenPoint<V> seen_point(const Number& number, const Point<V>& stop) noexcept {
  const V &x = stop.x, &y = stop.y;
  const V xx = x * x, yy = y * y, two(2), three(3), four(4);
  if constexpr (terms == 15) {
    const V r = xx + yy, r2 = r * r;
    const V b1 = number(1), b2 = number(2), b3 = number(3), b4 = number(4), b5 = number(5), b6 = number(6),
            b7 = number(7), b8 = number(8);
    const V a0 = number(9), a1 = number(10), a2 = number(11), a3 = number(12), a4 = number(13), a5 = number(14);
    const V across = a0 + y * (a1 + a4 * r) + a2 * xx + a3 * yy + a5 * r2;
    const V across_by_x = two * x * (a2 + a4 * y + two * a5 * r);
    const V across_by_y = a1 + two * a3 * y + a4 * (r + two * yy) + four * a5 * r * y;
    return {{x * across, number(0) + y * (b1 + b3 * y + b4 * xx + b5 * yy + b8 * r2) + b2 * xx + b6 * r2 + b7 * r * yy},
            {across + x * across_by_x, two * x * (b2 + b4 * y + two * b6 * r + b7 * yy + two * b8 * y * r)},
            {x * across_by_y, b1 + two * y * (b3 + two * b6 * r + b7 * (r + yy)) + b4 * xx + three * b5 * yy +
                                  b8 * (r2 + four * yy * r)}};
  } else {
    const auto along = [&](int o, V& by_x, V& by_y) {
      const V c1 = number(o + 1), c2 = number(o + 2), c3 = number(o + 3), c4 = number(o + 4), c5 = number(o + 5);
      const V c6 = number(o + 6), c7 = number(o + 7), c8 = number(o + 8), c9 = number(o + 9);
      by_x = c1 + two * c3 * x + c4 * y + three * c6 * xx + two * c7 * x * y + c8 * yy;
      by_y = c2 + c4 * x + two * c5 * y + c7 * xx + two * c8 * x * y + three * c9 * yy;
      return number(o) + x * (c1 + c3 * x + c4 * y + c6 * xx + c8 * yy) + y * (c2 + c5 * y + c7 * xx + c9 * yy);
    };
    SeenPoint<V> result;
    result.position.x = along(0, result.by_x.x, result.by_y.x);
    result.position.y = along(10, result.by_x.y, result.by_y.y);
    return result;
  }
}

/// A stop point found by Newton's method, and the square of the last step.
template <class V>
struct StopSolution {
  Point<V> point;
  V step2;
};
template <int terms, class V, class Number>
PETZVAL_INLINE StopSolution<V> solve_stop_point(const Number& number, const Point<V>& position) noexcept {
  StopSolution<V> result{{V(0), V(0)}, V(0)};
  for (int i = 0; i < 4; ++i) {
    const Point<V> step = seen_point<terms>(number, result.point).step_to(position);
    result.step2 = step.x * step.x + step.y * step.y;
    // Stay near the rim: outside, the polynomials are not fitted.
    const Point<V> next = result.point + step;
    const V r2 = next.x * next.x + next.y * next.y, farthest(1.5f);
    result.point = select(r2 > farthest * farthest, V(farthest / sqrt(r2)), V(1)) * next;
  }
  return result;
}

/// The stop as a film point sees it: numbers of StopLayout.
template <class Chart, class V>
struct SeenStop {
  using L = StopLayout<Chart::map_terms>;
  std::array<V, L::middle> numbers;
  Point<V> middle;

  PETZVAL_INLINE V scale() const noexcept { return numbers[L::scale]; }
  PETZVAL_INLINE auto map() const noexcept {
    return [this](int k) { return numbers[static_cast<std::size_t>(L::map + k)]; };
  }
  PETZVAL_INLINE SeenPoint<V> seen(const Point<V>& stop) const noexcept { return seen_point<L::terms>(map(), stop); }
};
template <class V, class Chart, class R>
PETZVAL_INLINE SeenStop<Chart, V> stop_at(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell) noexcept {
  using L = StopLayout<Chart::map_terms>;
  const auto middle = between<2, L::size, V>(grid.chart, grid.stop.nodes, cell, Index<V>{} + L::middle);
  return {between<L::middle, L::size, V>(grid.chart, grid.stop.nodes, cell, Index<V>{}), {middle[0], middle[1]}};
}
/// StopLayout::samples_iris of a cell.
template <class V, class Chart, class R>
PETZVAL_INLINE V samples_iris(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell) noexcept {
  using L = StopLayout<Chart::map_terms>;
  return rows<1, V>(grid.stop.nodes, Index<V>(cell.first * L::size + L::samples_iris))[0];
}

/// A part of a line, as fractions.
template <class V>
struct Interval {
  V from, to;
};

/// The part of the line from a to a + d inside the iris.
template <class V, class R>
PETZVAL_INLINE Interval<V> within_iris(const iris_detail::IrisSectors<R>& iris, const Point<V>& a,
                                       const Point<V>& d) noexcept {
  V from(0), to(1);
  const V two(2), zero(0);
  for (std::size_t k = 0; k < iris.count; ++k) {
    const R* const edge = iris.edges + 4 * k;  // IrisEdge
    const V nx(edge[0]), ny(edge[1]), bend(edge[2]), distance(edge[3]);
    V outside, leaves, enters;
    Mask<V> outwards{}, inwards{};
    // Quotients and roots are not used if the line does not cross the edge.
    if (edge[2] == R(0)) {
      outside = nx * a.x + ny * a.y - distance;
      const V linear = nx * d.x + ny * d.y;
      leaves = enters = -outside / linear;
      outwards = linear > zero, inwards = linear < zero;
    } else {
      const V square = bend * (d.x * d.x + d.y * d.y);
      const V linear = (nx * d.x + ny * d.y) + two * bend * (a.x * d.x + a.y * d.y);
      outside = (nx * a.x + ny * a.y) + bend * (a.x * a.x + a.y * a.y) - distance;
      const V inner = linear * linear - V(4) * square * outside, root = sqrt(greater(inner, zero));
      const V entering = root - linear;
      leaves = -two * outside / (linear + root), enters = two * outside / entering;
      outwards = (inner >= zero) & (leaves > zero), inwards = (inner >= zero) & (entering > zero);
    }
    to = lesser(select(outwards, leaves, two), to);
    from = greater(select(outside > zero, select(inwards, enters, two), zero), from);
  }
  return {lesser(from, to), to};
}

/// A line from the middle of the polygon of a film point to its edge.
template <class V>
struct Outwards {
  Index<V> k;
  Sector<V> sector;
  V along;  ///< fraction along the edge of the sector
  Point<V> middle, edge;
};

/// The part of a line inside the iris, in relative radii. Lines are straight in the pupil plane and nearly straight at
/// the stop. The first pass clips the straight line between the stop points of both ends; the second pass corrects the
/// line at the clipped end.
template <class V, class Chart, class R>
PETZVAL_INLINE Interval<V> clip(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell,
                                const Outwards<V>& line) noexcept {
  using L = StopLayout<Chart::map_terms>;
  const SeenStop<Chart, V> stop = stop_at<V>(grid, cell);
  const auto edge = between<4, L::size, V>(grid.chart, grid.stop.nodes, cell, Index<V>(line.k * 2 + L::corners));
  const V per_scale = V(1) / stop.scale();
  const Point<V> a{edge[0], edge[1]}, b{edge[2], edge[3]};
  const Point<V> begin = per_scale * Chart::to_film(cell, stop.middle);
  const Point<V> way = per_scale * Chart::to_film(cell, a + line.along * (b - a) - stop.middle);
  const V look = greater(within_iris(grid.stop.iris, begin, way).to, V(0.25f));
  const Point<V> straight = Chart::to_grid(cell, stop.scale() * (begin + look * way));
  const Point<V> bent = stop.seen(straight).step_to(line.middle + look * line.edge);
  return within_iris(grid.stop.iris, begin, way + V(per_scale / look) * Chart::to_film(cell, bent));
}

template <class V>
struct PupilPoint {
  V x, y, area;
};

/// Calls body(obscured, stopped) with compile-time constants. Tables over a quadrant leave out no obscuration.
template <class Grid, class Body>
auto with_kind(const Grid& grid, const Body& body) noexcept {
  const auto by_stop = [&](auto obscured) {
    return grid.stop.nodes ? body(obscured, std::true_type()) : body(obscured, std::false_type());
  };
  if constexpr (Grid::Chart::cell_nodes == 2) {
    if (grid.obscured) return by_stop(std::true_type());
  }
  return by_stop(std::false_type());
}

/// Samples the polygon, or its part inside the iris.
template <bool obscured, bool stopped, class V, class Chart, class R>
PETZVAL_INLINE PupilPoint<V> in_polygon(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell, const V& u,
                                        const V& v) noexcept {
  constexpr auto sectors = static_cast<std::int32_t>(polygon_corners);
  const V turns = V(static_cast<R>(sectors)) * clamped(Chart::fraction(cell, clamped(u)));
  const Step<V> at = step_of(turns, sectors);
  const Sector<V> sector = sector_of<obscured, V>(grid, cell, at.cell);
  const Outwards<V> line{at.cell, sector, at.rest, middle_of<V>(grid, cell), sector.at(V(1), at.rest)};
  V square = clamped(v), area = line.sector.sampled_area();
  if constexpr (stopped) {
    const Interval<V> part = clip<V>(grid, cell, line);
    const V first = line.sector.fraction_within(part.from * part.from);
    const V fraction = line.sector.fraction_within(part.to * part.to) - first;
    square = first + square * fraction, area = area * fraction;
  }
  if constexpr (obscured) square = line.sector.squared_radius(square);
  const Point<V> p = Chart::to_film(cell, line.middle + V(sqrt(square)) * line.edge);
  const Mask<V> lit = cell.known & (area > V(0));
  return {select(lit, p.x, V(0)), select(lit, p.y, V(0)), select(lit, area, V(0))};
}

/// Samples the iris and maps the sample to the pupil plane.
template <class V, class Chart, class R>
PETZVAL_INLINE PupilPoint<V> in_iris(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell, const V& u,
                                     const V& v) noexcept {
  const SeenStop<Chart, V> stop = stop_at<V>(grid, cell);
  const auto of_iris = iris_detail::iris_point<V>(grid.stop.iris, clamped(u), clamped(v));
  const SeenPoint<V> seen = stop.seen(Chart::to_grid(cell, stop.scale() * Point<V>{of_iris.x, of_iris.y}));
  const Point<V> p = Chart::to_film(cell, seen.position);
  const V area = V(grid.stop.area) * stop.scale() * stop.scale() * seen.area();
  return {select(cell.known, p.x, V(0)), select(cell.known, p.y, V(0)), select(cell.known, area, V(0))};
}

/// The stop point of a position in the pupil plane, in the frame of the film and divided by the scale of the iris, and
/// the pupil area that a sample of the iris at this position represents.
template <class V, class Chart, class R>
PETZVAL_INLINE PupilPoint<V> stop_point(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell,
                                        const SeenStop<Chart, V>& stop, const Point<V>& position) noexcept {
  const StopSolution<V> found = solve_stop_point<Chart::map_terms>(stop.map(), Chart::to_grid(cell, position));
  const Point<V> p = V(V(1) / stop.scale()) * Chart::to_film(cell, found.point);
  const V area = V(grid.stop.area) * stop.scale() * stop.scale() * stop.seen(found.point).area();
  return {p.x, p.y, select(found.step2 < V(1e-6f), area, V(0))};
}

/// Pupil area that a sample of the iris at a position represents; 0 if there is no such sample.
template <class V, class Chart, class R>
PETZVAL_INLINE V area_in_iris(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell,
                              const Point<V>& position) noexcept {
  const PupilPoint<V> p = stop_point<V>(grid, cell, stop_at<V>(grid, cell), position);
  Mask<V> inside = cell.known & (p.x * p.x + p.y * p.y <= V(iris_detail::rim_squared<R>));
  for (std::size_t k = 0; k < grid.stop.iris.count; ++k) {
    inside = inside & iris_detail::within_edge(grid.stop.iris, k, p.x, p.y);
  }
  return select(inside, p.area, V(0));
}

/// The inverse of in_polygon(): the line through a position, its squared relative radius, the part of the line that is
/// sampled, as v, and the pupil area that a sample at the position represents; area 0 if there is no such sample.
template <class V>
struct Located {
  Outwards<V> line;
  V squared_radius;
  Interval<V> part;
  V area;
  Mask<V> faced;  ///< true if a sector faces the position
};
template <bool obscured, bool stopped, class V, class Chart, class R>
PETZVAL_INLINE Located<V> locate(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell,
                                 const Point<V>& position) noexcept {
  const Point<V> middle = middle_of<V>(grid, cell), q = Chart::to_grid(cell, position) - middle;
  const Index<V> k = sector_before(q, [&](const Index<V>& i) { return corner_of<V>(grid, cell, i); });
  const Sector<V> sector = sector_of<obscured, V>(grid, cell, k);
  const V radius = sector.relative_radius(q), squared = radius * radius, along = sector.along_to(q);
  Located<V> result{{k, sector, along, middle, sector.at(V(1), along)}, squared, {V(0), V(1)}, V(0), sector.faces(q)};
  Mask<V> inside = cell.known & result.faced;
  V area = sector.sampled_area();
  if constexpr (stopped) {
    const Interval<V> part = clip<V>(grid, cell, result.line);
    const V from = part.from * part.from, to = part.to * part.to;
    inside = inside & (squared <= to) & (squared >= from);
    result.part = {sector.fraction_within(from), sector.fraction_within(to)};
    area = area * (result.part.to - result.part.from);
  } else {
    inside = inside & (squared <= V(1));
  }
  if constexpr (obscured) area = select(sector.obscures(squared), V(0), area);
  result.area = select(inside, area, V(0));
  return result;
}

}  // namespace
}  // namespace petzval::pupil_table_detail
