// SPDX-License-Identifier: Apache-2.0
// Blocks of samples of the pupils in a grid: loops without branches that the compiler vectorizes. A block of one is a
// single sample. Names are local, and no other library is called, as in lib/core/lanes.hpp.
#pragma once

#include <type_traits>

#include "core/widest.hpp"
#include "petzval/lens/wavelength.hpp"
#include "polygon_grid.hpp"

namespace petzval::pupil_table_detail {
namespace {

template <std::size_t block, class T>
struct CellPositions {
  T t[block], s[block], cosine[block], sine[block], lit[block];  // lit: 1 or 0
  std::int32_t cell[block];
};

template <std::size_t block, int dimensions, class R, class T>
PETZVAL_INLINE void find_cell_positions(const PolygonGrid<dimensions, R>& grid, const T* film_x, const T* film_y,
                                        const T* u, const T* v, const std::int32_t* wavelength,
                                        CellPositions<block, T>& positions) noexcept {
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    // Comparisons with NaN are false.
    const T sound = (film_x[i] + film_y[i] + u[i] + v[i]) * R(0);
    const CellPosition<T> at = cell_position(grid, film_x[i], film_y[i], sound >= R(0), wavelength[i]);
    positions.t[i] = at.t, positions.s[i] = at.s;
    positions.cosine[i] = at.cosine, positions.sine[i] = at.sine;
    positions.lit[i] = at.known ? T(1) : T(0);
    positions.cell[i] = at.cell;
  }
}

/// Lines through the polygons of film points, from the middle (0) to the outer edge (1).
template <std::size_t block, class T>
struct Lines {
  std::int32_t sector[block];
  T along[block], edge_x[block],
      edge_y[block];         // intersection with the edge: fraction along the edge, and position from the middle
  T from[block], to[block];  // interval inside the iris
};

/// Intervals of lines inside the iris. Lines are in the frame of the film, divided by the scale of the iris.
template <std::size_t block, class R, class T>
PETZVAL_INLINE void cut_by_edges(const iris_detail::IrisSectors<R>& iris, const T* begin_x, const T* begin_y,
                                 const T* line_x, const T* line_y, T* from, T* to) noexcept {
  for (std::size_t i = 0; i < block; ++i) from[i] = T(0), to[i] = T(1);
  for (std::size_t k = 0; k < iris.count; ++k) {
    const R* const edge = iris.edges + 4 * k;
    const R nx = edge[0], ny = edge[1], bend = edge[2], distance = edge[3];
    if (bend == R(0)) {
      PETZVAL_INDEPENDENT
      for (std::size_t i = 0; i < block; ++i) {
        clip_by_edge(nx, ny, distance, Point<T>{begin_x[i], begin_y[i]}, Point<T>{line_x[i], line_y[i]}, from[i],
                     to[i]);
      }
    } else {
      PETZVAL_INDEPENDENT
      for (std::size_t i = 0; i < block; ++i) {
        clip_by_edge(nx, ny, bend, distance, Point<T>{begin_x[i], begin_y[i]}, Point<T>{line_x[i], line_y[i]}, from[i],
                     to[i]);
      }
    }
  }
}

/// Clips lines at the iris. Lines are straight in the pupil plane and nearly straight at the stop. The first pass clips
/// the straight line between the stop points of both ends; the second pass corrects the line at the clipped end.
template <std::size_t block, int dimensions, class R, class T>
PETZVAL_INLINE void clip_by_iris(const PolygonGrid<dimensions, R>& grid, const CellPositions<block, T>& positions,
                                 Lines<block, T>& lines) noexcept {
  using S = StopLayout<dimensions>;
  const R* const stop = grid.stop.cells;
  const iris_detail::IrisSectors<R> iris = grid.stop.iris;
  T begin_x[block], begin_y[block], line_x[block], line_y[block], look[block], from[block], to[block];
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t cell = positions.cell[i] * S::size, at = cell + S::corners + 2 * S::linear * lines.sector[i];
    const T t = positions.t[i], s = positions.s[i], along = lines.along[i];
    const Point<T> a = point_in_cell<dimensions>(stop, at, t, s);
    const Point<T> b = point_in_cell<dimensions>(stop, at + 2 * S::linear, t, s);
    const Point<T> middle = point_in_cell<dimensions>(stop, cell + S::middle, t, s);
    const R per_scale = R(1) / stop[cell + S::scale];
    const Point<T> begin = to_film<dimensions>(positions.cosine[i], positions.sine[i], middle);
    const Point<T> line = to_film<dimensions>(positions.cosine[i], positions.sine[i], a + along * (b - a) - middle);
    begin_x[i] = per_scale * begin.x, begin_y[i] = per_scale * begin.y;
    line_x[i] = per_scale * line.x, line_y[i] = per_scale * line.y;
  }
  cut_by_edges<block>(iris, begin_x, begin_y, line_x, line_y, from, to);
  for (std::size_t i = 0; i < block; ++i) {
    const T least = T(0.25), last = to[i];
    look[i] = last > least ? last : least;
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t cell = positions.cell[i] * S::size;
    const T t = positions.t[i], s = positions.s[i], at = look[i];
    const R scale = stop[cell + S::scale], per_scale = R(1) / scale;
    const Point<T> middle =
        CellPolygon<dimensions, false, R, T>{grid.cells, positions.cell[i] * CellLayout<dimensions>::size, t, s}
            .middle();
    const auto number = [&](int k) { return linear_in_cell<dimensions>(stop, cell + S::map + S::linear * k, t, s); };
    const Point<T> straight =
        to_grid<dimensions>(positions.cosine[i], positions.sine[i],
                            Point<T>{scale * (begin_x[i] + at * line_x[i]), scale * (begin_y[i] + at * line_y[i])});
    const Point<T> position{middle.x + at * lines.edge_x[i], middle.y + at * lines.edge_y[i]};
    const Point<T> off = newton_step(seen_point<dimensions>(number, straight), position);
    const Point<T> bent = to_film<dimensions>(positions.cosine[i], positions.sine[i], off);
    line_x[i] += per_scale * bent.x / at, line_y[i] += per_scale * bent.y / at;
  }
  cut_by_edges<block>(iris, begin_x, begin_y, line_x, line_y, from, to);
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const T first = from[i], last = to[i];
    lines.to[i] = last;
    lines.from[i] = first < last ? first : last;
  }
}

/// Samples the polygons, or the part of each polygon inside the iris.
template <std::size_t block, bool obscured, bool stopped, int dimensions, class R, class T>
PETZVAL_INLINE void sample_polygons(const PolygonGrid<dimensions, R>& grid, const CellPositions<block, T>& positions,
                                    const T* u, const T* v, T* x, T* y, T* area) noexcept {
  using L = CellLayout<dimensions>;
  constexpr auto corners = static_cast<std::int32_t>(polygon_corners);
  T target[block], total_area[block], behind[block], beyond[block];
  std::int32_t sector[block];
  const auto polygon = [&grid, &positions](std::size_t i) {
    return CellPolygon<dimensions, obscured, R, T>{grid.cells, positions.cell[i] * L::size, positions.t[i],
                                                   positions.s[i]};
  };
  const R early = grid.corrections > 0 ? R(0) : R(0.5), last = static_cast<R>(corners - 1);
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const auto own = polygon(i);
    total_area[i] = positions.lit[i] * own.total_area();
    // Interpolated areas may be negative and give meaningless fractions; the clamp keeps the sector number valid.
    target[i] = core_detail::clamped(
        own.fraction_of_sample(core_detail::clamped(u[i]), total_area[i], positions.cosine[i], positions.sine[i]));
    const T expected = own.expected(target[i], total_area[i]) - early;
    const T above = expected > R(0) ? expected : T(0);
    sector[i] = static_cast<std::int32_t>(above < last ? above : T(last));
    target[i] = target[i] * total_area[i];
  }
  // Sectors have nearly equal areas: the target lies in this sector, in the next, or close to these.
  for (int step = 0; step < grid.corrections; ++step) {
    const std::int32_t first = sector[0];
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const std::int32_t k = sector[i];
      const std::int32_t back = (target[i] < polygon(i).area_before(k)) & (k > 0);
      const std::int32_t on = (target[i] > polygon(i).area_before(k + 1)) & (k < corners - 1);
      sector[i] = k + on - back;
    }
    if (block == 1 && sector[0] == first) break;  // in a large block nearly every step moves some sector
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t k = sector[i];
    behind[i] = target[i] - polygon(i).area_before(k + 1);
    const std::int32_t next = (behind[i] >= R(0)) & (k < corners - 1);
    sector[i] = k + next;
    beyond[i] = T(static_cast<R>(1 - next));
  }
  // Fraction along the edge from the first corner of the sector, or backwards from the second corner.
  const auto along_edge = [&behind, &beyond](std::size_t i, const Sector<T>& own) {
    const T own_area = own.area();
    return core_detail::clamped(T(behind[i] / (own_area > R(0) ? own_area : T(1)) + beyond[i]));
  };
  const auto put = [&](std::size_t i, const Point<T>& p, const T& lit) {
    const Point<T> middle = polygon(i).middle();
    const Point<T> from_axis = dimensions == 1 ? Point<T>{p.x, middle.y + p.y} : middle + p;
    const Point<T> position = to_film<dimensions>(positions.cosine[i], positions.sine[i], from_axis);
    const T lit_factor = lit > R(0) ? T(1) : T(0);
    x[i] = lit_factor * position.x;
    y[i] = lit_factor * position.y;
    area[i] = lit_factor * lit;
  };
  if constexpr (!stopped) {
    // The output arrays do not overlap the input.
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const Sector<T> own = polygon(i).sector(sector[i]);
      const T along = along_edge(i, own);
      put(i, own.at(core_detail::square_root(own.squared_radius(core_detail::clamped(v[i]))), along), total_area[i]);
    }
  } else {
    Lines<block, T> lines;
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const Sector<T> own = polygon(i).sector(sector[i]);
      lines.sector[i] = sector[i];
      lines.along[i] = along_edge(i, own);
      const Point<T> edge = own.at(T(1), lines.along[i]);
      lines.edge_x[i] = edge.x, lines.edge_y[i] = edge.y;
    }
    clip_by_iris<block>(grid, positions, lines);
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      Sector<T> own{};  // for the obscured interval only
      if constexpr (obscured) own = polygon(i).sector(sector[i]);
      const T first = own.fraction_within(lines.from[i] * lines.from[i]);
      const T fraction = own.fraction_within(lines.to[i] * lines.to[i]) - first;
      const T radius = core_detail::square_root(own.squared_radius(first + core_detail::clamped(v[i]) * fraction));
      put(i, {radius * lines.edge_x[i], radius * lines.edge_y[i]}, total_area[i] * fraction);
    }
  }
}

/// Samples the iris and maps the samples to the pupil plane.
template <std::size_t block, int dimensions, class R, class T>
PETZVAL_INLINE void sample_iris(const PolygonGrid<dimensions, R>& grid, const CellPositions<block, T>& positions,
                                const T* u, const T* v, T* x, T* y, T* area) noexcept {
  using S = StopLayout<dimensions>;
  const GridStop<R> stop = grid.stop;
  const auto fill = [&](const auto& point_at) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const std::int32_t begin = positions.cell[i] * S::size;
      const R scale = stop.cells[begin + S::scale];
      const auto [sx, sy] = point_at(core_detail::clamped(R(u[i])), core_detail::clamped(R(v[i])));
      const Point<T> own =
          to_grid<dimensions>(positions.cosine[i], positions.sine[i], Point<T>{T(scale * sx), T(scale * sy)});
      const auto number = [&](int k) {
        return linear_in_cell<dimensions>(stop.cells, begin + S::map + S::linear * k, positions.t[i], positions.s[i]);
      };
      const SeenPoint<T> seen = seen_point<dimensions>(number, own);
      const Point<T> position = to_film<dimensions>(positions.cosine[i], positions.sine[i], seen.position);
      x[i] = positions.lit[i] * position.x;
      y[i] = positions.lit[i] * position.y;
      area[i] = positions.lit[i] * (stop.area * scale * scale) * seen.area();
    }
  };
  if (stop.iris.count == 0) {
    fill([](R a, R b) { return iris_detail::disc_point(a, b); });
  } else {
    fill([iris = stop.iris](R a, R b) { return iris_detail::sector_point(iris, a, b); });
  }
}

/// Samples one block. Unused slots hold zeros.
template <std::size_t block, bool obscured, bool stopped, int dimensions, class R, class T>
PETZVAL_INLINE void sample_block(const PolygonGrid<dimensions, R>& given, const T* film_x, const T* film_y, const T* u,
                                 const T* v, const std::int32_t* wavelength, T* x, T* y, T* area) noexcept {
  const PolygonGrid<dimensions, R> grid = given;  // a copy that no output can alias
  CellPositions<block, T> positions;
  find_cell_positions(grid, film_x, film_y, u, v, wavelength, positions);
  if constexpr (!stopped) {
    sample_polygons<block, obscured, false>(grid, positions, u, v, x, y, area);
  } else {
    using S = StopLayout<dimensions>;
    R samples_iris[block], count = 0;
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i)
      samples_iris[i] = grid.stop.cells[positions.cell[i] * S::size + S::samples_iris];
    for (std::size_t i = 0; i < block; ++i) count += samples_iris[i];
    if (count == static_cast<R>(block)) {
      sample_iris<block>(grid, positions, u, v, x, y, area);
      return;
    }
    if (count == R(0)) {
      sample_polygons<block, obscured, true>(grid, positions, u, v, x, y, area);
      return;
    }
    T iris_x[block], iris_y[block], iris_area[block], polygon_x[block], polygon_y[block], polygon_area[block];
    sample_iris<block>(grid, positions, u, v, iris_x, iris_y, iris_area);
    sample_polygons<block, obscured, true>(grid, positions, u, v, polygon_x, polygon_y, polygon_area);
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      x[i] = samples_iris[i] > R(0) ? iris_x[i] : polygon_x[i];
      y[i] = samples_iris[i] > R(0) ? iris_y[i] : polygon_y[i];
      area[i] = samples_iris[i] > R(0) ? iris_area[i] : polygon_area[i];
    }
  }
}

/// Finds the sectors that contain the directions of positions relative to the middle, by bisection.
template <std::size_t block, int dimensions, class R>
PETZVAL_INLINE void find_sectors(const PolygonGrid<dimensions, R>& grid, const CellPositions<block, R>& positions,
                                 const Point<R>* q, std::int32_t* sector) noexcept {
  constexpr auto corners = static_cast<std::int32_t>(polygon_corners);
  const auto corner = [&](std::size_t i, std::int32_t k) {
    return CellPolygon<dimensions, false, R, R>{grid.cells, positions.cell[i] * CellLayout<dimensions>::size,
                                                positions.t[i], positions.s[i]}
        .corner(k);
  };
  std::int32_t half[block];
  R first_x[block], first_y[block];
  // half: 1 if q lies more than 180 degrees after the first corner.
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const Point<R> first = corner(i, 0);
    first_x[i] = first.x, first_y[i] = first.y;
    half[i] = turn(first, q[i]) < R(0);
    sector[i] = 0;
  }
  for (std::int32_t step = corners / 2; step > 0; step /= 2) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const Point<R> c = corner(i, sector[i] + step);
      const std::int32_t corner_half = turn(Point<R>{first_x[i], first_y[i]}, c) < R(0), behind = turn(c, q[i]) >= R(0);
      sector[i] += (corner_half < half[i]) | ((corner_half == half[i]) & behind) ? step : 0;
    }
  }
}

/// Stop points of positions in the pupil plane, in the frame of the film and divided by the scale of the iris, and the
/// pupil areas that samples at these positions represent.
template <std::size_t block, int dimensions, class R>
PETZVAL_INLINE void find_stop_points(const PolygonGrid<dimensions, R>& grid, const CellPositions<block, R>& positions,
                                     const R* x, const R* y, Point<R>* points, R* area) noexcept {
  using S = StopLayout<dimensions>;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const std::int32_t begin = positions.cell[i] * S::size;
    const auto number = [&](int k) {
      return linear_in_cell<dimensions>(grid.stop.cells, begin + S::map + S::linear * k, positions.t[i],
                                        positions.s[i]);
    };
    const Point<R> position = to_grid<dimensions>(positions.cosine[i], positions.sine[i], Point<R>{x[i], y[i]});
    const StopSolution<R> found = solve_stop_point<dimensions>(number, position);
    const R scale = grid.stop.cells[begin + S::scale];
    points[i] = R(1) / scale * to_film<dimensions>(positions.cosine[i], positions.sine[i], found.point);
    const R near = found.step2 < R(1e-6) ? R(1) : R(0);
    area[i] = near * grid.stop.area * scale * scale * seen_point<dimensions>(number, found.point).area();
  }
}

/// Pupil areas that samples at given positions represent; 0 if there is no such sample.
template <std::size_t block, bool obscured, bool stopped, int dimensions, class R>
void areas_block(const PolygonGrid<dimensions, R>& given, const R* film_x, const R* film_y, const R* x, const R* y,
                 const std::int32_t* wavelength, R* area) noexcept {
  const PolygonGrid<dimensions, R> grid = given;
  CellPositions<block, R> positions;
  find_cell_positions(grid, film_x, film_y, x, y, wavelength, positions);
  const auto polygon = [&](std::size_t i) {
    return CellPolygon<dimensions, obscured, R, R>{grid.cells, positions.cell[i] * CellLayout<dimensions>::size,
                                                   positions.t[i], positions.s[i]};
  };
  Point<R> q[block];
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    q[i] = to_grid<dimensions>(positions.cosine[i], positions.sine[i], Point<R>{x[i], y[i]}) - polygon(i).middle();
  }
  std::int32_t sector[block];
  find_sectors<block>(grid, positions, q, sector);
  Lines<block, R> lines;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) lines.from[i] = R(0), lines.to[i] = R(1);
  if constexpr (stopped) {
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const Sector<R> own = polygon(i).sector(sector[i]);
      lines.sector[i] = sector[i];
      lines.along[i] = own.along_to(q[i]);
      const Point<R> edge = own.at(R(1), lines.along[i]);
      lines.edge_x[i] = edge.x, lines.edge_y[i] = edge.y;
    }
    clip_by_iris<block>(grid, positions, lines);
  }
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const Sector<R> own = polygon(i).sector(sector[i]);
    const R behind = turn(own.a, q[i]), before = turn(q[i], own.b), total_area = turn(own.a, own.b);
    const R radius = (behind + before) / (total_area > R(0) ? total_area : R(1)), squared = radius * radius;
    const R from = lines.from[i] * lines.from[i], to = lines.to[i] * lines.to[i];
    const bool inside = (behind >= R(0)) & (before >= R(0)) & (total_area > R(0)) & (squared <= to) & (squared >= from);
    const bool dark = (squared >= own.obscured_from) & (squared < own.obscured_from + own.obscured);
    const R fraction = stopped ? own.fraction_within(to) - own.fraction_within(from) : R(1);
    area[i] = (inside & !dark) ? positions.lit[i] * polygon(i).total_area() * fraction : R(0);
  }
  if constexpr (stopped) {
    using S = StopLayout<dimensions>;
    R samples_iris[block], count = 0;
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i)
      samples_iris[i] = grid.stop.cells[positions.cell[i] * S::size + S::samples_iris];
    for (std::size_t i = 0; i < block; ++i) count += samples_iris[i];
    if (count == R(0)) return;
    Point<R> points[block];
    R iris_area[block];
    find_stop_points<block>(grid, positions, x, y, points, iris_area);
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) {
      const Point<R>& p = points[i];
      const bool in_rim = p.x * p.x + p.y * p.y <= iris_detail::rim_squared<R>;
      iris_area[i] = in_rim ? positions.lit[i] * iris_area[i] : R(0);
    }
    for (std::size_t k = 0; k < grid.stop.iris.count; ++k) {
      PETZVAL_INDEPENDENT
      for (std::size_t i = 0; i < block; ++i) {
        iris_area[i] = iris_detail::within_edge(grid.stop.iris, k, points[i].x, points[i].y) ? iris_area[i] : R(0);
      }
    }
    PETZVAL_INDEPENDENT
    for (std::size_t i = 0; i < block; ++i) area[i] = samples_iris[i] > R(0) ? iris_area[i] : area[i];
  }
}

/// Intersections with the stop, in semi-diameters, of rays through positions in the pupil plane.
template <std::size_t block, int dimensions, class R>
void stop_points_block(const PolygonGrid<dimensions, R>& given, const R* film_x, const R* film_y, const R* x,
                       const R* y, const std::int32_t* wavelength, R* stop_x, R* stop_y) noexcept {
  const PolygonGrid<dimensions, R> grid = given;
  CellPositions<block, R> positions;
  find_cell_positions(grid, film_x, film_y, x, y, wavelength, positions);
  Point<R> points[block];
  R area[block];
  find_stop_points<block>(grid, positions, x, y, points, area);
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const R scale = grid.stop.cells[positions.cell[i] * StopLayout<dimensions>::size + StopLayout<dimensions>::scale];
    stop_x[i] = scale * points[i].x, stop_y[i] = scale * points[i].y;
  }
}

/// Sizes of blocks. All fill the widest registers; the smallest size is for the rest of a batch.
constexpr std::size_t whole_block = 64, half_block = 16, small_block = core_detail::lane_bytes == 64 ? 16 : 8;

template <std::size_t rays>
using Block = std::integral_constant<std::size_t, rays>;

/// Calls body(block, four inputs, wavelength indices or -1, outputs) for blocks of N rays; unused slots hold zeros.
template <std::size_t outputs, class Grid, class R, class Body>
inline void by_blocks(const Grid& grid, std::size_t count, const R* const (&in)[4], const RayWavelengths& wavelengths,
                      R* const (&out)[outputs], const Body& body) noexcept {
  const auto known = [&](std::size_t w) {
    return w < static_cast<std::size_t>(grid.wavelengths) ? static_cast<std::int32_t>(w) : -1;
  };
  std::int32_t w[whole_block];
  const std::int32_t shared = known(wavelengths.all.position(static_cast<std::size_t>(grid.primary)));
  for (std::size_t i = 0; i < whole_block; ++i) w[i] = shared;
  const auto find_wavelengths = [&](std::size_t begin, auto n) {
    if (!wavelengths.each) return;
    const std::uint16_t* const each = wavelengths.each + begin;
    for (std::size_t i = 0; i < n; ++i) w[i] = each[i] < grid.wavelengths ? each[i] : -1;
  };
  std::size_t begin = 0;
  const auto total_area = [&](auto block) {
    for (; begin + block <= count; begin += block) {
      find_wavelengths(begin, block);
      const R* const here[4] = {in[0] + begin, in[1] + begin, in[2] + begin, in[3] + begin};
      R* to[outputs];
      for (std::size_t k = 0; k < outputs; ++k) to[k] = out[k] + begin;
      body(block, here, w, to);
    }
  };
  total_area(Block<whole_block>());
  total_area(Block<half_block>());
  if constexpr (small_block < half_block) total_area(Block<small_block>());
  const std::size_t n = count - begin;
  if (n == 0) return;
  find_wavelengths(begin, n);
  R filled[4][small_block] = {}, found[outputs][small_block];
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < n; ++i) filled[k][i] = in[k][begin + i];
  }
  const R* const padded[4] = {filled[0], filled[1], filled[2], filled[3]};
  R* to[outputs];
  for (std::size_t k = 0; k < outputs; ++k) to[k] = found[k];
  body(Block<small_block>(), padded, w, to);
  for (std::size_t k = 0; k < outputs; ++k) {
    for (std::size_t i = 0; i < n; ++i) out[k][begin + i] = found[k][i];
  }
}

/// Calls body(obscured, stopped) with compile-time constants.
template <int dimensions, class R, class Body>
inline void with_kind(const PolygonGrid<dimensions, R>& grid, const Body& body) noexcept {
  const auto by_stop = [&](auto obscured) {
    if (grid.stop.cells) {
      body(obscured, std::true_type());
    } else {
      body(obscured, std::false_type());
    }
  };
  if (dimensions == 1 && grid.obscured) {
    by_stop(std::bool_constant<dimensions == 1>());
  } else {
    by_stop(std::false_type());
  }
}

template <int dimensions, class R>
void sample(const PolygonGrid<dimensions, R>& grid, std::size_t count, const R* film_x, const R* film_y, const R* u,
            const R* v, const RayWavelengths& wavelengths, R* x, R* y, R* areas) noexcept {
  const R* const in[4] = {film_x, film_y, u, v};
  R* const out[3] = {x, y, areas};
  with_kind(grid, [&](auto obscured, auto stopped) {
    by_blocks(grid, count, in, wavelengths, out,
              [&grid](auto block, const R* const* of, const std::int32_t* w, R* const* to) {
                sample_block<decltype(block)::value, decltype(obscured)::value, decltype(stopped)::value>(
                    grid, of[0], of[1], of[2], of[3], w, to[0], to[1], to[2]);
              });
  });
}

template <int dimensions, class R>
void areas(const PolygonGrid<dimensions, R>& grid, std::size_t count, const R* film_x, const R* film_y, const R* x,
           const R* y, const RayWavelengths& wavelengths, R* found) noexcept {
  const R* const in[4] = {film_x, film_y, x, y};
  R* const out[1] = {found};
  with_kind(grid, [&](auto obscured, auto stopped) {
    by_blocks(grid, count, in, wavelengths, out,
              [&grid](auto block, const R* const* of, const std::int32_t* w, R* const* to) {
                areas_block<decltype(block)::value, decltype(obscured)::value, decltype(stopped)::value>(
                    grid, of[0], of[1], of[2], of[3], w, to[0]);
              });
  });
}

/// Samples one ray.
/// @param wavelength wavelength index, -1 if the table does not cover the wavelength
template <int dimensions, class T>
void sample_one(const PolygonGrid<dimensions, double>& grid, T film_x, T film_y, T u, T v, std::int32_t wavelength,
                T& x, T& y, T& area) noexcept {
  with_kind(grid, [&](auto obscured, auto stopped) {
    sample_block<1, decltype(obscured)::value, decltype(stopped)::value>(grid, &film_x, &film_y, &u, &v, &wavelength,
                                                                         &x, &y, &area);
  });
}

}  // namespace
}  // namespace petzval::pupil_table_detail
