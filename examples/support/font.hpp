// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "petzval/image/image.hpp"

namespace examples {

using Colour = std::array<std::uint8_t, 3>;

/// Draws text on pictures in the sans-serif font that Fontconfig names.
class Font {
 public:
  /// @throws petzval::Error if the system has no font
  Font();
  ~Font();

  /// Width of a UTF-8 text, in pixels.
  int width(std::string_view text, int pixel_size);

  /// Draws with the left end of the baseline at (x, y), clipped to the picture.
  void draw(petzval::Rgb8Image& picture, int x, int y, int pixel_size, std::string_view text, const Colour& colour);

 private:
  struct Face;
  std::unique_ptr<Face> face_;
};

}  // namespace examples
