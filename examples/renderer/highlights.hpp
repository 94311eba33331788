// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "petzval/io/image.hpp"

namespace renderer {

/// The shape of a blurred light in a picture.
struct Highlight {
  double x = 0, y = 0;          ///< its centroid, pixels from the upper left
  double axis_ratio = 1;        ///< of the root mean squares along its longest and its shortest axis
  double to_radius_deg = 0;     ///< of the long axis against the line to the middle of the picture, 0 to 90
  double outward_skewness = 0;  ///< along that line: above 0, the light has a tail away from the middle, as a comet
  double light = 0;             ///< in the mask, over the background
};

/// The highlight in a part of a picture: moments of the luminance over its background, the median of the part's upper
/// and lower rows. Pixels count where the mean of 3 x 3 is above a quarter of the highlight's top level (the
/// brightest 2.5 % of these means): the halo of light between glossy surfaces does not. Nothing for a part without
/// light.
std::optional<Highlight> highlight_in(const petzval::RgbImage& picture, int first_column, int last_column);

/// Those of the balls scene, from left to right: 13 at even distances about the middle. The distance is the one at
/// which they are brightest. Nothing where balls are not found.
std::vector<std::optional<Highlight>> ball_highlights(const petzval::RgbImage& picture);

}  // namespace renderer
