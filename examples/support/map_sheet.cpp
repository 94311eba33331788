// SPDX-License-Identifier: Apache-2.0
#include "map_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "petzval/core/geometry.hpp"
#include "text.hpp"

namespace examples {
namespace {

constexpr std::string_view paper = "#fbfbfa", ink = "#1d2026", faint = "#565b66", line_colour = "#282c34";
constexpr int margin = 36, bar_height = 20, title_size = 26, subtitle_size = 16, small = 15;
constexpr double least_width = 640;
constexpr double cap = 0.36;  ///< from the middle of a digit to the baseline, as a fraction of the size

using Point = petzval::Vec2<double>;

class Drawing {
 public:
  explicit Drawing(const MapSheet& sheet)
      : sheet_(sheet),
        map_width_(sheet.scale * sheet.width),
        map_height_(sheet.scale * sheet.height),
        width_(std::max(map_width_, least_width)) {}

  std::string draw() {
    double y = page_.paragraph(margin, margin / 2.0, width_, title_size, sheet_.title, ink);
    y = page_.paragraph(margin, y, width_, subtitle_size, sheet_.subtitle, faint);
    for (const Map& map : sheet_.maps) {
      y = page_.paragraph(margin, y + 8, width_, small, map.title, ink) + 8;
      top_ = y, labels_.clear();
      draw_map(map);
      for (const MapLevel& level : map.contours) draw_contour(map, level);
      for (const MapPoint& point : map.points) draw_point(point);
      y = draw_scale(map, y + map_height_ + 22) + 16;
    }
    for (const std::string& note : sheet_.notes) y = page_.paragraph(margin, y, width_, small, note, faint);
    return page_.finish(width_ + 2 * margin, std::ceil(y) + margin, paper);
  }

 private:
  /// The quantity that contours show.
  double height_at(const Map& map, int x, int y) const {
    const double value = map.values[static_cast<std::size_t>(y * sheet_.width + x)];
    return map.both_signs ? std::abs(value) : value;
  }

  /// Position of a value on the scale, from 0 to 1; 0.5 if the scale has no length.
  static double on_scale(const Map& map, double value) {
    return map.high > map.low ? std::clamp((value - map.low) / (map.high - map.low), 0.0, 1.0) : 0.5;
  }

  void draw_map(const Map& map) {
    petzval::Rgb8Image picture{sheet_.width, sheet_.height, {}};
    for (const double value : map.values) {
      Colour colour{150, 150, 150};
      if (!std::isnan(value)) {
        const double position = on_scale(map, value) * static_cast<double>(map.colours.size() - 1);
        const std::size_t k = std::min(static_cast<std::size_t>(position), map.colours.size() - 2);
        for (std::size_t c = 0; c < 3; ++c) {
          colour[c] = static_cast<std::uint8_t>(
              std::lround(std::lerp(map.colours[k][c], map.colours[k + 1][c], position - static_cast<double>(k))));
        }
      }
      picture.pixels.insert(picture.pixels.end(), colour.begin(), colour.end());
    }
    page_.rect(margin - 1, top_ - 1, map_width_ + 2, map_height_ + 2, line_colour);
    page_.picture(margin, top_, map_width_, map_height_, picture);
  }

  /// Straight pieces of the line where the map crosses a level, in px from its upper left.
  std::vector<std::array<Point, 2>> pieces(const Map& map, double level) const {
    std::vector<std::array<Point, 2>> result;
    for (int y = 0; y + 1 < sheet_.height; ++y) {
      for (int x = 0; x + 1 < sheet_.width; ++x) {
        const std::array<std::array<int, 2>, 4> corners{{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
        std::vector<Point> crossings;  // of the sides of the cell
        for (std::size_t k = 0; k < 4; ++k) {
          const auto [x0, y0] = corners[k];
          const auto [x1, y1] = corners[(k + 1) % 4];
          const double from = height_at(map, x0, y0) - level, to = height_at(map, x1, y1) - level;
          if (std::isnan(from - to) || (from > 0) == (to > 0)) continue;
          const double t = from / (from - to);
          crossings.push_back(
              {(std::lerp(x0, x1, t) + 0.5) * sheet_.scale, (std::lerp(y0, y1, t) + 0.5) * sheet_.scale});
        }
        for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) result.push_back({crossings[k], crossings[k + 1]});
      }
    }
    return result;
  }

  void draw_contour(const Map& map, const MapLevel& level) {
    const double half = text_width(level.words, small) / 2;
    std::string line;
    Point best{};
    double best_clearance = 0;
    for (const auto& [from, to] : pieces(map, level.value)) {
      const auto add = [&](char command, const Point& p) {
        line +=
            command + number(std::round(10 * (margin + p.x)) / 10) + ' ' + number(std::round(10 * (top_ + p.y)) / 10);
      };
      add('M', from), add('L', to);
      // The label is where the line is farthest from the points, other labels and the frame.
      double clearance = std::min({from.x - half, map_width_ - from.x - half, from.y - 8, map_height_ - from.y - 8});
      for (const MapPoint& point : map.points)
        clearance =
            std::min(clearance, std::hypot(from.x - sheet_.scale * point.x, from.y - sheet_.scale * point.y) - 24);
      for (const Point& other : labels_)
        clearance = std::min(clearance, std::hypot(from.x - other.x, from.y - other.y) - 30);
      if (clearance > best_clearance) best_clearance = clearance, best = from;
    }
    if (!line.empty()) page_.path(line, "stroke=\"" + std::string(line_colour) + "\" stroke-linecap=\"round\"");
    if (level.words.empty() || best_clearance <= 2) return;
    labels_.push_back(best);
    label(margin + best.x - half, top_ + best.y, level.words);
  }

  /// Draws a word on paper, from `left`, around `middle`.
  void label(double left, double middle, const std::string& words) {
    const double width = text_width(words, small);
    page_.rect(left - 3, middle - 10, width + 6, 20, paper, "rx=\"3\"");
    page_.text(left + width / 2, middle + cap * small, small, words, ink, "middle");
  }

  void draw_point(const MapPoint& point) {
    const double right = sheet_.scale * point.x, down = sheet_.scale * point.y, width = text_width(point.words, small);
    if (!(right >= 0 && right < map_width_ && down >= 0 && down < map_height_)) return;
    constexpr double radius = 12, reach = 20;
    const double x = margin + right, y = top_ + down;
    page_.disc(x, y, radius, point.used ? "#fff" : "#cdcdcd",
               "stroke=\"" + std::string(ink) + "\" stroke-width=\"1.5\"");
    page_.text(x, y + cap * 13, 13, std::to_string(point.number), ink, "middle");
    const bool fits = right + reach + width < map_width_;
    if (!point.words.empty()) label(fits ? x + reach : x - reach - width, y, point.words);
  }

  /// Returns y of the foot.
  double draw_scale(const Map& map, double y) {
    page_.gradient(margin, y, width_, bar_height, map.colours);
    for (const MapLevel& level : map.contours) {
      for (const double value : {level.value, map.both_signs ? -level.value : level.value}) {
        if (value < map.low || value > map.high) continue;
        page_.rect(margin + on_scale(map, value) * width_, y, 1, bar_height, line_colour);
      }
    }
    double free_from = 0;
    y += bar_height + 18;
    for (const MapLevel& tick : map.ticks) {
      const double half = text_width(tick.words, small) / 2, x = on_scale(map, tick.value) * width_;
      const double middle = std::clamp(x, half, std::max(half, width_ - half));
      if (middle - half < free_from) continue;
      page_.text(margin + middle, y, small, tick.words, ink, "middle");
      free_from = middle + half + 10;
    }
    y += 21;
    page_.text(margin, y, small, map.scale_words[0], faint);
    page_.text(margin + width_ / 2, y, small, map.scale_words[1], faint, "middle");
    page_.text(margin + width_, y, small, map.scale_words[2], faint, "end");
    return y;
  }

  const MapSheet& sheet_;
  double map_width_, map_height_, width_;  ///< px; width_: of text and scale
  double top_ = 0;                         ///< of the map that is drawn
  SvgPage page_;
  std::vector<Point> labels_;  ///< in the map that is drawn
};

}  // namespace

std::string draw_map_sheet(const MapSheet& sheet) { return Drawing(sheet).draw(); }

}  // namespace examples
