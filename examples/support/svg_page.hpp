// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/image/image.hpp"

namespace examples {

using Colour = std::array<std::uint8_t, 3>;

/// Approximate width of a UTF-8 text in a wide sans-serif font, in pixels.
double text_width(std::string_view text, double size);

/// Builder of an SVG file with text and pictures. Coordinates in pixels, y down.
class SvgPage {
 public:
  /// @param attributes  SVG attributes, for example 'stroke="#888"'
  void rect(double x, double y, double width, double height, std::string_view fill, std::string_view attributes = {});
  void disc(double x, double y, double radius, std::string_view fill, std::string_view attributes = {});
  void path(std::string_view d, std::string_view attributes);
  /// @param anchor  start, middle or end: the point of the text at x
  void text(double x, double baseline, double size, std::string_view text, std::string_view fill,
            std::string_view anchor = "start");
  /// Draws lines of at most about `width` from `top` down. Breaks words that are wider.
  ///
  /// @return y of the foot; `top` if the text is empty
  double paragraph(double x, double top, double width, double size, std::string_view text, std::string_view fill);
  /// Embeds a picture as a PNG, scaled to a size.
  void picture(double x, double y, double width, double height, const petzval::Rgb8Image& picture);
  /// Draws a bar with colours at equal steps, from left to right.
  void gradient(double x, double y, double width, double height, const std::vector<Colour>& colours);

  std::string finish(double width, double height, std::string_view ground) const;

 private:
  std::string body_;
  int gradients_ = 0;
};

/// Writes an SVG file with parameters() as its metadata.
void write_svg(std::string svg, const std::filesystem::path& file);

}  // namespace examples
