// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/quadrature.hpp"
#include "film_grid.hpp"
#include "iris/iris_shape.hpp"
#include "iris_images.hpp"
#include "lens/between_wavelengths.hpp"
#include "polygon_loops.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "stop_cells.hpp"

namespace petzval {
namespace pupil_table_detail {

/// The mean of value(u, v) over the unit square of samples.
template <class Value>
double mean_over_samples(int around, const Value& value) {
  static const auto outwards = core_detail::gauss_legendre<4>();
  double sum = 0;
  for (int k = 0; k < around; ++k) {
    for (const auto& [v, weight] : outwards) sum += weight * value((k + 0.5) / around, v);
  }
  return sum / around;
}

/// Projected solid angle of a position in the pupil, per mm^2, divided by the squared depth.
inline double solid_angle_at(const TwoPlanes& space, const FilmPoint& film, double x, double y) noexcept {
  const double dx = x - film.x, dy = y - film.y, length2 = dx * dx + dy * dy + space.depth() * space.depth();
  return 1 / (length2 * length2);
}

/// Coefficients of a value that is bilinear in a cell (CellLayout), from the corner nodes: first row, then second row.
template <int dimensions, class Nodes, class Number>
std::array<double, CellLayout<dimensions>::linear> linear(const Nodes& nodes, const Number& number) {
  const double a = number(*nodes[0]), b = number(*nodes[1]);
  if constexpr (dimensions == 1) {
    return {a, b - a};
  } else {
    const double c = number(*nodes[2]), d = number(*nodes[3]);
    return {a, b - a, c - a, (d - c) - (b - a)};
  }
}

}  // namespace pupil_table_detail

/// The contents of a table: images of an iris, or a grid of polygons with a stop.
struct FilmPupilTable::Data {
  TwoPlanes space;
  double film_radius = 0;
  std::size_t wavelengths = 0, primary = 0;
  lens_detail::CompiledWavelengths compiled;             // for wavelengths in nm
  std::optional<pupil_table_detail::IrisImages> images;  // replaces the polygons if set
  int dimensions = 1;                                    // number of grid dimensions
  double reach = 0;                   // distance of the farthest film point of the grid from the axis
  std::size_t rows = 0, columns = 1;  // of cells
  double height = 0;                  // y of the last row, mm
  std::vector<double> half_widths;    // FilmGrid::half_widths
  bool obscured = false, enclosing = false;
  int corrections = 0;
  std::vector<double> cells;  // CellLayout
  std::vector<float> cells_single, half_widths_single;
  std::shared_ptr<const pupil_table_detail::StopCells> stop;  // null for a round or unknown stop
  std::shared_ptr<const Data> unclipped;                      // the unclipped pupils; null if there is no rim

  /// A table with the same film, planes and wavelengths, but without pupils.
  std::shared_ptr<Data> without_pupils() const;
  /// Sets the grid of a lens with two sections.
  void set(const pupil_table_detail::FilmGrid& grid);
  /// Adds a wavelength with its polygons at the nodes.
  void add(const std::vector<pupil_table_detail::PupilPolygon>& polygons);

  /// The same pupils with the stop of an iris.
  FilmPupilTable with_stop(const Iris& iris, const pupil_table_detail::StopOf& stop_of, int threads = 1) const;

  std::size_t nodes() const noexcept { return (rows + 1) * (dimensions == 1 ? 1 : columns + 1); }
  FilmPoint node_point(std::size_t node) const noexcept;
  /// The polygon at a node as passed to add(), without obscurations.
  pupil_table_detail::PupilPolygon node(std::size_t wavelength, std::size_t node) const noexcept;

  /// Rows per mm. 0 for a film smaller than 1e-30 mm, so that the result is finite in float.
  double rows_per_mm() const noexcept {
    constexpr double smallest = 1e-30;
    return height > smallest ? static_cast<double>(rows) / height : 0;
  }
  template <int dimensions, class R>
  pupil_table_detail::PolygonGrid<dimensions, R> grid() const noexcept {
    pupil_table_detail::PolygonGrid<dimensions, R> result;
    if constexpr (sizeof(R) == sizeof(float)) {
      result.cells = cells_single.data(), result.half_widths = half_widths_single.data();
    } else {
      result.cells = cells.data(), result.half_widths = half_widths.data();
    }
    const auto count = [](std::size_t n) { return static_cast<std::int32_t>(n); };
    result.rows = count(rows), result.columns = count(columns);
    result.wavelengths = count(wavelengths), result.primary = count(primary);
    // Includes corner points of the film after rounding.
    result.reach = static_cast<R>(reach * (1 + 1e-6));
    result.rows_per_mm = static_cast<R>(rows_per_mm());
    result.obscured = obscured;
    result.corrections = corrections;
    if (stop) result.stop = stop->borrowed<R>();
    return result;
  }
  /// Calls body(grid, loops) with the grid in R.
  template <class R, class Body>
  auto with_grid(const Body& body) const {
    return dimensions == 1 ? body(grid<1, R>(), pupil_table_detail::plain_polar_loops)
                           : body(grid<2, R>(), pupil_table_detail::plain_quadrant_loops);
  }

  /// Index of the pupils for a wavelength; `wavelengths` if the wavelength is not covered.
  std::size_t position(Wavelength at) const noexcept {
    const auto nm = at.in_nm();
    return !nm ? at.position(primary) : compiled.covers(*nm) ? compiled.nearest(*nm) : wavelengths;
  }
  /// The same index for loops; -1 if the wavelength is not covered.
  std::int32_t known(Wavelength at) const noexcept {
    const std::size_t found = position(at);
    return found < wavelengths ? static_cast<std::int32_t>(found) : -1;
  }
  /// Calls body(begin, count, positions) for batches of the N rays.
  template <class Body>
  void by_position(std::size_t count, const RayWavelengths& given, const Body& body) const noexcept {
    if (!given.in_nm()) {
      body(0, count, given);
      return;
    }
    if (!given.each_nm) {
      body(0, count, RayWavelengths{position(given.all)});
      return;
    }
    constexpr std::size_t block = 256;
    std::array<std::uint16_t, block> positions;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      pupil_table_detail::polar_loops().find_nearest(compiled.nearest_position(), n, given.each_nm + begin,
                                                     positions.data());
      body(begin, n, RayWavelengths{.each = positions.data()});
    }
  }
};

}  // namespace petzval
