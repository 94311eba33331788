// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "petzval/image/image.hpp"

namespace examples {

/// A focus point by its position in the picture.
struct SurfacePoint {
  double x = 0, y = 0;  ///< pixels from the upper left
  std::size_t number = 0;
};

/// A quantity over a picture, as colours with contour lines.
struct SurfaceMap {
  std::string title;           ///< "distance in focus"
  std::vector<double> values;  ///< width x height, rows from the top
  /// Contours and ticks of the scale.
  struct Level {
    double value = 0;
    std::string words;
  };
  std::vector<Level> levels;
  std::string low_words, high_words;  ///< labels at the ends of the scale
  std::vector<SurfacePoint> points;   ///< points that the surface passes through
};

struct SurfaceSheet {
  std::string title, subtitle;
  std::vector<std::string> notes;  ///< lines at the foot
  int width = 0, height = 0;       ///< size of the maps
  std::vector<SurfaceMap> maps;    ///< drawn below each other
};

petzval::Rgb8Image draw_surface_sheet(const SurfaceSheet& sheet);

}  // namespace examples
