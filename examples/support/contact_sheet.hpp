// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Lays out the tiles on a dark sheet with captions. The tiles of a row must have one size.
petzval::Rgb8Image draw_sheet(const Sheet& sheet);

}  // namespace examples
