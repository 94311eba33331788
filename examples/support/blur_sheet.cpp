// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "blur_map.hpp"
#include "canvas.hpp"
#include "font.hpp"
#include "text.hpp"

namespace examples {
namespace {

constexpr Colour paper{251, 251, 250}, ink{29, 32, 38}, faint{86, 91, 102}, line_colour{60, 64, 72},
    no_light{150, 150, 150};
constexpr int margin = 36, top = 92, line = 21, bar_height = 20, title_size = 26, subtitle_size = 16, small = 15;

/// Deep blue through white to deep red for t from -1 to 1.
Colour colour_of(double t) {
  constexpr Colour white{255, 255, 255}, blue{26, 84, 170}, red{190, 38, 32}, deep_blue{8, 32, 84}, deep_red{92, 8, 20};
  const double size = std::min(std::abs(t), 1.0);
  const auto mix = [](const Colour& a, const Colour& b, double by) {
    Colour result;
    for (std::size_t c = 0; c < 3; ++c) result[c] = static_cast<std::uint8_t>(std::lround(a[c] + by * (b[c] - a[c])));
    return result;
  };
  if (size < 0.6) return mix(white, t < 0 ? blue : red, size / 0.6);
  return mix(t < 0 ? blue : red, t < 0 ? deep_blue : deep_red, (size - 0.6) / 0.4);
}

std::string micrometres(double mm) {
  const double um = std::round(1e4 * mm) / 10 + 0.0;
  const double shown = std::abs(um) >= 10 ? std::round(um) : um;
  return (shown < 0 ? "\u2212" : shown > 0 ? "+" : "") + number(std::abs(shown)) + " \u00b5m";
}

void draw_map(petzval::Rgb8Image& page, const BlurMap& map, const BlurSheet& sheet) {
  const auto at = [&](int x, int y) {
    return map
        .diameter_mm[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const double d = at(x, y);
      // Contour line at the limit of sharpness.
      const auto sharp = [&sheet](double blur) { return std::abs(blur) <= sheet.sharp_mm; };
      const bool edge = (x + 1 < map.width && sharp(d) != sharp(at(x + 1, y))) ||
                        (y + 1 < map.height && sharp(d) != sharp(at(x, y + 1)));
      const Colour colour = edge ? line_colour : std::isnan(d) ? no_light : colour_of(d / sheet.scale_mm);
      fill(page, margin + x, top + y, 1, 1, colour);
    }
  }
}

void draw_points(petzval::Rgb8Image& page, Font& font, const petzval::Film& film, const BlurMap& map,
                 const BlurSheet& sheet) {
  for (std::size_t i = 0; i < sheet.points.size(); ++i) {
    const MarkedPoint& point = sheet.points[i];
    if (!point.where) continue;
    const petzval::Vec2<double> at = film.raster(*point.where);
    const double x = at.x, y = at.y;
    if (!(x >= 0 && x < map.width && y >= 0 && y < map.height)) continue;
    const std::string number = std::to_string(i + 1);
    const std::string words = std::isnan(point.blur_mm) ? "" : micrometres(point.blur_mm);
    disc(page, margin + x, top + y, 13, ink);
    disc(page, margin + x, top + y, 11.5, point.used ? Colour{255, 255, 255} : Colour{205, 205, 205});
    const int left = margin + static_cast<int>(std::lround(x)), base = top + static_cast<int>(std::lround(y));
    font.draw(page, left - font.width(number, small) / 2, base + 5, small, number, ink);
    if (words.empty()) continue;
    const int width = font.width(words, small);
    const int words_left = x + 24 + width > map.width ? left - 20 - width : left + 20;
    fill(page, words_left - 4, base - 11, width + 8, 21, paper);
    font.draw(page, words_left, base + 5, small, words, ink);
  }
}

void draw_scale(petzval::Rgb8Image& page, Font& font, int y, int width, const BlurSheet& sheet) {
  for (int x = 0; x < width; ++x) {
    fill(page, margin + x, y, 1, bar_height, colour_of(2.0 * (x + 0.5) / width - 1));
  }
  const auto at = [&](double mm) {
    return margin + static_cast<int>(std::lround((mm / sheet.scale_mm + 1) / 2 * width));
  };
  for (int k = -2; k <= 2; ++k) {
    const double mm = sheet.scale_mm * k / 2;
    const std::string words = micrometres(mm);
    const int w = font.width(words, small);
    font.draw(page, std::clamp(at(mm) - w / 2, margin, margin + width - w), y + bar_height + 18, small, words, ink);
  }
  for (const double limit : {-sheet.sharp_mm, sheet.sharp_mm}) {
    if (std::abs(limit) < sheet.scale_mm) fill(page, at(limit), y, 1, bar_height, line_colour);
  }
  const std::string nearer = "nearer than the plane of focus", sharp = "sharp", beyond = "beyond the plane of focus";
  const int base = y + bar_height + 18 + line;
  font.draw(page, margin, base, small, nearer, faint);
  font.draw(page, at(0) - font.width(sharp, small) / 2, base, small, sharp, faint);
  font.draw(page, margin + width - font.width(beyond, small), base, small, beyond, faint);
}

}  // namespace

petzval::Rgb8Image draw_blur_sheet(const BlurMap& map, const petzval::Film& film, const BlurSheet& sheet) {
  Font font;
  int width = std::max(map.width, 700);
  width = std::max({width, font.width(sheet.title, title_size), font.width(sheet.subtitle, subtitle_size)});
  for (const std::string& words : sheet.notes) width = std::max(width, font.width(words, small));
  const int bar = top + map.height + 22, notes = bar + bar_height + 54 + line;
  petzval::Rgb8Image page =
      blank(width + 2 * margin, notes + static_cast<int>(sheet.notes.size()) * line + margin - line, paper);
  font.draw(page, margin, 46, title_size, sheet.title, ink);
  font.draw(page, margin, 72, subtitle_size, sheet.subtitle, faint);
  fill(page, margin - 1, top - 1, map.width + 2, map.height + 2, line_colour);
  draw_map(page, map, sheet);
  draw_points(page, font, film, map, sheet);
  draw_scale(page, font, bar, std::max(map.width, 700), sheet);
  for (std::size_t i = 0; i < sheet.notes.size(); ++i) {
    font.draw(page, margin, notes + static_cast<int>(i) * line, small, sheet.notes[i], faint);
  }
  return page;
}

}  // namespace examples
