// SPDX-License-Identifier: Apache-2.0
#include "contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "svg_page.hpp"
#include "text.hpp"

namespace examples {
namespace {

constexpr std::string_view paper = "#0e0f12", ink = "#ecedf0", faint = "#969aa2";
constexpr int sheet_width = 1280, margin = 36, gap = 10, least_column = 160;
constexpr int title_size = 26, row_title_size = 20, caption_size = 15;

/// The longest of 1, 2, 5 x 10^k mm that is within the limit.
double round_length(double limit) {
  const double decade = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= limit) return step * decade;
  }
  return decade;
}

/// Draws the bar of a row above the right end of its tiles.
void draw_scale_bar(SvgPage& page, double right, double foot, double longest, double pixel_mm) {
  const double length = round_length(pixel_mm * longest), width = std::max(1.0, length / pixel_mm);
  page.rect(right - width, foot - 7, width, 3, ink);
  page.text(right, foot - 14, caption_size, number(length, 3) + " mm", ink, "end");
}

/// Width of a column of a row, px: as wide as its widest picture if that is not too wide or too narrow.
double column_of(const SheetRow& row) {
  const auto columns = static_cast<int>(row.columns > 0 ? row.columns : row.tiles.size());
  int width = 0;
  for (const Tile& tile : row.tiles) width = std::max(width, tile.picture.width);
  return std::max(least_column, std::min(width, (sheet_width - 2 * margin + gap) / columns - gap));
}

double width_of(const SheetRow& row) { return static_cast<double>(row.tiles.size()) * (column_of(row) + gap) - gap; }

/// Width of the widest tile of a row on the film; 0 if one is unknown.
double width_mm_of(const SheetRow& row) {
  double width = 0;
  for (const Tile& tile : row.tiles) {
    if (tile.width_mm <= 0) return 0;
    width = std::max(width, tile.width_mm);
  }
  return width;
}

/// Draws the titles and the scale bar of a row. Returns y of their foot.
double draw_titles(SvgPage& page, const SheetRow& row, double y, double width) {
  if (row.title.empty() && row.subtitle.empty()) return y;
  constexpr double label = 80;
  const double longest = column_of(row) / 3, pixel_mm = width_mm_of(row) / column_of(row);
  if (pixel_mm > 0) width -= std::max(longest, label) + 2 * gap;
  double foot = page.paragraph(margin, y + gap, width, row_title_size, row.title, ink);
  foot = page.paragraph(margin, foot, width, caption_size, row.subtitle, faint) + gap / 2.0;
  if (pixel_mm > 0) {
    const double words = std::max(text_width(row.title, row_title_size), text_width(row.subtitle, caption_size));
    const double clear = std::min(words, width) + std::max(longest, label) + 2 * gap;
    draw_scale_bar(page, margin + std::max(clear, width_of(row)), foot, longest, pixel_mm);
  }
  return foot;
}

}  // namespace

int tile_pixels(std::size_t columns) {
  return std::clamp((sheet_width - 2 * margin + gap) / static_cast<int>(columns) - gap, least_column, 400);
}

std::string draw_sheet(const Sheet& sheet) {
  double width = sheet_width - 2 * margin;
  for (const SheetRow& row : sheet.rows) width = std::max(width, width_of(row));
  SvgPage page;
  double y = page.paragraph(margin, margin, width, title_size, sheet.title, ink) + gap / 2.0;
  for (const SheetRow& row : sheet.rows) {
    y = draw_titles(page, row, y, width);
    const double column = column_of(row), widest_mm = width_mm_of(row);
    const auto width_on_sheet = [&](const Tile& t) { return widest_mm > 0 ? column * t.width_mm / widest_mm : column; };
    const auto height_on_sheet = [&](const Tile& t) { return width_on_sheet(t) * t.picture.height / t.picture.width; };
    double x = margin, height = 0;
    for (const Tile& tile : row.tiles) height = std::max(height, height_on_sheet(tile));
    double foot = y + height;
    for (const Tile& tile : row.tiles) {
      const double tile_width = width_on_sheet(tile), tile_height = height_on_sheet(tile);
      page.rect(x, y, column, height, "#000");
      page.picture(x + (column - tile_width) / 2, y + (height - tile_height) / 2, tile_width, tile_height,
                   tile.picture);
      double below = y + height + gap / 2.0;
      for (const std::string& caption : tile.captions) {
        const std::string_view fill = &caption == &tile.captions.front() ? ink : faint;
        below = page.paragraph(x, below, column, caption_size, caption, fill);
      }
      foot = std::max(foot, below);
      x += column + gap;
    }
    y = foot + 2 * gap;
  }
  for (const std::string& note : sheet.notes) y = page.paragraph(margin, y, width, caption_size, note, faint);
  return page.finish(width + 2 * margin, std::ceil(y) + margin, paper);
}

}  // namespace examples
