// SPDX-License-Identifier: Apache-2.0
// Pupils of scene points, interpolated between polygons at the nodes of a grid, for single samples and for blocks.
// Names are local: compiled for several instruction sets, which the linker must not mix.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/widest.hpp"
#include "pupil_table/pupil_grid.hpp"

namespace petzval::pupil_table_detail {

/// Largest coordinate of a scene point, mm: squares of distances must be finite.
inline constexpr double farthest_point = 1e100;

/// Nodes over reciprocal distance and field of scene points, relative to the centre of a table. With two dimensions,
/// the field is one angle, and polygons rotate with the azimuth of the point. With three dimensions, the field is a
/// pair of angles (field times azimuth direction) in the quadrant x, y >= 0, and pupils of the other quadrants are
/// mirror images. Polygons lie in the planes that face their points (PupilPlane::facing).
template <int dimensions>
struct SceneLayout {
  static constexpr std::int32_t angles = dimensions - 1;
  static constexpr std::int32_t distances = 2, fields = dimensions == 2 ? 12 : 6;  ///< cells along each axis
  static constexpr std::int32_t row = fields + 1, layer = dimensions == 2 ? row : row * row;
  static constexpr std::int32_t nodes = (distances + 1) * layer, limits = (distances + 1) * angles;
  static constexpr std::size_t cell_nodes = std::size_t{1} << dimensions;  ///< nodes of a cell
  /// Offset of node j of a cell from the first node of the cell.
  static constexpr std::int32_t offset(std::size_t j) noexcept {
    const auto bit = [j](std::size_t k) { return static_cast<std::int32_t>(j >> k & 1); };
    return dimensions == 2 ? bit(1) * layer + bit(0) : bit(2) * layer + bit(1) * row + bit(0);
  }
};

/// The nodes of all wavelengths, borrowed.
template <int number_of_dimensions>
struct SceneGrid {
  static constexpr int dimensions = number_of_dimensions;
  const double* nodes = nullptr;   ///< [wavelength][SceneLayout::nodes] NodeLayout
  const double* widest = nullptr;  ///< [wavelength][distance][angle] last field, rad; 0 without pupils
  std::int32_t wavelengths = 0;
  double centre_z = 0, steepest = 0;  ///< mm, 1/mm: largest reciprocal distance
  double front_half = 0;              ///< half height of the front surface, mm
  bool obscured = false;              ///< true if at least one sector is partly obscured
};

/// Sampled rays, N of each.
struct EntranceRays {
  double *x, *y, *z;       ///< position in the pupil plane, lens frame, mm
  double *dx, *dy, *dz;    ///< unit, towards the lens
  double *distance, *pdf;  ///< distance from the scene point, mm; density, 1/sr

  EntranceRays from(std::size_t begin) const noexcept {
    return {x + begin, y + begin, z + begin, dx + begin, dy + begin, dz + begin, distance + begin, pdf + begin};
  }
};

/// A direction from the centre of a table: its angle with the axis (-z), rad, and its azimuth.
struct Bearing {
  double field, sine, cosine;  ///< sine, cosine: of the field
  double azimuth_x, azimuth_y;
};

namespace {

/// The cell of a grid that contains a point. distance, down, across: fractions within the cell, in [0, 1]. With two
/// dimensions, `down` is not used.
template <int dimensions>
struct SceneCell {
  std::int32_t first;  ///< first node of the cell, within the wavelength
  double distance, down, across;

  PETZVAL_INLINE double weight(std::size_t j) const noexcept {
    const auto fraction = [j](std::size_t k, double t) { return (j >> k & 1) != 0 ? t : 1 - t; };
    if constexpr (dimensions == 2) {
      return fraction(1, distance) * fraction(0, across);
    } else {
      return fraction(2, distance) * (fraction(1, down) * fraction(0, across));
    }
  }
};
/// @param distance, down, across position as fractions in [0, 1] of the largest reciprocal distance and of the last
///   fields at this distance
template <int dimensions>
PETZVAL_INLINE SceneCell<dimensions> cell_of(double distance, double down, double across) noexcept {
  using L = SceneLayout<dimensions>;
  const auto split = [](double fraction, std::int32_t cells, double& rest) {
    const double position = fraction * static_cast<double>(cells);
    const auto above = static_cast<std::int32_t>(position);
    const std::int32_t i = above < cells - 1 ? above : cells - 1;
    rest = position - static_cast<double>(i);
    return i;
  };
  SceneCell<dimensions> cell{0, 0, 0, 0};
  const std::int32_t i = split(distance, L::distances, cell.distance), k = split(across, L::fields, cell.across);
  const std::int32_t j = dimensions == 2 ? 0 : split(down, L::fields, cell.down);
  cell.first = i * L::layer + j * L::row + k;
  return cell;
}

/// The last field at a fraction of the largest reciprocal distance.
/// @param widest SceneGrid::widest of one wavelength
template <int dimensions>
PETZVAL_INLINE double last_field(const double* widest, double distance, std::int32_t angle) noexcept {
  using L = SceneLayout<dimensions>;
  const double position = distance * static_cast<double>(L::distances);
  const auto above = static_cast<std::int32_t>(position);
  const std::int32_t i = above < L::distances - 1 ? above : L::distances - 1;
  const double near = widest[i * L::angles + angle], far = widest[(i + 1) * L::angles + angle];
  return near + (position - static_cast<double>(i)) * (far - near);
}

PETZVAL_INLINE Bearing bearing_of(double unit_x, double unit_y, double unit_z) noexcept {
  const double across2 = unit_x * unit_x + unit_y * unit_y, sine = std::sqrt(across2);
  constexpr double whole_turn = 6.283185307179586;
  const bool off_axis = across2 > axis_r2<double>;
  const double per_sine = 1 / (off_axis ? sine : 1.0);
  return {whole_turn * turn_of(sine, -unit_z), sine, -unit_z, off_axis ? unit_x * per_sine : 0.0,
          off_axis ? unit_y * per_sine : 1.0};
}
/// The angles of SceneLayout.
template <int dimensions>
PETZVAL_INLINE double angle_of(const Bearing& b, std::int32_t k) noexcept {
  if constexpr (dimensions == 2) {
    return b.field;
  } else {
    const double fraction = k == 0 ? b.azimuth_x : b.azimuth_y;
    return b.field * (fraction < 0 ? -fraction : fraction);
  }
}
/// Rotates a point of the facing plane from the frame of the polygons to the frame of the scene point, and back.
template <int dimensions>
PETZVAL_INLINE Point<double> from_grid(const Bearing& b, const Point<double>& p) noexcept {
  if constexpr (dimensions == 2) {
    return p;
  } else {
    const double x = b.azimuth_x < 0 ? -p.x : p.x, y = b.azimuth_y < 0 ? -p.y : p.y;
    return {b.azimuth_y * x - b.azimuth_x * y, b.azimuth_x * x + b.azimuth_y * y};
  }
}
template <int dimensions>
PETZVAL_INLINE Point<double> to_grid(const Bearing& b, const Point<double>& p) noexcept {
  if constexpr (dimensions == 2) {
    return p;
  } else {
    const double x = b.azimuth_y * p.x + b.azimuth_x * p.y, y = b.azimuth_y * p.y - b.azimuth_x * p.x;
    return {b.azimuth_x < 0 ? -x : x, b.azimuth_y < 0 ? -y : y};
  }
}

/// Scene points in grid coordinates.
template <std::size_t block, int dimensions>
struct SceneCellPositions {
  std::int32_t numbers[block];  ///< index of the numbers of the cell's first node
  double weights[SceneLayout<dimensions>::cell_nodes][block], known[block];  ///< known: 1 or 0
  double distance[block], field[block], sine[block], cosine[block], azimuth_x[block], azimuth_y[block];

  PETZVAL_INLINE Bearing bearing(std::size_t i) const noexcept {
    return {field[i], sine[i], cosine[i], azimuth_x[i], azimuth_y[i]};
  }
};

/// @param wavelength index of the wavelength, or -1 if the table does not cover it
template <std::size_t block, int dimensions>
PETZVAL_INLINE void find_scene_cell_positions(const SceneGrid<dimensions>& grid, const double* x, const double* y,
                                              const double* z, const std::int32_t* wavelength,
                                              SceneCellPositions<block, dimensions>& positions) noexcept {
  using L = SceneLayout<dimensions>;
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    // Comparisons with NaN are false.
    const auto bounded = [](double a) -> std::int32_t { return (a < 0 ? -a : a) <= farthest_point; };
    const std::int32_t sound = bounded(x[i]) & bounded(y[i]) & bounded(z[i]);
    const double px = sound ? x[i] : 0.0, py = sound ? y[i] : 0.0, pz = sound ? z[i] - grid.centre_z : 0.0;
    const double r2 = px * px + py * py, distance = std::sqrt(r2 + pz * pz);
    const double per_distance = 1 / (distance > 0 ? distance : 1.0), fraction = per_distance / grid.steepest;
    const Bearing bearing = bearing_of(px * per_distance, py * per_distance, pz * per_distance);
    // Points outside the front surface's rim may have fields of more than 90 degrees.
    const std::int32_t outside_front = r2 > grid.front_half * grid.front_half, before = pz < 0;
    const std::int32_t far_enough = grid.steepest * distance >= 1, compiled = wavelength[i] >= 0;
    const std::int32_t possible = sound & (outside_front | before) & far_enough & compiled;
    const double* const widest = grid.widest + (possible ? wavelength[i] : 0) * L::limits;
    const double at = possible ? (fraction < 1 ? fraction : 1.0) : 0.0;
    const double last_x = last_field<dimensions>(widest, at, 0),
                 last_y = last_field<dimensions>(widest, at, L::angles - 1);
    const double across = angle_of<dimensions>(bearing, 0) / last_x;
    const double down = angle_of<dimensions>(bearing, L::angles - 1) / last_y;
    const std::int32_t in_columns = across <= 1, in_rows = down <= 1;
    const std::int32_t known = possible & in_columns & in_rows;
    const SceneCell<dimensions> cell = cell_of<dimensions>(at, known ? down : 0.0, known ? across : 0.0);
    positions.numbers[i] = ((known ? wavelength[i] : 0) * L::nodes + cell.first) * NodeLayout::size;
    for (std::size_t j = 0; j < L::cell_nodes; ++j) positions.weights[j][i] = cell.weight(j);
    positions.known[i] = known ? 1.0 : 0.0;
    positions.distance[i] = distance;
    positions.field[i] = bearing.field;
    positions.sine[i] = bearing.sine, positions.cosine[i] = bearing.cosine;
    positions.azimuth_x[i] = bearing.azimuth_x, positions.azimuth_y[i] = bearing.azimuth_y;
  }
}

/// Ray from a scene point through a position in the facing plane, relative to the centre of the table.
struct RayToLens {
  double x, y, z, dx, dy, dz;
  double distance, per_area;  ///< distance to the position, mm; area of the plane per solid angle, mm^2/sr
};
PETZVAL_INLINE RayToLens ray_to_lens(const Bearing& b, double distance, const Point<double>& p) noexcept {
  const double x = b.azimuth_y * p.x + b.azimuth_x * b.cosine * p.y;
  const double y = b.azimuth_y * b.cosine * p.y - b.azimuth_x * p.x, z = b.sine * p.y;
  const double per_distance = 1 / (distance > 0 ? distance : 1.0);
  const double dx = x * per_distance - b.azimuth_x * b.sine, dy = y * per_distance - b.azimuth_y * b.sine;
  const double dz = z * per_distance + b.cosine;
  const double per_length = 1 / std::sqrt(dx * dx + dy * dy + dz * dz);
  const double far2 = distance * distance + (p.x * p.x + p.y * p.y), far = std::sqrt(far2);
  return {x, y, z, dx * per_length, dy * per_length, dz * per_length, far, far2 * (far * per_distance)};
}

/// The polygon of one point.
template <bool obscured, std::size_t block, int dimensions>
struct ScenePolygon {
  const double* nodes;
  const SceneCellPositions<block, dimensions>& positions;
  std::size_t i;

  PETZVAL_INLINE double number(std::int32_t k) const noexcept {
    using L = SceneLayout<dimensions>;
    double sum = 0;
    for (std::size_t j = 0; j < L::cell_nodes; ++j) {
      sum += positions.weights[j][i] * nodes[positions.numbers[i] + (L::offset(j) * NodeLayout::size + k)];
    }
    return sum;
  }
  PETZVAL_INLINE Point<double> middle() const noexcept {
    return {number(NodeLayout::middle), number(NodeLayout::middle + 1)};
  }
  PETZVAL_INLINE Point<double> corner(std::int32_t k) const noexcept {
    return {number(NodeLayout::corners + 2 * k), number(NodeLayout::corners + 2 * k + 1)};
  }
  PETZVAL_INLINE Sector<double> sector(std::int32_t k) const noexcept {
    Sector<double> result{corner(k), corner(k + 1), 0, 0};
    if constexpr (obscured) {
      result.obscured_from = number(NodeLayout::obscured + 2 * k);
      result.obscured = number(NodeLayout::obscured + 2 * k + 1);
    }
    return result;
  }
  /// The ray through a position, given in the frame of the polygons.
  PETZVAL_INLINE RayToLens ray(const Point<double>& position) const noexcept {
    const Bearing bearing = positions.bearing(i);
    return ray_to_lens(bearing, positions.distance[i], from_grid<dimensions>(bearing, position));
  }
  /// Position, in the frame of the polygons, of a point in the plane relative to the centre.
  PETZVAL_INLINE Point<double> position(const std::array<double, 3>& p) const noexcept {
    const Bearing b = positions.bearing(i);
    return to_grid<dimensions>(b, {b.azimuth_y * p[0] - b.azimuth_x * p[1],
                                   b.cosine * (b.azimuth_x * p[0] + b.azimuth_y * p[1]) + b.sine * p[2]});
  }
};

/// Density of samples in a sector, 1/mm^2. All sectors get equal numbers of samples, because their areas are nearly
/// equal; the area of the whole polygon is not needed.
PETZVAL_INLINE double density_in(const Sector<double>& sector) noexcept {
  const double area = sector.area();
  return area > 0 ? 1 / (static_cast<double>(polygon_corners) * area) : 0.0;
}

/// Samples one block of rays; pdf = 0 for points outside the grid.
template <std::size_t block, bool obscured, int dimensions>
PETZVAL_INLINE void sample_scene_block(const SceneGrid<dimensions>& given, const double* x, const double* y,
                                       const double* z, const double* u, const double* v,
                                       const std::int32_t* wavelength, const EntranceRays& rays) noexcept {
  const SceneGrid<dimensions> grid = given;  // a copy that no output can alias
  const auto [ox, oy, oz, dx, dy, dz, distances, pdfs] = rays;
  SceneCellPositions<block, dimensions> positions;
  find_scene_cell_positions(grid, x, y, z, wavelength, positions);
  PETZVAL_INDEPENDENT
  for (std::size_t i = 0; i < block; ++i) {
    const ScenePolygon<obscured, block, dimensions> polygon{grid.nodes, positions, i};
    const double turn = clamped(u[i]) * static_cast<double>(polygon_corners);
    constexpr auto last = static_cast<std::int32_t>(polygon_corners - 1);
    const auto above = static_cast<std::int32_t>(turn);
    const std::int32_t k = above < last ? above : last;
    const Sector<double> sector = polygon.sector(k);
    const double radius = std::sqrt(sector.squared_radius(clamped(v[i])));
    const Point<double> in_grid = polygon.middle() + sector.at(radius, turn - static_cast<double>(k));
    const RayToLens ray = polygon.ray(in_grid);
    // NaN unless u and v are finite: comparisons are then false, and there is no sample.
    const double sound = (u[i] + v[i]) * 0;
    const double density = positions.known[i] * density_in(sector);
    const std::int32_t positive = density > 0, finite = sound >= 0, drawn = positive & finite;
    ox[i] = drawn ? ray.x : 0.0, oy[i] = drawn ? ray.y : 0.0, oz[i] = (drawn ? ray.z : 0.0) + grid.centre_z;
    dx[i] = drawn ? ray.dx : 0.0, dy[i] = drawn ? ray.dy : 0.0, dz[i] = drawn ? ray.dz : 1.0;
    distances[i] = drawn ? ray.distance : 0.0;
    pdfs[i] = drawn ? ray.per_area * density : 0.0;
  }
}

}  // namespace
}  // namespace petzval::pupil_table_detail
