// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "svg.hpp"

namespace petzval::figure_detail {

/// One axis of a diagram: its range, and its title with the unit.
struct Axis {
  double from = 0, to = 1;
  std::string title;
  bool powers_of_ten = false;  ///< values are decimal logarithms; ticks show the numbers
};

/// A diagram: a frame with ticks at round values, and curves cut off at the frame.
class Axes {
 public:
  using Point = std::pair<double, double>;

  /// x, y: of the frame's upper left corner, px. Draws frame, grid, ticks and titles, which take 64 px to the left and
  /// 40 px below.
  Axes(Svg& svg, double x, double y, double width, double height, Axis horizontal, Axis vertical);

  double x(double value) const { return x_ + (value - across_.from) / (across_.to - across_.from) * width_; }
  double y(double value) const { return y_ + height_ - (value - up_.from) / (up_.to - up_.from) * height_; }

  /// A line through points, clipped to the frame. Points that are not finite interrupt it.
  void curve(std::span<const Point> points, std::string_view attributes);

  /// Vertical lines through the whole frame, with names above it: a row of 15 px for each, the leftmost on top, so that
  /// no line runs through a name. Marks outside are left out.
  struct Mark {
    double value = 0;
    std::string_view name, attributes;
  };
  void marks(std::vector<Mark> marks);

 private:
  /// The part of the segment from a to b, 0 to 1, within the frame; empty where from > to.
  struct Part {
    double from = 0, to = 1;
  };
  Part within(const Point& a, const Point& b) const;

  Svg& svg_;
  double x_, y_, width_, height_;
  Axis across_, up_;
};

}  // namespace petzval::figure_detail
