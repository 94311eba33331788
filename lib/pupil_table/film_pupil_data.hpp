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
#include "film_loops.hpp"
#include "iris/iris_shape.hpp"
#include "iris_images.hpp"
#include "lens/between_wavelengths.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "stop_nodes.hpp"

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
  std::vector<double> numbers;  // [wavelength][node] NodeLayout
  std::vector<float> numbers_single, half_widths_single;
  std::shared_ptr<const pupil_table_detail::StopNodes> stop;  // null for a round or unknown stop
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
  /// The polygon at a node as passed to add().
  pupil_table_detail::PupilPolygon node(std::size_t wavelength, std::size_t node) const noexcept;

  /// Rows per mm. 0 for a film smaller than 1e-30 mm, so that the result is finite in float.
  double rows_per_mm() const noexcept {
    constexpr double smallest = 1e-30;
    return height > smallest ? static_cast<double>(rows) / height : 0;
  }
  template <class Chart, class R>
  pupil_table_detail::PupilGrid<Chart, R> grid() const noexcept {
    constexpr bool single = sizeof(R) == sizeof(float);
    const auto of = [](const std::vector<float>& in_float, const std::vector<double>& in_double) {
      if constexpr (single) {
        return in_float.data();
      } else {
        return in_double.data();
      }
    };
    const auto count = [](std::size_t n) { return static_cast<std::int32_t>(n); };
    pupil_table_detail::PupilGrid<Chart, R> result;
    result.chart.rows = count(rows);
    // Includes corner points of the film after rounding.
    result.chart.reach = static_cast<R>(reach * (1 + 1e-6));
    result.chart.rows_per_mm = static_cast<R>(rows_per_mm());
    if constexpr (requires { result.chart.columns; }) {
      result.chart.columns = count(columns);
      result.chart.half_widths = of(half_widths_single, half_widths);
    }
    result.nodes = of(numbers_single, numbers);
    result.wavelengths = count(wavelengths), result.primary = count(primary);
    result.obscured = obscured;
    if (stop) result.stop = stop->borrowed<R>();
    return result;
  }
  /// Calls body(grid) with the grid in R.
  template <class R, class Body>
  auto with_grid(const Body& body) const {
    using namespace pupil_table_detail;
    return dimensions == 1 ? body(grid<FilmRadius<R>, R>()) : body(grid<FilmQuadrant<R>, R>());
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
  /// Calls body(table, begin, count, wavelengths) for batches of the N rays: with the images, or with the grid and
  /// positions of wavelengths.
  template <class R, class Body>
  void with_table(std::size_t count, const RayWavelengths& given, const Body& body) const noexcept {
    if (images) {
      body(images->table<R>(given.all), 0, count, given);
      return;
    }
    with_grid<R>([&](const auto& grid) {
      if (!given.in_nm()) {
        body(grid, 0, count, given);
        return;
      }
      if (!given.each_nm) {
        body(grid, 0, count, RayWavelengths{position(given.all)});
        return;
      }
      constexpr std::size_t block = 256;
      std::array<std::uint16_t, block> positions;
      for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t n = std::min(block, count - begin);
        pupil_table_detail::film_loops().find_nearest(compiled.nearest_position(), n, given.each_nm + begin,
                                                      positions.data());
        body(grid, begin, n, RayWavelengths{.each = positions.data()});
      }
    });
  }
};

}  // namespace petzval
