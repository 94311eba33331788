// SPDX-License-Identifier: Apache-2.0
// Pupils at the nodes of a grid, interpolated at points between the nodes. A chart finds the nodes around a point.
// Names are local: compiled for several instruction sets, which the linker must not mix.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "iris/iris_sample.hpp"
#include "pupil_table/sector.hpp"

namespace petzval::pupil_table_detail {

/// Numbers of one node. Corners are relative to the middle; corner 64 is corner 0.
struct NodeLayout {
  static constexpr std::int32_t middle = 0, corners = 2;
  /// Begin and width of the obscured interval of each sector.
  static constexpr std::int32_t obscured = corners + 2 * (static_cast<std::int32_t>(polygon_corners) + 1);
  static constexpr std::int32_t size = obscured + 2 * static_cast<std::int32_t>(polygon_corners);
};

/// Numbers of the stop at one node, in semi-diameters.
/// @tparam terms_of_map terms of the map from stop point (x, y) to pupil position. With 15 terms and r = x^2 + y^2: for
///   pupil y (even in x) 1, y, x^2, y^2, x^2 y, y^3, r^2, r y^2, r^2 y; for pupil x divided by x: 1, y, x^2, y^2, r y,
///   r^2. With 20 terms: for pupil x, then for pupil y: 1, x, y, x^2, xy, y^2, x^3, x^2 y, x y^2, y^3.
template <int terms_of_map>
struct StopLayout {
  static constexpr std::int32_t terms = terms_of_map;
  static constexpr std::int32_t scale = 0;                           ///< enlarges the iris, so that no ray is missed
  static constexpr std::int32_t map = 1;                             ///< the terms
  static constexpr std::int32_t middle = (map + terms + 3) / 4 * 4;  ///< stop point of the middle
  /// 1 to sample the iris in the cell that begins at this node; 0 to sample the polygon inside the iris.
  static constexpr std::int32_t samples_iris = middle + 2;
  static constexpr std::int32_t corners = middle + 4;  ///< stop points of the corners
  static constexpr std::int32_t size = corners + 2 * (static_cast<std::int32_t>(polygon_corners) + 1);
};

/// Film points within this squared distance from the axis, mm^2, count as on the axis: smaller squares have too few
/// digits for a direction.
template <class R>
inline constexpr R axis_r2 = std::numeric_limits<R>::min() / std::numeric_limits<R>::epsilon();

namespace {

template <class V>
using Index = typename kernel::Table<V>::Index;
template <class V>
using Mask = kernel::Mask<V>;
template <int n, class V, class R>
PETZVAL_INLINE std::array<V, n> rows(const R* from, const Index<V>& at) noexcept {
  return kernel::Table<V>::template rows<n>(from, at);
}

template <class V>
PETZVAL_INLINE V sign_of(const V& x) noexcept {
  return select(x < V(0), V(-1), V(1));
}

/// Angle of a direction from +y towards +x, as a fraction of a full turn in [-1/2, 1/2], within 6e-8. u starts at +y of
/// the film, not at the direction of the film point: near the axis, adjacent film points get adjacent samples.
template <class V>
PETZVAL_INLINE V turn_of(const V& sine, const V& cosine) noexcept {
  using R = kernel::Storage<V>;
  const V across = kernel::absolute(sine), along = kernel::absolute(cosine), a = lesser(along, across), s = a * a;
  // asin(a) / 2 pi up to an eighth of a turn: fit of least maximum error, exactly 1/8 at the end.
  const V s2 = s * s;
  const V first = V(R(0.15915393812486814)) + s * V(R(0.0265771964583));
  const V second = V(R(0.0111934983367)) + s * V(R(0.0116048821993));
  const V third = V(R(-0.0077339762488)) + s * V(R(0.0181935231706));
  V turn = a * (first + s2 * (second + s2 * third));
  turn = select(along < across, V(V(R(0.25)) - turn), turn);
  turn = select(cosine < V(0), V(V(R(0.5)) - turn), turn);
  return select(sine < V(0), V(-turn), turn);
}

/// The fractional part of a number from -1 to 2.
template <class V>
PETZVAL_INLINE V fraction_of(const V& x) noexcept {
  const V from_0 = select(x < V(0), V(x + V(1)), x);
  return select(from_0 > V(1), V(from_0 - V(1)), from_0);
}

/// The nodes around a point.
template <class V, int count>
struct Cell {
  std::array<V, count> weights;  ///< for linear interpolation
  V cosine, sine;                ///< frame of the film point, see the chart
  Mask<V> known;                 ///< true if the point has a cell
  Index<V> first;                ///< index of the first node
};

/// The whole part of a position along an axis with `cells` cells, and the fraction within the cell.
template <class V>
struct Step {
  Index<V> cell;
  V rest;
};
template <class V>
PETZVAL_INLINE Step<V> step_of(const V& position, std::int32_t cells) noexcept {
  using R = kernel::Storage<V>;
  const Index<V> cell = kernel::Table<V>::whole(lesser(position, V(static_cast<R>(cells - 1))));
  return {cell, position - kernel::Table<V>::number(cell)};
}

/// False if a number is NaN or infinite.
template <class V>
PETZVAL_INLINE Mask<V> all_finite(const V& a, const V& b, const V& c, const V& d) noexcept {
  return (a + b + c + d) * V(0) >= V(0);
}

}  // namespace

/// Film points of a lens of revolution: nodes are equally spaced in the distance from the axis. Polygons belong to film
/// points on +y and rotate with the film point; cosine and sine belong to the angle from +y towards +x.
template <class R>
struct FilmRadius {
  static constexpr int cell_nodes = 2, map_terms = 15;
  std::int32_t rows = 0;
  R reach = 0, rows_per_mm = 0;  ///< distance of the farthest film point, mm

  std::int32_t nodes() const noexcept { return rows + 1; }
  static constexpr std::int32_t offset(int node) noexcept { return node; }
  /// @param sound mask of the points that may have a pupil
  /// @param begin first node of the wavelength
  template <class V>
  PETZVAL_INLINE Cell<V, 2> find(const V& x, const V& y, const Mask<V>& sound, const Index<V>& begin) const noexcept {
    const V r2 = x * x + y * y, r = sqrt(r2);
    const Mask<V> known = (r <= V(reach)) & sound, off_axis = known & (r2 > V(axis_r2<R>));
    const V per_length = V(1) / select(off_axis, r, V(1));
    const Step<V> row = step_of(select(known, V(r * V(rows_per_mm)), V(0)), rows);
    return {{V(1) - row.rest, row.rest},
            select(off_axis, V(y * per_length), V(1)),
            select(off_axis, V(x * per_length), V(0)),
            known,
            begin + row.cell};
  }
  /// Converts u, which starts at +y of the film, to the position among the sectors as a fraction, and back.
  template <class V>
  static PETZVAL_INLINE V fraction(const Cell<V, 2>& at, const V& u) noexcept {
    return fraction_of(V(u - turn_of(at.sine, at.cosine)));
  }
  template <class V>
  static PETZVAL_INLINE V u_of(const Cell<V, 2>& at, const V& fraction) noexcept {
    return fraction_of(V(fraction + turn_of(at.sine, at.cosine)));
  }
  /// Rotates a point from the frame of the grid to the frame of the film, and back.
  template <class V>
  static PETZVAL_INLINE Point<V> to_film(const Cell<V, 2>& at, const Point<V>& p) noexcept {
    return {at.cosine * p.x + at.sine * p.y, at.cosine * p.y - at.sine * p.x};
  }
  template <class V>
  static PETZVAL_INLINE Point<V> to_grid(const Cell<V, 2>& at, const Point<V>& p) noexcept {
    return {at.cosine * p.x - at.sine * p.y, at.sine * p.x + at.cosine * p.y};
  }
};

/// Film points of a lens that is symmetric about x = 0 and y = 0: cells cover the quadrant x, y >= 0. Rows are equally
/// spaced in y, the nodes of a row in x up to half_widths; pupils of the other quadrants are mirror images. Corner 0 is
/// in the direction +y from the middle, corner 32 in the direction -y. cosine and sine are the signs of y and x.
template <class R>
struct FilmQuadrant {
  static constexpr int cell_nodes = 4, map_terms = 20;
  std::int32_t rows = 0, columns = 1;
  R reach = 0, rows_per_mm = 0;
  const R* half_widths = nullptr;  ///< [rows + 1] mm

  std::int32_t nodes() const noexcept { return (rows + 1) * (columns + 1); }
  std::int32_t offset(int node) const noexcept { return node % 2 + node / 2 * (columns + 1); }
  template <class V>
  PETZVAL_INLINE Cell<V, 4> find(const V& film_x, const V& film_y, const Mask<V>& sound,
                                 const Index<V>& begin) const noexcept {
    const V x = kernel::absolute(film_x), y = kernel::absolute(film_y);
    const V end(R(1) + R(1e-6));  // the rounded edge still belongs to the film
    const V up = y * V(rows_per_mm);
    const Mask<V> in_rows = all_of(x * x + y * y <= V(reach * reach), up <= end * V(static_cast<R>(rows)), sound);
    const Step<V> row = step_of(select(in_rows, up, V(0)), rows);
    const auto half = pupil_table_detail::rows<2, V>(half_widths, row.cell);
    const V& s = row.rest;
    const V width = half[0] + s * (half[1] - half[0]);
    const Mask<V> known = all_of(in_rows, x <= end * width);
    const V across = x / positive_or_one(width) * V(static_cast<R>(columns));
    const Step<V> column = step_of(select(known, across, V(0)), columns);
    const V& t = column.rest;
    const V both = t * s;
    return {{V(1) - t - s + both, t - both, s - both, both},
            sign_of(film_y),
            sign_of(film_x),
            known,
            begin + row.cell * (columns + 1) + column.cell};
  }
  template <class V>
  static PETZVAL_INLINE V fraction(const Cell<V, 4>& at, const V& u) noexcept {
    const V across = V(0.5f) * (V(1) - at.sine) + at.sine * u;
    return fraction_of(V(V(0.25f) * (V(1) - at.cosine) + at.cosine * across));
  }
  template <class V>
  static PETZVAL_INLINE V u_of(const Cell<V, 4>& at, const V& fraction) noexcept {
    const V across = at.cosine * (fraction - V(0.25f) * (V(1) - at.cosine));
    return fraction_of(V(at.sine * (across - V(0.5f) * (V(1) - at.sine))));
  }
  template <class V>
  static PETZVAL_INLINE Point<V> to_film(const Cell<V, 4>& at, const Point<V>& p) noexcept {
    return {at.sine * p.x, at.cosine * p.y};
  }
  template <class V>
  static PETZVAL_INLINE Point<V> to_grid(const Cell<V, 4>& at, const Point<V>& p) noexcept {
    return to_film(at, p);
  }
};

/// The stop of a lens for the pupils of a grid, borrowed. nodes: null if the stop is round.
template <class R>
struct GridStop {
  const R* nodes = nullptr;  ///< StopLayout, in the order of PupilGrid::nodes
  iris_detail::IrisSectors<R> iris;
  R area = 0;  ///< area of the iris, in squares of the semi-diameter
};

/// The nodes of all wavelengths, borrowed.
template <class ChartOfPoints, class R>
struct PupilGrid {
  using Chart = ChartOfPoints;
  using Number = R;
  Chart chart;
  const R* nodes = nullptr;  ///< [wavelength][node] NodeLayout
  std::int32_t wavelengths = 0, primary = 0;
  bool obscured = false;  ///< true if at least one sector is partly obscured
  GridStop<R> stop;
};

namespace {

template <class Chart, class V>
using CellOf = Cell<V, Chart::cell_nodes>;

/// n numbers, from number k on, interpolated between the nodes of a cell.
/// @tparam size how many numbers the table has for each node
template <int n, std::int32_t size, class V, class Chart, class R>
PETZVAL_INLINE std::array<V, n> between(const Chart& chart, const R* table, const CellOf<Chart, V>& cell,
                                        const Index<V>& k) noexcept {
  const Index<V> from = cell.first * size + k;
  std::array<V, n> sum = rows<n, V>(table, from);
  for (V& number : sum) number = cell.weights[0] * number;
  for (int node = 1; node < Chart::cell_nodes; ++node) {
    const auto other = rows<n, V>(table, Index<V>(from + size * chart.offset(node)));
    for (std::size_t i = 0; i < n; ++i) sum[i] = sum[i] + cell.weights[static_cast<std::size_t>(node)] * other[i];
  }
  return sum;
}

template <class V, class Chart, class R>
PETZVAL_INLINE Point<V> middle_of(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell) noexcept {
  if constexpr (Chart::cell_nodes == 2) {  // on +y
    const Index<V> y = Index<V>{} + (NodeLayout::middle + 1);
    return {V(0), between<1, NodeLayout::size, V>(grid.chart, grid.nodes, cell, y)[0]};
  } else {
    const auto n = between<2, NodeLayout::size, V>(grid.chart, grid.nodes, cell, Index<V>{} + NodeLayout::middle);
    return {n[0], n[1]};
  }
}

template <class V, class Chart, class R>
PETZVAL_INLINE Point<V> corner_of(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell,
                                  const Index<V>& k) noexcept {
  const auto n = between<2, NodeLayout::size, V>(grid.chart, grid.nodes, cell, Index<V>(k * 2 + NodeLayout::corners));
  return {n[0], n[1]};
}

template <bool obscured, class V, class Chart, class R>
PETZVAL_INLINE Sector<V> sector_of(const PupilGrid<Chart, R>& grid, const CellOf<Chart, V>& cell,
                                   const Index<V>& k) noexcept {
  const auto n = between<4, NodeLayout::size, V>(grid.chart, grid.nodes, cell, Index<V>(k * 2 + NodeLayout::corners));
  Sector<V> sector{{n[0], n[1]}, {n[2], n[3]}, V(0), V(0)};
  if constexpr (obscured) {
    const Index<V> at = k * 2 + NodeLayout::obscured;
    const auto interval = between<2, NodeLayout::size, V>(grid.chart, grid.nodes, cell, at);
    sector.obscured_from = interval[0], sector.obscured = interval[1];
  }
  return sector;
}

/// The last sector whose first corner is before a position relative to the middle, by bisection.
/// @param corner function; corner(k) is corner k
template <class V, class Corner>
PETZVAL_INLINE Index<V> sector_before(const Point<V>& q, const Corner& corner) noexcept {
  using Table = kernel::Table<V>;
  const Point<V> first = corner(Index<V>{});
  const Mask<V> second_half = turn(first, q) < V(0);
  V found(0);
  for (int step = static_cast<int>(polygon_corners) / 2; step > 0; step /= 2) {
    const V next = found + V(static_cast<float>(step));
    const Point<V> at = corner(Table::whole(next));
    const Mask<V> late = turn(first, at) < V(0), behind = turn(at, q) >= V(0);
    const V in_late = select(late, select(behind, next, found), next);
    const V in_early = select(late, found, select(behind, next, found));
    found = select(second_half, in_late, in_early);
  }
  return Table::whole(found);
}

}  // namespace
}  // namespace petzval::pupil_table_detail
