// SPDX-License-Identifier: Apache-2.0
#include "surface_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "canvas.hpp"
#include "font.hpp"

namespace examples {
namespace {

constexpr Colour paper{251, 251, 250}, ink{29, 32, 38}, faint{86, 91, 102}, line_colour{40, 44, 52};
constexpr int margin = 36, top = 92, line = 21, bar_height = 20, title_size = 26, subtitle_size = 16, small = 15,
              heading = 28, below_map = 22, scale_height = 92;

/// Deep blue through green and yellow to near white, of increasing lightness, for t from 0 to 1.
Colour colour_of(double t) {
  constexpr std::array<Colour, 6> stops{
      {{46, 30, 96}, {44, 84, 150}, {38, 134, 142}, {82, 178, 116}, {184, 210, 80}, {250, 236, 150}}};
  const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  Colour result;
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = static_cast<std::uint8_t>(
        std::lround(stops[k][c] + (at - static_cast<double>(k)) * (stops[k + 1][c] - stops[k][c])));
  }
  return result;
}

class Drawing {
 public:
  explicit Drawing(const SurfaceSheet& sheet) : sheet_(sheet), map_width_(std::max(sheet.width, 640)) {}

  petzval::Rgb8Image draw() {
    int width =
        std::max({map_width_, font_.width(sheet_.title, title_size), font_.width(sheet_.subtitle, subtitle_size)});
    for (const std::string& words : sheet_.notes) width = std::max(width, font_.width(words, small));
    const int each = heading + sheet_.height + below_map + scale_height;
    const int notes = top + static_cast<int>(sheet_.maps.size()) * each + line;
    page_ = blank(width + 2 * margin, notes + static_cast<int>(sheet_.notes.size()) * line + margin - line, paper);
    font_.draw(page_, margin, 46, title_size, sheet_.title, ink);
    font_.draw(page_, margin, 72, subtitle_size, sheet_.subtitle, faint);
    int y = top;
    for (const SurfaceMap& map : sheet_.maps) {
      font_.draw(page_, margin, y + 17, small, map.title, ink);
      draw_map(map, y + heading);
      draw_points(map, y + heading);
      draw_scale(map, y + heading + sheet_.height + below_map);
      y += each;
    }
    for (std::size_t i = 0; i < sheet_.notes.size(); ++i) {
      font_.draw(page_, margin, notes + static_cast<int>(i) * line, small, sheet_.notes[i], faint);
    }
    return std::move(page_);
  }

 private:
  static std::pair<double, double> range(const SurfaceMap& map) {
    const auto [low, high] = std::minmax_element(map.values.begin(), map.values.end());
    return {*low, *high};
  }
  /// The value's fraction of the map's range, from 0 to 1; 0.5 if all values of the map are equal.
  static double part(const SurfaceMap& map, double value) {
    const auto [low, high] = range(map);
    return high > low ? (value - low) / (high - low) : 0.5;
  }
  double at(const SurfaceMap& map, int x, int y) const {
    return map
        .values[static_cast<std::size_t>(y) * static_cast<std::size_t>(sheet_.width) + static_cast<std::size_t>(x)];
  }

  void draw_map(const SurfaceMap& map, int map_top) {
    const auto [low, high] = range(map);
    fill(page_, margin - 1, map_top - 1, sheet_.width + 2, sheet_.height + 2, line_colour);
    for (int y = 0; y < sheet_.height; ++y) {
      for (int x = 0; x < sheet_.width; ++x) {
        const double t = high > low ? (at(map, x, y) - low) / (high - low) : 0.5;
        fill(page_, margin + x, map_top + y, 1, 1, colour_of(t));
      }
    }
    for (const SurfaceMap::Level& level : map.levels) draw_contour(map, level, map_top);
  }

  void draw_contour(const SurfaceMap& map, const SurfaceMap::Level& level, int map_top) {
    std::vector<std::array<int, 2>> pixels;
    for (int y = 0; y + 1 < sheet_.height; ++y) {
      for (int x = 0; x + 1 < sheet_.width; ++x) {
        const bool above = at(map, x, y) > level.value;
        if (above == (at(map, x + 1, y) > level.value) && above == (at(map, x, y + 1) > level.value)) continue;
        fill(page_, margin + x, map_top + y, 1, 1, line_colour);
        pixels.push_back({x, y});
      }
    }
    // Place the label where the line is farthest from the points and the frame.
    const int width = font_.width(level.words, small);
    double best = 0;
    std::array<int, 2> label_position{};
    for (const auto& [x, y] : pixels) {
      double clearance = std::min({x - width / 2, sheet_.width - x - width / 2, y - 8, sheet_.height - y - 8}) - 2.0;
      for (const SurfacePoint& point : map.points)
        clearance = std::min(clearance, std::hypot(x - point.x, y - point.y) - 24);
      for (const auto& other : names_) clearance = std::min(clearance, std::hypot(x - other[0], y - other[1]) - 30);
      if (clearance > best) best = clearance, label_position = {x, y};
    }
    if (best <= 0) return;
    names_.push_back(label_position);
    fill(page_, margin + label_position[0] - width / 2 - 3, map_top + label_position[1] - 9, width + 6, 18, paper);
    font_.draw(page_, margin + label_position[0] - width / 2, map_top + label_position[1] + 5, small, level.words, ink);
  }

  void draw_points(const SurfaceMap& map, int map_top) {
    names_.clear();
    for (const SurfacePoint& point : map.points) {
      if (!(point.x >= 0 && point.x < sheet_.width && point.y >= 0 && point.y < sheet_.height)) continue;
      const std::string name = std::to_string(point.number);
      disc(page_, margin + point.x, map_top + point.y, 11, ink);
      disc(page_, margin + point.x, map_top + point.y, 9.5, {255, 255, 255});
      const int left = margin + static_cast<int>(std::lround(point.x)),
                base = map_top + static_cast<int>(std::lround(point.y));
      font_.draw(page_, left - font_.width(name, 13) / 2, base + 5, 13, name, ink);
    }
  }

  void draw_scale(const SurfaceMap& map, int y) {
    for (int x = 0; x < map_width_; ++x) fill(page_, margin + x, y, 1, bar_height, colour_of((x + 0.5) / map_width_));
    int free_from = 0;
    for (const SurfaceMap::Level& level : map.levels) {
      const int x = margin + static_cast<int>(std::lround(part(map, level.value) * map_width_));
      fill(page_, x, y, 1, bar_height, line_colour);
      const int width = font_.width(level.words, small);
      const int left = std::clamp(x - width / 2, margin, margin + map_width_ - width);
      if (left < free_from) continue;
      font_.draw(page_, left, y + bar_height + 18, small, level.words, ink);
      free_from = left + width + 10;
    }
    const int base = y + bar_height + 18 + line;
    font_.draw(page_, margin, base, small, map.low_words, faint);
    font_.draw(page_, margin + map_width_ - font_.width(map.high_words, small), base, small, map.high_words, faint);
  }

  const SurfaceSheet& sheet_;
  int map_width_;
  Font font_;
  petzval::Rgb8Image page_;
  std::vector<std::array<int, 2>> names_;
};

}  // namespace

petzval::Rgb8Image draw_surface_sheet(const SurfaceSheet& sheet) { return Drawing(sheet).draw(); }

}  // namespace examples
