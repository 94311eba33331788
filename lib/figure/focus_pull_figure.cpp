// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {
namespace {

using Frames = std::span<const FocusPullFrame>;

/// A curve over time: its value in a frame, colour and name.
struct Curve {
  std::function<double(const FocusPullFrame&)> value;
  std::string_view colour, name;
};

struct Diagram {
  std::string title;
  std::vector<Curve> curves;
  bool from_zero = false;
};

void check(Frames frames) {
  if (frames.empty()) throw Error("focus_pull_figure: frames = 0; must be at least 1");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FocusPullFrame& f = frames[i];
    const std::string where = "focus_pull_figure: frame " + std::to_string(i) + ": ";
    if (!std::isfinite(f.time + f.film.z() + f.film.tilt_rad + f.film.swing_rad)) {
      throw Error(where + "time, film or tilt is not a number; must be finite");
    }
    if (!(f.subject_distance > 0)) {
      throw Error(where + "subject_distance = " + to_text(f.subject_distance) + " mm; must be positive");
    }
    if (std::isinf(f.rms_mm)) throw Error(where + "rms_mm is infinite; must be finite or NaN");
    if (i > 0 && !(f.time > frames[i - 1].time)) {
      throw Error(where + "time = " + to_text(f.time) + " s; must be later than the previous frame");
    }
  }
}

/// The axis for all values of a diagram, with a margin; an empty range is widened.
figure_detail::Axis spanning(Frames frames, const Diagram& diagram) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& curve : diagram.curves) {
    for (const FocusPullFrame& f : frames) {
      const double value = curve.value(f);
      if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    }
  }
  if (low > high) low = 0, high = 1;
  if (diagram.from_zero) low = std::min(low, 0.0);
  double margin = 0.06 * (high - low);
  if (!(margin > 1e-9 * std::max(std::abs(low), std::abs(high)))) margin = std::max(0.5, 1e-3 * std::abs(high));
  return {diagram.from_zero && low == 0 ? 0 : low - margin, high + margin, diagram.title};
}

}  // namespace

std::string focus_pull_figure(std::string_view title, std::string_view remark, Frames frames,
                              std::span<const double> key_times, std::string_view distance_from) {
  check(frames);
  std::vector<Diagram> diagrams{
      {"in focus (1/m)", {{[](const auto& f) { return 1e3 / f.subject_distance; }, "#1a8f3c", {}}}, true},
      {"film at z (mm)", {{[](const auto& f) { return f.film.z(); }, "#1f5fc4", {}}}},
      {"RMS blur (\u00b5m)", {{[](const auto& f) { return 1e3 * f.rms_mm; }, "#d0331f", {}}}, true}};
  if (std::ranges::any_of(frames, [](const auto& f) { return f.film.tilted(); })) {
    diagrams.push_back({"tilt, swing (\u00b0)",
                        {{[](const auto& f) { return degrees(f.film.tilt_rad); }, "#7b3fb5", "tilt"},
                         {[](const auto& f) { return degrees(f.film.swing_rad); }, "#b97a00", "swing"}}});
  }
  constexpr double width = 960, left = 78, top = 76, height = 170, gap = 56;
  const double foot = top + (height + gap) * static_cast<double>(diagrams.size());
  figure_detail::Svg svg(width, foot + 36);
  svg.text(figure_detail::sheet_margin, 26, title, "font-size=\"17\" font-weight=\"bold\"");
  svg.text(figure_detail::sheet_margin, 46, std::string("Focus pull.  ") + std::string(remark));
  double from = frames.front().time, to = frames.back().time;
  if (!(to > from)) from -= 0.5, to += 0.5;

  double y = top;
  for (const Diagram& diagram : diagrams) {
    const figure_detail::Axis up = spanning(frames, diagram);
    figure_detail::Axes axes(svg, left, y, width - left - 24, height, {from, to, "time (s)"}, up);
    for (const double key : key_times) {
      const std::vector<figure_detail::Axes::Point> line{{key, up.from}, {key, up.to}};
      axes.curve(line, "fill=\"none\" stroke=\"#999\" stroke-dasharray=\"2 3\"");
    }
    double key_x = left + 10;
    for (const Curve& curve : diagram.curves) {
      // The complete curve is drawn in grey, and the parts with focus points are drawn over it.
      std::vector<figure_detail::Axes::Point> all, served;
      for (const FocusPullFrame& f : frames) {
        const double value = curve.value(f);
        all.push_back({f.time, value});
        served.push_back({f.time, std::isnan(f.rms_mm) ? std::nan("") : value});
      }
      axes.curve(all, "fill=\"none\" stroke=\"#aaa\" stroke-width=\"2\"");
      axes.curve(served, "fill=\"none\" stroke-linejoin=\"round\" stroke=\"" + std::string(curve.colour) +
                             "\" stroke-width=\"2\"");
      if (!curve.name.empty()) key_x = 12 + figure_detail::draw_key(svg, key_x, y + 14, curve.colour, curve.name);
    }
    y += height + gap;
  }
  svg.text(figure_detail::sheet_margin, foot + 4,
           "In focus: on the axis, from the " + std::string(distance_from) +
               ", as 1/distance; 0 is infinity. Dotted: keys. Grey: no focus points, the film does not move.",
           figure_detail::small_text);
  return std::move(svg).finish();
}

}  // namespace petzval
