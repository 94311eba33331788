// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "svg_page.hpp"

namespace examples {

/// A focus point in the picture.
struct MapPoint {
  double x = 0, y = 0;  ///< pixels from the upper left
  std::size_t number = 0;
  std::string words = {};  ///< a label beside the point; may be empty
  bool used = true;
};

struct MapLevel {
  double value = 0;
  std::string words = {};
};

/// A quantity over a picture, in colours.
struct Map {
  std::string title = {};
  std::vector<double> values = {};              ///< width x height, rows from the top; NaN: grey
  double low = 0, high = 0;                     ///< values at the ends of the scale
  std::vector<Colour> colours = {};             ///< of the scale, at equal steps
  std::vector<MapLevel> contours = {};          ///< lines in the map and on the scale, with labels in the map
  std::vector<MapLevel> ticks = {};             ///< words below the scale
  std::array<std::string, 3> scale_words = {};  ///< below the ticks: left, in the middle, right
  bool both_signs = false;                      ///< a contour is a level of the absolute value
  std::vector<MapPoint> points = {};
};

struct MapSheet {
  std::string title = {}, subtitle = {};
  std::vector<std::string> notes = {};  ///< lines at the foot
  int width = 0, height = 0;            ///< size of the maps, pixels
  double scale = 1;                     ///< size of a pixel on the sheet, px
  std::vector<Map> maps = {};           ///< drawn below each other
};

/// Draws the maps with contours, points and scales, as an SVG file.
std::string draw_map_sheet(const MapSheet& sheet);

}  // namespace examples
