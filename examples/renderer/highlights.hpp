// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "petzval/image/image.hpp"

namespace renderer {

/// The shape of a blurred light in a picture.
struct Highlight {
  double x = 0, y = 0;          ///< its centroid, pixels from the upper left
  double axis_ratio = 1;        ///< of the root mean squares along its longest and its shortest axis
  double to_radius_deg = 0;     ///< of the long axis against the line to the middle of the picture, 0 to 90
  double outward_skewness = 0;  ///< along that line: above 0, the light has a tail away from the middle, as a comet
  double light = 0;             ///< in the highlight, over the background
  double beside = 0;            ///< light of other spots in the same part of the picture, divided by `light`
  int width = 0, height = 0;    ///< pixels
  bool whole = false;           ///< false if the highlight reaches the border of its part of the picture

  /// True if the moments describe the blurred light: it is whole and at least 6 pixels wide and high, and
  /// other spots have less than 5 % of its light.
  bool trusted() const noexcept { return whole && std::min(width, height) >= 6 && beside < 0.05; }
};

/// The highlight in a part of a picture: moments of the luminance over its background, the median of the part's upper
/// and lower rows. Pixels count if the mean of 3 x 3 is above a quarter of the highlight's top level (the brightest
/// 2.5 % of these means) and they belong to the spot with the most light: the halo of light between glossy surfaces and
/// the reflections of other balls do not count. nullopt for a part without light.
std::optional<Highlight> highlight_in(const petzval::RgbImage& picture, int first_column, int last_column);

/// Those of the balls scene, from left to right: 13 at even distances about the middle. The distance is the one at
/// which they are brightest. Nothing where balls are not found.
std::vector<std::optional<Highlight>> ball_highlights(const petzval::RgbImage& picture);

}  // namespace renderer
