// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
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
  bool powers_of_ten = false;  ///< true: values are decimal logarithms; ticks show the numbers
  double ticks_to = std::numeric_limits<double>::infinity();  ///< larger values have no ticks
};

/// A diagram: a frame with ticks at round values, and curves clipped to the frame.
class Axes {
 public:
  using Point = std::pair<double, double>;

  /// Draws a frame with its upper left corner at (x, y), px, with grid, ticks and titles. Labels need 64 px to the left
  /// of the frame and 40 px below.
  Axes(Svg& svg, double x, double y, double width, double height, Axis horizontal, Axis vertical);

  double x(double value) const { return x_ + (value - across_.from) / (across_.to - across_.from) * width_; }
  double y(double value) const { return y_ + height_ - (value - up_.from) / (up_.to - up_.from) * height_; }

  /// Draws a polyline, clipped to the frame and interrupted at points that are not finite.
  void curve(std::span<const Point> points, std::string_view attributes);

  /// Vertical lines through the frame with names above it, each in a row of its own (15 px). The name of the leftmost
  /// line is at the top, so that no line crosses a name. Marks outside the frame are left out.
  struct Mark {
    double value = 0;
    std::string_view name, attributes;
  };
  void marks(std::vector<Mark> marks);

 private:
  /// The part of a segment that lies inside the frame, as fractions of its length; empty if from > to.
  struct Visible {
    double from = 0, to = 1;
  };
  Visible within(const Point& a, const Point& b) const;

  Svg& svg_;
  double x_, y_, width_, height_;
  Axis across_, up_;
};

}  // namespace petzval::figure_detail
