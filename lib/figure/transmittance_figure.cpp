// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"

namespace petzval {
namespace {

using figure_detail::Axes;
using figure_detail::Key;

struct Curve {
  Key key;
  std::vector<Axes::Point> points;  ///< transmittance in percent
};

double percent(const std::optional<double>& value) {
  return value ? 100 * *value : std::numeric_limits<double>::quiet_NaN();
}

std::string draw_curves(const Lens& lens, double subject_z, std::string_view title, figure_detail::Axis horizontal,
                        const std::vector<Curve>& curves) {
  constexpr double width = 960, left = 78, right = 24, top = 84, height = 330;
  double lowest = 100;
  std::vector<Key> keys;
  for (const Curve& curve : curves) {
    keys.push_back(curve.key);
    for (const auto& [x, value] : curve.points) {
      if (value < lowest) lowest = value;
    }
  }
  const double from = std::max(0.0, std::min(10 * std::floor(lowest / 10), 90.0));
  const double y = top + height + 58, last_y = y + figure_detail::key_rows(left, width - right, keys);
  figure_detail::Svg svg(width, last_y + 42);
  figure_detail::draw_head(svg, lens, title, subject_z, lens.primary_wavelength());
  Axes axes(svg, left, top, width - left - right, height, std::move(horizontal), {from, 100, "transmittance (%)"});
  for (const Curve& curve : curves) axes.curve(curve.points, figure_detail::curve_style(curve.key.colour));
  figure_detail::draw_keys(svg, left, y, width - right, keys);
  svg.text(figure_detail::sheet_margin, last_y + 24,
           "Unpolarised light, mean over the vignetted pupil, by exact rays; straight lines between the points.",
           figure_detail::small_text);
  return std::move(svg).finish();
}

/// Checks that there are values of all fields and compiled wavelengths.
void check(const char* function, const Lens& lens, std::span<const double> fields_rad,
           const Grid<std::optional<double>>& values) {
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  if (fields_rad.empty() || values.columns != wavelengths || values.size() != fields_rad.size()) {
    throw Error(std::string(function) + ": " + std::to_string(values.values.size()) +
                " values; must be one for each of the " + std::to_string(fields_rad.size()) + " fields and " +
                std::to_string(wavelengths) + " wavelengths");
  }
}

}  // namespace

std::string transmittance_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                 const Grid<std::optional<double>>& values) {
  check("transmittance_figure", lens, fields_rad, values);
  const auto nm = lens.wavelengths_nm();
  if (nm.size() < 2) throw Error("transmittance_figure: one wavelength; must be at least two");
  std::vector<std::size_t> order(nm.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t w) { return nm[w]; });
  std::vector<Curve> curves;
  for (std::size_t f = 0; f < fields_rad.size(); ++f) {
    const bool dark = std::ranges::none_of(values[f], [](const auto& value) { return value.has_value(); });
    Curve curve{
        {figure_detail::field_colour(f), figure_detail::field_text(fields_rad[f]) + (dark ? " (no light)" : "")}, {}};
    for (const std::size_t w : order) curve.points.push_back({nm[w], percent(values[f][w])});
    curves.push_back(std::move(curve));
  }
  return draw_curves(lens, subject_z, "Transmittance", {nm[order.front()], nm[order.back()], "wavelength (nm)"},
                     curves);
}

std::string transmittance_field_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                                       const Grid<std::optional<double>>& values) {
  check("transmittance_field_figure", lens, fields_rad, values);
  if (fields_rad.size() < 2) throw Error("transmittance_field_figure: one field; must be at least two");
  const auto nm = lens.wavelengths_nm();
  const std::vector<figure_detail::Look> looks = figure_detail::looks(nm);
  std::vector<Curve> curves;
  for (std::size_t w = 0; w < nm.size(); ++w) {
    Curve curve{{looks[w].colour, to_text(nm[w], 6) + " nm"}, {}};
    for (std::size_t f = 0; f < fields_rad.size(); ++f) {
      curve.points.push_back({degrees(fields_rad[f]), percent(values[f][w])});
    }
    curves.push_back(std::move(curve));
  }
  return draw_curves(lens, subject_z, "Transmittance over the field",
                     {degrees(fields_rad.front()), degrees(fields_rad.back()), "field angle (\u00b0)"}, curves);
}

}  // namespace petzval
