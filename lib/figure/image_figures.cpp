// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/analysis/aberrations.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using figure_detail::Axes;
using figure_detail::curve_style;
using figure_detail::Key;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double width = 960, left = 78, right = 24, top = 84, height = 360;
constexpr std::string_view dashes = "stroke-dasharray=\"5 3\"";

}  // namespace

std::string energy_figure(const Lens& lens, double subject_z, const Grid<EncircledEnergy>& points) {
  if (points.values.empty()) throw Error("energy_figure: there are no points; must be at least one");
  constexpr double top_with_mark = top + 16, most = 0.98, stated = 0.95;
  const double airy = 1000 * airy_radius(lens, lens.primary_wavelength());  // um
  double range = std::isfinite(airy) ? 1.3 * airy : 0, error = 0;
  std::vector<Key> keys;
  std::vector<std::vector<Axes::Point>> curves;
  for (std::size_t field = 0; field < points.size(); ++field) {
    const std::string name = figure_detail::field_text(points[field].front().field_rad);
    keys.push_back({figure_detail::field_colour(field), name});
    curves.push_back({{0, 0}});
    for (const EncircledEnergy& point : points[field]) {
      if (!point.radius_mm) continue;
      curves.back().push_back({1000 * *point.radius_mm, point.fraction});
      if (point.fraction <= most) range = std::max(range, 1050 * *point.radius_mm);
      if (point.fraction <= stated) error = std::max(error, point.sampling_error_mm);
    }
  }
  if (!(range > 0 && std::isfinite(range))) range = 1;
  const double y = top_with_mark + height + 58, last_y = y + figure_detail::key_rows(left, width - right, keys);
  figure_detail::Svg svg(width, last_y + 58);
  figure_detail::draw_head(svg, lens, "Geometric encircled energy", subject_z, lens.primary_wavelength());
  Axes axes(svg, left, top_with_mark, width - left - right, height, {0, range, "radius about the centroid (\u00b5m)"},
            {0, 1, "fraction of the rays"});
  axes.marks({{airy, "Airy radius", "fill=\"none\" stroke=\"#777\" stroke-width=\"0.8\" stroke-dasharray=\"5 3\""}});
  for (std::size_t k = 0; k < curves.size(); ++k) axes.curve(curves[k], curve_style(keys[k].colour));
  figure_detail::draw_keys(svg, left, y, width - right, keys);
  svg.text(
      figure_detail::sheet_margin, last_y + 24,
      "By rays, without diffraction: below the Airy radius diffraction decides. Sampling error of radii up to 95 % "
      "(from quarters of the rays): " +
          figure_detail::length_text(error) + ".",
      figure_detail::small_text);
  return std::move(svg).finish();
}

namespace {

/// Contrast over image height (mm) in a cell for each f-number, or over the field without f-numbers.
std::string draw_over_field(const Lens& lens, double subject_z, std::string_view kind, std::span<const MtfChart> charts,
                            const std::string& note) {
  const Grid<MtfPoint>& first = charts.front().second;
  std::vector<Key> keys;
  for (const MtfPoint& point : first[0]) {
    keys.push_back(
        {figure_detail::field_colour(keys.size()), to_text(point.frequency_per_mm, 4) + " line pairs per mm"});
  }
  const double y = top + height + 58, last_y = y + figure_detail::key_rows(left, width - right, keys);
  figure_detail::Svg svg(width, last_y + 58);
  figure_detail::draw_head(svg, lens, kind, subject_z, lens.primary_wavelength());
  const double step = (width - left - right + 92) / static_cast<double>(charts.size());
  for (std::size_t cell = 0; cell < charts.size(); ++cell) {
    const auto& [f_number, points] = charts[cell];
    const auto position = [in_mm = f_number > 0](const MtfPoint& point) {
      return in_mm ? point.image_height_mm : degrees(point.field_rad);
    };
    double from = 0, to = 0;
    for (const MtfPoint& point : points.values)
      from = std::min(from, position(point)), to = std::max(to, position(point));
    Axes axes(svg, left + step * static_cast<double>(cell), top, step - 92, height,
              {from, to, f_number > 0 ? "image height at f/" + to_text(f_number, 3) + " (mm)" : "field angle (\u00b0)"},
              {0, 1, "contrast"});
    for (std::size_t k = 0; k < keys.size(); ++k) {
      std::vector<Axes::Point> tangential, sagittal;
      for (std::size_t field = 0; field < points.size(); ++field) {
        const MtfPoint& point = points[field][k];
        const bool dark = point.tangential == 0 && point.sagittal == 0;
        tangential.push_back({position(point), dark ? nothing : point.tangential});
        sagittal.push_back({position(point), dark ? nothing : point.sagittal});
      }
      axes.curve(tangential, curve_style(keys[k].colour));
      axes.curve(sagittal, curve_style(keys[k].colour, dashes));
    }
  }
  figure_detail::draw_keys(svg, left, y, width - right, keys);
  svg.text(figure_detail::sheet_margin, last_y + 24,
           "Solid: tangential, dashed: sagittal, straight lines between " + std::to_string(first.size()) + " fields. " +
               note,
           figure_detail::small_text);
  return std::move(svg).finish();
}

}  // namespace

std::string mtf_chart_figure(const Lens& lens, double subject_z, std::span<const MtfChart> charts,
                             std::span<const double> wavelength_weights) {
  if (charts.empty()) throw Error("mtf_chart_figure: there are no charts; must be at least one");
  std::vector<MtfPoint> all;
  for (const auto& [f_number, points] : charts) {
    if (points.size() < 2) {
      throw Error("mtf_chart_figure: " + std::to_string(points.size()) + " heights; must be two or more");
    }
    all.insert(all.end(), points.values.begin(), points.values.end());
  }
  return draw_over_field(lens, subject_z, "MTF chart", charts,
                         "With diffraction, " + std::to_string(lens.wavelengths_nm().size()) + " wavelengths with " +
                             figure_detail::weights_text(wavelength_weights) + ", error at most " +
                             figure_detail::error_text(all) + ".");
}

std::string mtf_focus_figure(const Lens& lens, double subject_z, std::span<const double> film_shifts_mm,
                             const Grid<MtfPoint>& points) {
  if (film_shifts_mm.size() < 2 || points.columns != film_shifts_mm.size() || points.values.empty()) {
    throw Error("mtf_focus_figure: " + std::to_string(film_shifts_mm.size()) + " shifts for " +
                std::to_string(points.columns) + " points; must be two or more, and as many");
  }
  std::vector<Key> keys;
  for (std::size_t field = 0; field < points.size(); ++field) {
    keys.push_back({figure_detail::field_colour(field), figure_detail::field_text(points[field].front().field_rad)});
  }
  const double y = top + height + 58, last_y = y + figure_detail::key_rows(left, width - right, keys);
  figure_detail::Svg svg(width, last_y + 58);
  figure_detail::draw_head(svg, lens, "MTF through focus", subject_z, lens.primary_wavelength());
  Axes axes(svg, left, top, width - left - right, height,
            {film_shifts_mm.front(), film_shifts_mm.back(), "shift of the film, positive away from the lens (mm)"},
            {0, 1, "contrast at " + to_text(points.values[0].frequency_per_mm, 4) + " line pairs per mm"});
  for (std::size_t field = 0; field < points.size(); ++field) {
    std::vector<Axes::Point> tangential, sagittal;
    for (std::size_t k = 0; k < film_shifts_mm.size(); ++k) {
      tangential.push_back({film_shifts_mm[k], points[field][k].tangential});
      sagittal.push_back({film_shifts_mm[k], points[field][k].sagittal});
    }
    axes.curve(tangential, curve_style(keys[field].colour));
    axes.curve(sagittal, curve_style(keys[field].colour, dashes));
  }
  figure_detail::draw_keys(svg, left, y, width - right, keys);
  svg.text(figure_detail::sheet_margin, last_y + 24,
           "Solid: tangential, dashed: sagittal. With diffraction, error at most " +
               figure_detail::error_text(points.values) + ".",
           figure_detail::small_text);
  return std::move(svg).finish();
}

std::string mtf_field_figure(const Lens& lens, double subject_z, const Grid<MtfPoint>& points) {
  if (points.size() < 2) {
    throw Error("mtf_field_figure: " + std::to_string(points.size()) + " fields; must be two or more");
  }
  const MtfChart chart(0, points);
  return draw_over_field(lens, subject_z, "Geometric MTF over the field", {&chart, 1},
                         "Rays only, without diffraction. " + figure_detail::sampling_error_text(points.values) + ".");
}

std::string colour_figure(const Lens& lens, double subject_z, double field_rad) {
  if (!(field_rad >= 0)) {
    throw Error("colour_figure: field = " + to_text(degrees(field_rad), 6) + " degrees; must be 0 or more");
  }
  constexpr int steps = 20;
  const std::size_t wavelengths = lens.wavelengths_nm().size(), primary = lens.primary_wavelength();
  const bool lateral = wavelengths > 1 && field_rad > 0, cylinders = !lens.rotationally_symmetric();
  const double cell = lateral ? 380 : width - left - right, second = left + cell + 92;
  const auto looks = figure_detail::looks(lens.wavelengths_nm());
  std::vector<Key> keys;
  for (std::size_t w = 0; w < wavelengths; ++w) {
    keys.push_back({looks[w].colour, to_text(lens.wavelengths_nm()[w], 6) + " nm"});
  }
  std::vector<std::vector<Axes::Point>> tangential(wavelengths), sagittal(wavelengths), shifts(wavelengths);
  double focus_range = 0, shift_range = 0;
  for (const AxialRayFocus& focus : longitudinal_aberration(lens, subject_z).values) {
    const auto take = [&](std::vector<Axes::Point>& curve, const std::optional<double>& value) {
      curve.push_back({value.value_or(nothing), focus.pupil});
      focus_range = std::max(focus_range, std::abs(value.value_or(0)));
    };
    take(tangential[focus.wavelength], focus.tangential_mm);
    if (cylinders) take(sagittal[focus.wavelength], focus.sagittal_mm);
  }
  if (lateral) {
    std::vector<double> fields;
    for (int k = 0; k <= steps; ++k) fields.push_back(field_rad * k / steps);
    const auto colour = chromatic_aberration(lens, subject_z, fields).lateral;
    for (std::size_t w = 0; w < wavelengths; ++w) {
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const double um = 1000 * colour[k][w].value_or(nothing);
        shifts[w].push_back({um, degrees(fields[k])});
        if (std::isfinite(um)) shift_range = std::max(shift_range, std::abs(um));
      }
    }
  }

  const double y = top + height + 58, last_y = y + figure_detail::key_rows(left, width - right, keys);
  figure_detail::Svg svg(width, last_y + 58);
  figure_detail::draw_head(svg, lens,
                           lateral ? "Longitudinal aberration and lateral colour" : "Longitudinal aberration",
                           subject_z, primary);
  const double range = figure_detail::round_range(focus_range, 1e-3);
  Axes longitudinal(svg, left, top, cell, height, {-range, range, "crossing of the axis, from the film (mm)"},
                    {0, 1, "height on the stop"});
  for (std::size_t w = 0; w < wavelengths; ++w) {
    longitudinal.curve(tangential[w], curve_style(looks[w].colour));
    longitudinal.curve(sagittal[w], curve_style(looks[w].colour, dashes));
  }
  if (lateral) {
    const double um = figure_detail::round_range(shift_range, 1e-2);
    Axes across(svg, second, top, cell, height, {-um, um, "lateral colour (\u00b5m)"},
                {0, degrees(field_rad), "field angle (\u00b0)"});
    for (std::size_t w = 0; w < wavelengths; ++w) across.curve(shifts[w], curve_style(looks[w].colour));
  }
  figure_detail::draw_keys(svg, left, y, width - right, keys);
  svg.text(figure_detail::sheet_margin, last_y + 24,
           std::string(lateral ? "Left: rays" : "Rays") + " of the axial point" +
               (cylinders ? ", solid in y-z and dashed in x-z" : "") + "." +
               (lateral ? " Right: chief rays on the film relative to " + to_text(lens.wavelengths_nm()[primary], 6) +
                              " nm, towards +y."
                        : std::string()) +
               " Single exact rays: no sampling error.",
           figure_detail::small_text);
  return std::move(svg).finish();
}

}  // namespace petzval
