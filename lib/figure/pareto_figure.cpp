// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void check(std::span<const ParetoPoint> points) {
  if (points.empty()) throw Error("pareto_figure: points = 0; must be at least 1");
  for (const ParetoPoint& p : points) {
    const std::string where = "pareto_figure: " + std::string(p.name) + ": ";
    if (!(p.ns_per_ray > 0 && p.ns_per_ray < infinity)) {
      throw Error(where + "ns_per_ray = " + to_text(p.ns_per_ray) + "; must be positive and finite");
    }
    for (const double error : {p.max_um, p.rms_um}) {
      if (error >= 0 && error < infinity) continue;
      throw Error(where + "error = " + to_text(error) + " um; must be finite, 0 or more");
    }
  }
}

/// A logarithmic axis for the positive values, widened by a margin in decades.
figure_detail::Axis decades(const std::vector<double>& values, double margin, std::string title) {
  double least = infinity, most = -infinity;
  for (const double value : values) {
    if (value > 0) least = std::min(least, std::log10(value)), most = std::max(most, std::log10(value));
  }
  if (least > most) least = most = 0;
  return {least - margin, most + margin, std::move(title), true};
}

}  // namespace

std::string pareto_figure(std::string_view title, std::string_view remark, std::span<const ParetoPoint> points) {
  check(points);
  constexpr double width = 960, left = 78, top = 70, height = 420;
  constexpr std::string_view colour = "#1f5fc4";
  std::vector<double> times, errors;
  for (const ParetoPoint& p : points) {
    times.push_back(p.ns_per_ray);
    errors.push_back(p.max_um);
    errors.push_back(p.rms_um);
  }
  const figure_detail::Axis across = decades(times, 0.25, "ns per ray, one thread"),
                            up = decades(errors, 0.5, "error on the film (\u00b5m)");
  figure_detail::Svg svg(width, top + height + 92);
  svg.text(figure_detail::sheet_margin, 26, title, "font-size=\"17\" font-weight=\"bold\"");
  svg.text(figure_detail::sheet_margin, 46, std::string("Accuracy and speed.  ") + std::string(remark));
  figure_detail::Axes axes(svg, left, top, width - left - 24, height, across, up);
  const auto y_of = [&](double error) { return axes.y(error > 0 ? std::log10(error) : up.from); };

  std::vector<ParetoPoint> front;
  std::ranges::copy_if(points, std::back_inserter(front), &ParetoPoint::on_front);
  std::ranges::stable_sort(front, {}, &ParetoPoint::ns_per_ray);
  std::vector<figure_detail::Axes::Point> line;
  for (const ParetoPoint& p : front) {
    line.push_back({std::log10(p.ns_per_ray), p.max_um > 0 ? std::log10(p.max_um) : up.from});
  }
  axes.curve(line, "fill=\"none\" stroke=\"#1f5fc4\" stroke-width=\"1.5\" stroke-linejoin=\"round\"");
  for (const ParetoPoint& p : points) {
    const double x = axes.x(std::log10(p.ns_per_ray)), high = y_of(p.max_um), low = y_of(p.rms_um);
    svg.path("M" + figure_detail::svg_number(x) + " " + figure_detail::svg_number(high) + "V" +
                 figure_detail::svg_number(low),
             "stroke=\"#aaa\"");
    svg.circle(x, low, 3, "fill=\"#fff\" stroke=\"#888\"");
    svg.circle(x, high, 5, p.on_front ? "fill=\"#1f5fc4\"" : "fill=\"#fff\" stroke=\"#1f5fc4\" stroke-width=\"1.5\"");
  }
  // Names stand to the right of their points. Names of points that nearly coincide are stacked.
  std::vector<std::pair<double, double>> taken;
  for (const ParetoPoint& p : points) {
    const double x = axes.x(std::log10(p.ns_per_ray)) + 9;
    double y = y_of(p.max_um) - 5;
    const auto hits = [&](const auto& other) {
      return std::abs(other.first - x) < 90 && std::abs(other.second - y) < 12;
    };
    while (std::ranges::any_of(taken, hits)) y += 12;
    taken.push_back({x, y});
    svg.text(x, y, std::string(p.name) + (p.max_um > 0 ? "" : " (0)"), figure_detail::small_text);
  }
  const double y = top + height + 58;
  const double x = figure_detail::draw_key(svg, left, y, colour,
                                           "largest error; filled: no other model is both faster and more accurate");
  figure_detail::draw_key(svg, x + 30, y, "#888", "RMS error");
  svg.text(
      figure_detail::sheet_margin, y + 24,
      "Distance of rays from exact_double rays, scaled to the film by the magnification of the chief ray, over film, "
      "pupil and depths.",
      figure_detail::small_text);
  return std::move(svg).finish();
}

}  // namespace petzval
