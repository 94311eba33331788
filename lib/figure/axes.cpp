// SPDX-License-Identifier: Apache-2.0
#include "axes.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "figure_elements.hpp"

namespace petzval::figure_detail {
namespace {

/// Calls draw(value, label) for round values within an axis.
template <class Draw>
void for_ticks(const Axis& axis, int most, Draw draw) {
  const double span = axis.to - axis.from;
  if (axis.powers_of_ten) {
    for (double k = std::floor(axis.from); k <= axis.to; ++k) {
      for (const double digit : {1, 2, 5}) {
        const double value = k + std::log10(digit);
        if (digit != 1 && 3 * span > most) continue;
        if (value >= axis.from && value <= axis.to) draw(value, to_text(digit * std::pow(10, k), 6));
      }
    }
    return;
  }
  double step = round_length(span / most);
  while (span / step > most) step = round_length(2.5 * step);
  const double last = std::min(axis.to, axis.ticks_to);
  for (double k = std::ceil(axis.from / step - 1e-9); k * step <= last + 1e-9 * step; ++k) {
    draw(k * step, to_text(k == 0 ? 0.0 : k * step, 6));  // no "-0"
  }
}

}  // namespace

Axes::Axes(Svg& svg, double x, double y, double width, double height, Axis horizontal, Axis vertical)
    : svg_(svg),
      x_(x),
      y_(y),
      width_(width),
      height_(height),
      across_(std::move(horizontal)),
      up_(std::move(vertical)) {
  std::string grid;
  for_ticks(across_, 10, [&](double value, const std::string& words) {
    grid += "M" + svg_number(this->x(value)) + " " + svg_number(y_) + "v" + svg_number(height_);
    svg_.text(this->x(value), y_ + height_ + 16, words, small_centred);
  });
  for_ticks(up_, 8, [&](double value, const std::string& words) {
    grid += "M" + svg_number(x_) + " " + svg_number(this->y(value)) + "h" + svg_number(width_);
    svg_.text(x_ - 6, this->y(value) + 4, words, "font-size=\"11\" fill=\"#555\" text-anchor=\"end\"");
  });
  svg_.path(grid, "fill=\"none\" stroke=\"#e6e6e6\"");
  svg_.rect(x_, y_, width_, height_, "fill=\"none\" stroke=\"#777\"");
  svg_.text(x_ + width_ / 2, y_ + height_ + 34, across_.title, "text-anchor=\"middle\"");
  const double middle = y_ + height_ / 2;
  svg_.text(x_ - 48, middle, up_.title,
            "text-anchor=\"middle\" transform=\"rotate(-90 " + svg_number(x_ - 48) + " " + svg_number(middle) + ")\"");
}

/// Clips by the algorithm of Liang and Barsky: each border of the frame shortens the range 0 to 1.
Axes::Visible Axes::within(const Point& a, const Point& b) const {
  Visible visible;
  const auto keep = [&visible](double start, double change, const Axis& axis) {
    if (change == 0) {
      if (!(start >= axis.from && start <= axis.to)) visible.to = -1;
      return;
    }
    const double t1 = (axis.from - start) / change, t2 = (axis.to - start) / change;
    visible.from = std::max(visible.from, std::min(t1, t2));
    visible.to = std::min(visible.to, std::max(t1, t2));
  };
  if (!std::isfinite(a.first + a.second + b.first + b.second)) return {0, -1};
  keep(a.first, b.first - a.first, across_);
  keep(a.second, b.second - a.second, up_);
  return visible;
}

void Axes::curve(std::span<const Point> points, std::string_view attributes) {
  std::string d;
  bool drawing = false;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Visible visible = within(points[i], points[i + 1]);
    if (!(visible.from <= visible.to)) {
      drawing = false;
      continue;
    }
    const auto at = [&](double t) {
      const auto& [ax, ay] = points[i];
      const auto& [bx, by] = points[i + 1];
      return svg_number(x(ax + t * (bx - ax))) + " " + svg_number(y(ay + t * (by - ay)));
    };
    if (!drawing || visible.from > 0) d += "M" + at(visible.from);
    d += "L" + at(visible.to);
    drawing = visible.to == 1;
  }
  if (!d.empty()) svg_.path(d, attributes);
}

void Axes::marks(std::vector<Mark> marks) {
  std::erase_if(marks, [&](const Mark& m) { return !(m.value >= across_.from && m.value <= across_.to); });
  std::ranges::stable_sort(marks, {}, &Mark::value);
  double top = y_ - 8 - 15 * static_cast<double>(marks.size());
  for (const Mark& m : marks) {
    top += 15;
    const double at = x(m.value);
    svg_.path("M" + svg_number(at) + " " + svg_number(top - 8) + "V" + svg_number(y_ + height_), m.attributes);
    svg_.text(at + 5, top, m.name, small_text);
  }
}

}  // namespace petzval::figure_detail
