// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "axes.hpp"
#include "section.hpp"
#include "svg.hpp"

namespace petzval::figure_detail {

/// Of the film's exposed part, of what is in focus, and of the axis.
inline constexpr std::string_view film_style = "fill=\"none\" stroke=\"#111\" stroke-width=\"2.6\"";
inline constexpr std::string_view focus_style = "fill=\"none\" stroke=\"#1a8f3c\" stroke-width=\"2\"";
inline constexpr std::string_view axis_style =
    "fill=\"none\" stroke=\"#888\" stroke-width=\"0.8\" stroke-dasharray=\"14 3 2 3\"";

/// The part of a section that a panel shows, mm.
struct SectionBox {
  double z_min = 0, z_max = 0, low = 0, high = 0;

  explicit SectionBox(const SectionPoint& p) : z_min(p.z), z_max(p.z), low(p.height), high(p.height) {}
  void take(const SectionPoint& p) {
    z_min = std::min(z_min, p.z), z_max = std::max(z_max, p.z);
    low = std::min(low, p.height), high = std::max(high, p.height);
  }
  bool holds(const SectionPoint& p) const {
    return p.z >= z_min && p.z <= z_max && p.height >= low && p.height <= high;
  }
  double length() const { return z_max - z_min; }
  double tall() const { return high - low; }
};

/// A line of a section: along z + across height = offset.
struct SectionTrace {
  double along = 0, across = 0, offset = 0;
  /// Above 0 on the side where the normal points.
  double side(const SectionPoint& p) const { return along * p.z + across * p.height - offset; }
};

/// The part of a convex outline on the side of a line to which its normal points.
SectionLine cut_off(const SectionLine& outline, const SectionTrace& line);

/// The layout of a diagram with the same scale on both axes: the box, enlarged to the shape of its frame.
struct SceneFrame {
  static constexpr double left = 78, width = 858;  ///< px

  /// As large as the width and the tallest height (px) allow, at least `lowest` high, with a margin about the box.
  SceneFrame(SectionBox content, double lowest, double tallest);

  SectionBox box;
  double height = 0, px_per_mm = 1;
};

/// A part of a section, to scale, with ticks in mm or m. What is drawn ends at the frame.
class ScenePanel {
 public:
  /// y: top of the frame, px. across: name of the vertical axis, "y".
  ScenePanel(Svg& svg, double y, const SceneFrame& frame, const std::string& across);

  double x(const SectionPoint& p) const { return axes_.x(unit_ * p.z); }
  double y(const SectionPoint& p) const { return axes_.y(unit_ * p.height); }
  const SectionBox& box() const { return frame_.box; }

  void stroke(const SectionPoint& a, const SectionPoint& b, std::string_view attributes);
  /// A line across the whole frame.
  void line(const SectionTrace& line, std::string_view attributes);
  /// A convex outline within the frame, or any that does not leave it.
  void fill(const SectionLine& outline, std::string_view attributes);
  /// The intersection of lines with its name; `lower`: px from its usual baseline.
  void dot(const SectionPoint& p, std::string_view name, double lower_px);
  /// A point of the scene or its image with its number; hollow where it was not used.
  void mark(const SectionPoint& p, std::size_t number, bool used, double radius);
  /// Text beside a point, within the frame.
  void words(const SectionPoint& p, std::string_view words, double lower_px);

 private:
  Svg& svg_;
  SceneFrame frame_;
  double unit_;
  Axes axes_;
};

}  // namespace petzval::figure_detail
