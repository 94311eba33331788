// SPDX-License-Identifier: Apache-2.0
#include "contact_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "canvas.hpp"
#include "font.hpp"
#include "text.hpp"

namespace examples {
namespace {

constexpr Colour paper{14, 15, 18}, ink{236, 237, 240}, faint{150, 154, 162};
constexpr int sheet_width = 1280, margin = 36, gap = 10, line = 21;
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

/// Draws the bar of a row above the right end of its tiles.
void draw_scale_bar(petzval::Rgb8Image& picture, Font& font, int right, int bottom, int tile_width, double pixel_mm) {
  const double length = round_length(pixel_mm * tile_width / 3);
  const int width = std::max(1, static_cast<int>(std::lround(length / pixel_mm)));
  const std::string text = number(length, 3) + " mm";
  fill(picture, right - width, bottom - 13, width, 3, ink);
  font.draw(picture, right - font.width(text, caption_size), bottom - 20, caption_size, text, ink);
}

/// The largest number of lines below a tile of the row.
int caption_lines(const SheetRow& row) {
  std::size_t most = 0;
  for (const Tile& tile : row.tiles) most = std::max(most, tile.captions.size());
  return static_cast<int>(most);
}

/// The text in lines that are at most `width` pixels wide, unless a word is longer.
std::vector<std::string> wrapped(Font& font, const std::string& text, int width) {
  std::vector<std::string> result{""};
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    std::string& last = result.back();
    const std::string longer = last.empty() ? word : last + ' ' + word;
    if (last.empty() || font.width(longer, caption_size) <= width) {
      last = longer;
    } else {
      result.push_back(word);
    }
  }
  return result;
}

/// Height of the titles of a row. A row without titles continues the row above.
int titles_height(const SheetRow& row) { return row.title.empty() && row.subtitle.empty() ? 0 : row_title_height; }

}  // namespace

int column_pixels(std::size_t columns) { return (sheet_width - 2 * margin + gap) / static_cast<int>(columns) - gap; }

petzval::RgbImage with_width(const petzval::RgbImage& picture, int width) {
  if (picture.width == width) return picture;
  const int height = std::max(1, static_cast<int>(std::lround(1.0 * picture.height * width / picture.width)));
  petzval::RgbImage result(width, height);
  // A tent as wide as a pixel of the picture or of the result, whichever is larger.
  const auto weights = [](int i, int count_of_result, int count) {
    const double scale = static_cast<double>(count) / count_of_result, centre = (i + 0.5) * scale;
    const double reach = std::max(1.0, scale);
    std::vector<std::pair<int, double>> all;
    double sum = 0;
    for (int k = std::max(0, static_cast<int>(centre - reach)); k < std::min<double>(count, centre + reach); ++k) {
      const double weight = 1 - std::abs(k + 0.5 - centre) / reach;
      if (weight > 0) all.emplace_back(k, weight), sum += weight;
    }
    for (auto& [index, weight] : all) weight /= sum;
    return all;
  };
  for (int y = 0; y < height; ++y) {
    const auto rows = weights(y, height, picture.height);
    for (int x = 0; x < width; ++x) {
      std::array<double, 3> sum{};
      for (const auto& [column, by_column] : weights(x, width, picture.width)) {
        for (const auto& [row, by_row] : rows) {
          for (std::size_t c = 0; c < 3; ++c) sum[c] += by_column * by_row * picture.pixel(column, row)[c];
        }
      }
      for (std::size_t c = 0; c < 3; ++c) result.pixel(x, y)[c] = static_cast<float>(sum[c]);
    }
  }
  return result;
}

petzval::Rgb8Image draw_sheet(const Sheet& sheet) {
  Font font;
  int width = std::max(sheet_width, 2 * margin + font.width(sheet.title, title_size));
  int height = margin + title_height + margin;
  for (const SheetRow& row : sheet.rows) {
    const int tile = row.tiles.front().picture.width, tile_height = row.tiles.front().picture.height;
    const int lines = caption_lines(row);
    width = std::max(width, 2 * margin + static_cast<int>(row.tiles.size()) * (tile + gap) - gap);
    width = std::max(width, 2 * margin + font.width(row.subtitle, caption_size));
    height += titles_height(row) + tile_height + lines * line + 2 * gap;
  }
  std::vector<std::string> notes;
  for (const std::string& note : sheet.notes) {
    for (std::string& text : wrapped(font, note, width - 2 * margin)) notes.push_back(std::move(text));
  }
  height += static_cast<int>(notes.size()) * line;

  petzval::Rgb8Image picture = blank(width, height, paper);
  int y = margin;
  font.draw(picture, margin, y + title_size, title_size, sheet.title, ink);
  y += title_height;
  for (const SheetRow& row : sheet.rows) {
    font.draw(picture, margin, y + 28, row_title_size, row.title, ink);
    font.draw(picture, margin, y + 50, caption_size, row.subtitle, faint);
    y += titles_height(row);
    const int tile_width = row.tiles.front().picture.width, tile_height = row.tiles.front().picture.height;
    int right = margin + static_cast<int>(row.tiles.size()) * (tile_width + gap) - gap;
    constexpr int label_width = 80;
    const bool crowded = right < margin + font.width(row.subtitle, caption_size) + tile_width / 3 + label_width;
    if (crowded) right = width - margin;  // at the right edge of the sheet
    if (titles_height(row) > 0 && row.pixel_mm > 0) draw_scale_bar(picture, font, right, y, tile_width, row.pixel_mm);
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
    y += tile_height + caption_lines(row) * line + 2 * gap;
  }
  y += line;
  for (const std::string& note : notes) {
    font.draw(picture, margin, y, caption_size, note, faint);
    y += line;
  }
  return picture;
}

}  // namespace examples
