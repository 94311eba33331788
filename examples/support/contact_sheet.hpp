// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"

namespace examples {

/// A picture with lines of text below.
struct Tile {
  petzval::Rgb8Image picture;
  std::vector<std::string> captions;
};

/// Tiles side by side at one scale: a pixel is `pixel_mm` of film. 0: no scale bar.
struct SheetRow {
  std::string title;
  std::string subtitle;
  double pixel_mm = 0;
  std::vector<Tile> tiles;
};

struct Sheet {
  std::string title;
  std::vector<SheetRow> rows;
  std::vector<std::string> notes;  ///< lines at the foot
};

/// Width of the tiles that fill a row of a sheet with this many columns, in pixels.
int column_pixels(std::size_t columns);
/// The same for square tiles: at most 400.
inline int tile_pixels(std::size_t columns) { return std::min(400, column_pixels(columns)); }

/// Enlarges or reduces a picture to a width, by linear interpolation or weighted means.
petzval::RgbImage with_width(const petzval::RgbImage& picture, int width);

/// Lays out the tiles on a dark sheet with captions and a scale bar. The tiles of a row must have one size. All sheets
/// have the same width unless a row needs more. A row without title and subtitle continues the row above.
petzval::Rgb8Image draw_sheet(const Sheet& sheet);

}  // namespace examples
