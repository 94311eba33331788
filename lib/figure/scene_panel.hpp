// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "axes.hpp"
#include "lens_section.hpp"
#include "svg.hpp"

namespace petzval::figure_detail {

/// Line styles of the exposed part of the film, the plane or surface of focus, and the axis.
inline constexpr std::string_view film_style = "fill=\"none\" stroke=\"#111\" stroke-width=\"2.6\"";
inline constexpr std::string_view focus_style = "fill=\"none\" stroke=\"#1a8f3c\" stroke-width=\"2\"";
inline constexpr std::string_view axis_style =
    "fill=\"none\" stroke=\"#888\" stroke-width=\"0.8\" stroke-dasharray=\"14 3 2 3\"";

/// Bounds of a panel in a section, mm.
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
  /// Positive on the side of the normal.
  double side(const SectionPoint& p) const { return along * p.z + across * p.height - offset; }
};

/// Clips a convex outline to the side of a line to which the normal points.
SectionLine cut_off(const SectionLine& outline, const SectionTrace& line);

/// The layout of a diagram with equal scales: the box, enlarged to the shape of its frame.
struct SceneFrame {
  static constexpr double left = 78, width = 858;  ///< px

  /// @param content  the box to show; a margin is added
  /// @param lowest   smallest height of the frame, px
  /// @param tallest  largest height of the frame, px
  SceneFrame(SectionBox content, double lowest, double tallest);

  SectionBox box;
  double height = 0, px_per_mm = 1;
};

/// A scaled drawing of a section with ticks in mm or m, clipped to its frame.
class ScenePanel {
 public:
  /// @param y       top of the frame, px
  /// @param across  name of the vertical axis, for example "y"
  ScenePanel(Svg& svg, double y, const SceneFrame& frame, const std::string& across);

  double x(const SectionPoint& p) const { return axes_.x(unit_ * p.z); }
  double y(const SectionPoint& p) const { return axes_.y(unit_ * p.height); }
  const SectionBox& box() const { return frame_.box; }

  void stroke(const SectionPoint& a, const SectionPoint& b, std::string_view attributes);
  /// Draws a line across the whole frame.
  void line(const SectionTrace& line, std::string_view attributes);
  /// Fills an outline that lies within the frame.
  void fill(const SectionLine& outline, std::string_view attributes);
  /// Draws an intersection with its name, `lower_px` below the default baseline.
  void dot(const SectionPoint& p, std::string_view name, double lower_px);
  /// Draws a numbered scene or image point; hollow if it was not used.
  void mark(const SectionPoint& p, std::size_t number, bool used, double radius);
  /// Draws text next to a point, within the frame.
  void words(const SectionPoint& p, std::string_view words, double lower_px);

 private:
  Svg& svg_;
  SceneFrame frame_;
  double unit_;
  Axes axes_;
};

}  // namespace petzval::figure_detail
