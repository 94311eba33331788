// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace petzval::figure_detail {

/// A length in an SVG file, to 1/100 of a pixel, whatever the locale.
std::string svg_number(double value);

/// The text of an SVG file under construction. Coordinates in pixels, y down.
class Svg {
 public:
  Svg(double width, double height);

  /// attributes: as in SVG, 'fill="none" stroke="#888"'.
  void rect(double x, double y, double width, double height, std::string_view attributes);
  void circle(double x, double y, double radius, std::string_view attributes);
  void ellipse(double x, double y, double half_width, double half_height, std::string_view attributes);
  void path(std::string_view d, std::string_view attributes);
  void text(double x, double y, std::string_view text, std::string_view attributes = {});

  std::string finish() &&;

 private:
  void element(std::string_view head, std::string_view attributes);

  std::string out_;
};

}  // namespace petzval::figure_detail
