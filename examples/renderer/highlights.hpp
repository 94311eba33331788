// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "petzval/image/image.hpp"

namespace renderer {

/// The shape of a blurred light in a picture.
struct Highlight {
  double x = 0, y = 0;          ///< centroid, pixels from the upper left
  double axis_ratio = 1;        ///< ratio of the RMS widths along the longest and the shortest axis
  double to_radius_deg = 0;     ///< angle of the long axis to the line to the picture's centre, 0 to 90
  double outward_skewness = 0;  ///< along that line; > 0: the tail points away from the centre, as in a comet
  double light = 0;             ///< light of the highlight, above the background
  double neighbour_light = 0;   ///< light of other spots in the same part of the picture, divided by `light`
  int width = 0, height = 0;    ///< pixels
  bool whole = false;           ///< false if the highlight reaches the border of its part of the picture

  /// True if the moments describe the blurred light: the highlight is complete, at least 6 pixels wide and high, and
  /// other spots have less than 5 % of its light.
  bool trusted() const noexcept { return whole && std::min(width, height) >= 6 && neighbour_light < 0.05; }
};

/// The highlight in a part of a picture, by moments of the luminance above the background; nullopt if the part is dark.
/// The background is the median of the upper and lower rows. A pixel counts if it belongs to the spot with the most
/// light and its mean of 3 x 3 pixels exceeds a quarter of the highlight's top level (the brightest 2.5 % of these
/// means). This excludes the halo between glossy surfaces and the reflections of other balls.
std::optional<Highlight> highlight_in(const petzval::RgbImage& picture, int first_column, int last_column);

/// The highlights of the balls scene, from left to right: 13 at equal distances about the centre, at the spacing where
/// they are brightest. nullopt if a ball has no highlight.
std::vector<std::optional<Highlight>> ball_highlights(const petzval::RgbImage& picture);

}  // namespace renderer
