// SPDX-License-Identifier: Apache-2.0
#include "film_grid.hpp"

#include <cmath>

namespace petzval::pupil_table_detail {
namespace {

constexpr std::size_t grid_steps = 8;  // steps between the nodes of an axis

/// Lengths of lines up to the last film point that rays reach, at most `lengths`; 0 for a dark line.
/// @param point function; point(line, length) is the film point at the end of a line of this length
template <class PointAt>
std::vector<double> lit_lengths(const LitPoints& lit, const std::vector<double>& lengths, const PointAt& point) {
  // Marks of one line: dark ends, then steps from the end inwards. For a lit ring, the outer edge counts.
  constexpr int steps = 16;
  std::vector<double> low(lengths.size(), 0), high = lengths;
  std::vector<std::size_t> open;
  const auto test = [&](const auto& length) {
    std::vector<FilmPoint> points;
    for (const std::size_t line : open) points.push_back(point(line, length(line)));
    return lit(points);
  };
  for (std::size_t line = 0; line < lengths.size(); ++line) open.push_back(line);
  std::vector<std::size_t> dark;
  const auto bright_ends = test([&](std::size_t line) { return high[line]; });
  for (const std::size_t line : open) {
    if (!bright_ends[line]) dark.push_back(line);
  }
  std::vector<std::size_t> edges;
  for (int i = steps - 1; i >= 0; --i) {
    open = dark;
    dark.clear();
    if (open.empty()) break;
    const auto length = [&](std::size_t line) { return lengths[line] * i / steps; };
    const auto bright = test(length);
    for (std::size_t j = 0; j < open.size(); ++j) {
      (bright[j] ? low : high)[open[j]] = length(open[j]);
      (bright[j] ? edges : dark).push_back(open[j]);
    }
  }
  for (open = edges; !open.empty();) {
    const auto middle = [&](std::size_t line) { return (low[line] + high[line]) / 2; };
    const auto bright = test(middle);
    for (std::size_t j = 0; j < open.size(); ++j) (bright[j] ? low : high)[open[j]] = middle(open[j]);
    constexpr double relative_tolerance = 1e-4;
    std::erase_if(open, [&](std::size_t line) { return high[line] - low[line] <= relative_tolerance * high[line]; });
  }
  return high;
}

}  // namespace

FilmPoint FilmGrid::point(const ChartPoint& at) const noexcept {
  const double row = at[1] * static_cast<double>(rows());
  const auto i = std::min(static_cast<std::size_t>(row), rows() - 1);
  const double s = row - static_cast<double>(i);
  return {((1 - s) * half_widths[i] + s * half_widths[i + 1]) * at[2], height * at[1]};
}

FilmGrid radial_grid(const LitPoints& lit, double film_radius, std::size_t strips) {
  const auto on_y = [](std::size_t, double y) { return FilmPoint{0, y}; };
  const double reach = lit_lengths(lit, {film_radius}, on_y)[0];
  return {0, reach > 0 ? reach : film_radius, std::vector<double>(strips + 1, 0)};
}

FilmGrid quadrant_grid(const LitPoints& lit, double film_radius) {
  FilmGrid grid = radial_grid(lit, film_radius, grid_steps);
  grid.columns = grid_steps;
  // Half widths of the lit area, at half steps of the rows.
  constexpr std::size_t half_steps = 2 * grid_steps;
  const auto y_of = [&](std::size_t i) { return grid.height * static_cast<double>(i) / half_steps; };
  std::vector<double> widths;
  for (std::size_t i = 0; i <= half_steps; ++i) {
    widths.push_back(std::sqrt(std::max(film_radius * film_radius - y_of(i) * y_of(i), 0.0)));
  }
  widths = lit_lengths(lit, widths, [&](std::size_t i, double x) { return FilmPoint{x, y_of(i)}; });
  // Straight lines between the rows enclose the area, which is convex.
  for (std::size_t i = 0; i <= grid_steps; ++i) grid.half_widths[i] = widths[2 * i];
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < grid.rows(); ++i) {
      double &before = grid.half_widths[i], &after = grid.half_widths[i + 1];
      // A chord over half of an arc has a quarter of the sagitta of the whole arc.
      const double chord = (before + after) / 2, overshoot = 1.35 * std::max(widths[2 * i + 1] - chord, 0.0);
      before += overshoot, after += overshoot;
    }
  }
  return grid;
}

}  // namespace petzval::pupil_table_detail
