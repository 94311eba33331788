// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"

namespace examples {

/// A picture with lines of text below.
struct Tile {
  petzval::Rgb8Image picture;
  std::vector<std::string> captions;
  double width_mm = 0;  ///< of the picture on the film; 0: unknown
};

/// Tiles side by side, at one scale if all their widths are known.
struct SheetRow {
  std::string title;
  std::string subtitle;
  std::vector<Tile> tiles = {};
  std::size_t columns = 0;  ///< 0: one for each tile
};

struct Sheet {
  std::string title;
  std::vector<SheetRow> rows;
  std::vector<std::string> notes;  ///< lines at the foot
};

/// Size of square pictures that fill the columns of a row: at most 400 pixels, at least 160 for the captions.
int tile_pixels(std::size_t columns);

/// Lays out the tiles on a dark sheet with captions and a scale bar, as an SVG file. The pictures of a row are centred
/// in equal columns, and captions wrap at the width of the column. All sheets have the same width unless a row needs
/// more. A row without title and subtitle continues the row above.
std::string draw_sheet(const Sheet& sheet);

}  // namespace examples
