// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/quadrature.hpp"
#include "film_loops.hpp"
#include "film_polygons.hpp"
#include "iris/iris_shape.hpp"
#include "iris_images.hpp"
#include "lens/between_wavelengths.hpp"
#include "pupil_table/film_pupil_table.hpp"

namespace petzval {
namespace pupil_table_detail {

/// Intersection of a ray with the stop, in semi-diameters. The ray runs from a film point through a position in the
/// pupil plane. nullopt if the ray does not reach the stop.
using StopOf =
    std::function<std::optional<Vec2<double>>(const FilmPoint&, const Vec2<double>& position, std::size_t wavelength)>;

/// Traces rays, without clipping by apertures. The stop of the lens must have a semi-diameter.
StopOf traced_stop(const Lens& lens, const TwoPlanes& space);

/// Numbers in both precisions.
using Numbers = std::tuple<std::vector<double>, std::vector<float>>;
inline Numbers in_both(std::vector<double> numbers) {
  std::vector<float> single(numbers.begin(), numbers.end());
  return {std::move(numbers), std::move(single)};
}
template <class R>
const R* numbers_in(const Numbers& numbers) noexcept {
  return std::get<std::vector<R>>(numbers).data();
}

/// The stop behind the pupils of a grid: owns the numbers of GridStop.
struct StopNodes {
  iris_detail::IrisShape shape;
  StopOf stop_of;
  Numbers numbers;  // [wavelength][node] StopLayout

  template <class R>
  GridStop<R> borrowed() const noexcept {
    return {numbers_in<R>(numbers), shape.sectors<R>(), static_cast<R>(shape.area())};
  }
};

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
  std::size_t primary = 0;
  lens_detail::CompiledWavelengths compiled;                    // for wavelengths in nm
  bool enclosing = false;                                       // as in FilmPupilTable::enclosing()
  std::size_t wavelengths = 0;                                  // from here on: the pupils
  std::optional<pupil_table_detail::IrisImages> images{};       // replaces the polygons if set
  pupil_table_detail::FilmGrid points{};                        // whose polygons are stored
  bool obscured = false;                                        // true if at least one polygon is
  pupil_table_detail::Numbers numbers{}, half_widths{};         // [wavelength][node] NodeLayout; FilmGrid::half_widths
  std::shared_ptr<const pupil_table_detail::StopNodes> stop{};  // null for a round or unknown stop
  std::shared_ptr<const Data> unclipped{};                      // the unclipped pupils; null if there is no rim

  /// A table with the same film, planes and wavelengths, but with other pupils.
  FilmPupilTable with(const pupil_table_detail::FilmPolygons& pupils) const { return FilmPupilTable(filled(pupils)); }
  std::shared_ptr<Data> filled(const pupil_table_detail::FilmPolygons& pupils) const;

  /// The same pupils with the stop of an iris.
  FilmPupilTable with_stop(const Iris& iris, const pupil_table_detail::StopOf& stop_of, int threads = 1) const;

  /// True if the polygons are those of a lens of revolution.
  bool of_revolution() const noexcept { return points.columns == 0; }
  /// Distance of the farthest film point of the grid from the axis.
  double reach() const noexcept { return images || !of_revolution() ? film_radius : points.height; }
  std::size_t nodes() const noexcept { return points.nodes().size(); }
  /// The polygon at a node.
  pupil_table_detail::PupilPolygon node(std::size_t wavelength, std::size_t node) const noexcept {
    const double* const first = pupil_table_detail::numbers_in<double>(numbers);
    return pupil_table_detail::PupilPolygon::of(first +
                                                (wavelength * nodes() + node) * pupil_table_detail::NodeLayout::size);
  }

  template <class Chart, class R>
  pupil_table_detail::PupilGrid<Chart, R> grid() const noexcept {
    const auto count = [](std::size_t n) { return static_cast<std::int32_t>(n); };
    pupil_table_detail::PupilGrid<Chart, R> result;
    result.chart.rows = count(points.rows());
    // Includes corner points of the film after rounding.
    result.chart.reach = static_cast<R>(reach() * (1 + 1e-6));
    constexpr double smallest = 1e-30;  // mm; with a smaller film, rows per mm would be infinite in float
    const double height = points.height;
    result.chart.rows_per_mm = height > smallest ? static_cast<R>(static_cast<double>(points.rows()) / height) : R(0);
    if constexpr (requires { result.chart.columns; }) {
      result.chart.columns = count(points.columns);
      result.chart.half_widths = pupil_table_detail::numbers_in<R>(half_widths);
    }
    result.nodes = pupil_table_detail::numbers_in<R>(numbers);
    result.wavelengths = count(wavelengths), result.primary = count(primary);
    result.obscured = obscured;
    if (stop) result.stop = stop->borrowed<R>();
    return result;
  }
  /// Calls body(grid) with the grid in R.
  template <class R, class Body>
  auto with_grid(const Body& body) const {
    using namespace pupil_table_detail;
    return of_revolution() ? body(grid<FilmRadius<R>, R>()) : body(grid<FilmQuadrant<R>, R>());
  }

  /// Index of the pupils for a wavelength; `wavelengths` if the wavelength is not covered.
  std::size_t position(Wavelength at) const noexcept {
    const auto nm = at.in_nm();
    return !nm ? at.index(primary) : compiled.covers(*nm) ? compiled.nearest(*nm) : wavelengths;
  }
  /// The same index for loops; -1 if the wavelength is not covered.
  std::int32_t known(Wavelength at) const noexcept {
    const std::size_t found = position(at);
    return found < wavelengths ? static_cast<std::int32_t>(found) : -1;
  }
  /// Runs a loop over N rays: over the images, or over the grid with positions of wavelengths.
  /// @param loop function; loop(loops) selects one of FilmLoopsOf
  template <class R, std::size_t outputs, class Loop>
  void run(std::size_t count, const std::array<const R*, 4>& lines, const RayWavelengths& given,
           const std::array<R*, outputs>& to, const Loop& loop) const noexcept {
    const pupil_table_detail::FilmLoops& loops = pupil_table_detail::film_loops();
    const auto part = [&](const auto& table, std::size_t begin, std::size_t n, const RayWavelengths& known) {
      const R* const from[] = {lines[0] + begin, lines[1] + begin, lines[2] + begin, lines[3] + begin};
      R* own[outputs];
      for (std::size_t k = 0; k < outputs; ++k) own[k] = to[k] + begin;
      const auto function = loop(loops.of<std::decay_t<decltype(table)>>());
      if (function) function(table, n, from, known, own);
    };
    if (images) {
      part(images->table<R>(given.all), 0, count, given);
      return;
    }
    with_grid<R>([&](const auto& grid) {
      constexpr std::size_t block = 256;
      std::array<std::uint16_t, block> positions;
      for (std::size_t begin = 0; given.each_nm && begin < count; begin += block) {
        const std::size_t n = std::min(block, count - begin);
        loops.find_nearest(compiled.nearest_position(), n, given.each_nm + begin, positions.data());
        part(grid, begin, n, RayWavelengths{.each = positions.data()});
      }
      if (!given.each_nm) part(grid, 0, count, given.in_nm() ? RayWavelengths{position(given.all)} : given);
    });
  }
};

}  // namespace petzval
