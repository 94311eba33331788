// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace petzval::figure_detail {

/// A coordinate for an SVG file, rounded to 1/100 of a pixel, independent of the locale.
std::string svg_number(double value);

/// Builder of an SVG file. Coordinates in pixels, y down.
class Svg {
 public:
  Svg(double width, double height);

  /// @param attributes  SVG attributes, for example 'fill="none" stroke="#888"'
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
