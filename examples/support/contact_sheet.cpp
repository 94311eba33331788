// SPDX-License-Identifier: Apache-2.0
#include "contact_sheet.hpp"

#include <algorithm>
#include <cmath>

#include "canvas.hpp"
#include "font.hpp"
#include "text.hpp"

namespace examples {
namespace {

constexpr Colour paper{14, 15, 18}, ink{236, 237, 240}, faint{150, 154, 162};
constexpr int margin = 36, gap = 10, line = 21;
constexpr int title_size = 26, row_title_size = 20, caption_size = 15;
constexpr int title_height = 44, row_title_height = 64;

/// The longest of 1, 2, 5 x 10^k mm that is within the limit.
double round_length(double limit) {
  const double decade = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= limit) return step * decade;
  }
  return decade;
}

void draw_scale_bar(petzval::Rgb8Image& picture, Font& font, int x, int bottom, int tile_width, double pixel_mm) {
  const double length = round_length(pixel_mm * tile_width / 3);
  const int width = std::max(1, static_cast<int>(std::lround(length / pixel_mm)));
  fill(picture, x + 12, bottom - 14, width, 3, ink);
  font.draw(picture, x + 12, bottom - 21, 13, number(length, 3) + " mm", ink);
}

/// The largest number of lines below a tile of the row.
int caption_lines(const SheetRow& row) {
  std::size_t most = 0;
  for (const Tile& tile : row.tiles) most = std::max(most, tile.captions.size());
  return static_cast<int>(most);
}

}  // namespace

petzval::Rgb8Image draw_sheet(const Sheet& sheet) {
  Font font;
  int width = 2 * margin, height = margin + title_height + margin;
  width += font.width(sheet.title, title_size);
  for (const std::string& note : sheet.notes) width = std::max(width, 2 * margin + font.width(note, caption_size));
  for (const SheetRow& row : sheet.rows) {
    const int tile = row.tiles.front().picture.width, tile_height = row.tiles.front().picture.height;
    const int lines = caption_lines(row);
    width = std::max(width, 2 * margin + static_cast<int>(row.tiles.size()) * (tile + gap) - gap);
    width = std::max(width, 2 * margin + font.width(row.subtitle, caption_size));
    height += row_title_height + tile_height + lines * line + 2 * gap;
  }
  height += static_cast<int>(sheet.notes.size()) * line;

  petzval::Rgb8Image picture = blank(width, height, paper);
  int y = margin;
  font.draw(picture, margin, y + title_size, title_size, sheet.title, ink);
  y += title_height;
  for (const SheetRow& row : sheet.rows) {
    font.draw(picture, margin, y + 28, row_title_size, row.title, ink);
    font.draw(picture, margin, y + 50, caption_size, row.subtitle, faint);
    y += row_title_height;
    const int tile_width = row.tiles.front().picture.width, tile_height = row.tiles.front().picture.height;
    int x = margin;
    for (const Tile& tile : row.tiles) {
      place(picture, x, y, tile.picture);
      int baseline = y + tile_height + line;
      for (const std::string& caption : tile.captions) {
        font.draw(picture, x + 2, baseline, caption_size, caption, &caption == &tile.captions.front() ? ink : faint);
        baseline += line;
      }
      x += tile_width + gap;
    }
    if (row.pixel_mm > 0) draw_scale_bar(picture, font, margin, y + tile_height, tile_width, row.pixel_mm);
    y += tile_height + caption_lines(row) * line + 2 * gap;
  }
  y += line;
  for (const std::string& note : sheet.notes) {
    font.draw(picture, margin, y, caption_size, note, faint);
    y += line;
  }
  return picture;
}

}  // namespace examples
