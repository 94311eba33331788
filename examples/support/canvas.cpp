// SPDX-License-Identifier: Apache-2.0
#include "canvas.hpp"

#include <algorithm>
#include <cmath>

namespace examples {
namespace {

std::ptrdiff_t offset(const petzval::Rgb8Image& picture, int x, int y) {
  return (static_cast<std::ptrdiff_t>(y) * picture.width + x) * 3;
}

}  // namespace

petzval::Rgb8Image blank(int width, int height, const Colour& colour) {
  petzval::Rgb8Image picture{width, height, {}};
  picture.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  fill(picture, 0, 0, width, height, colour);
  return picture;
}

void fill(petzval::Rgb8Image& picture, int x, int y, int width, int height, const Colour& colour) {
  const int right = std::min(x + width, picture.width), foot = std::min(y + height, picture.height);
  for (int row = std::max(y, 0); row < foot; ++row) {
    for (int column = std::max(x, 0); column < right; ++column) {
      std::copy(colour.begin(), colour.end(), picture.pixels.begin() + offset(picture, column, row));
    }
  }
}

void disc(petzval::Rgb8Image& picture, double x, double y, double radius, const Colour& colour) {
  const auto first = [](double from, double reach) { return std::max(0, static_cast<int>(std::floor(from - reach))); };
  const auto last = [](double from, double reach, int most) {
    return std::min(most - 1, static_cast<int>(std::ceil(from + reach)));
  };
  for (int row = first(y, radius + 1); row <= last(y, radius + 1, picture.height); ++row) {
    for (int column = first(x, radius + 1); column <= last(x, radius + 1, picture.width); ++column) {
      const double cover = std::clamp(radius + 0.5 - std::hypot(column - x, row - y), 0.0, 1.0);
      for (std::size_t c = 0; c < 3; ++c) {
        auto& value = picture.pixels[static_cast<std::size_t>(offset(picture, column, row)) + c];
        value = static_cast<std::uint8_t>(std::lround(value + cover * (colour[c] - value)));
      }
    }
  }
}

void place(petzval::Rgb8Image& picture, int x, int y, const petzval::Rgb8Image& tile) {
  for (int row = 0; row < tile.height; ++row) {
    std::copy_n(tile.pixels.begin() + offset(tile, 0, row), tile.width * 3,
                picture.pixels.begin() + offset(picture, x, y + row));
  }
}

}  // namespace examples
