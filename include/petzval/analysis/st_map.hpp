// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "petzval/analysis/lens_distortion.hpp"
#include "petzval/core/export.hpp"

namespace petzval {

/// An ST map: for each pixel of an image, the position in another image from which it takes its value.
///
/// s runs from 0 at the left edge to 1 at the right edge, t from 0 at the bottom to 1 at the top, as in Nuke's STMap.
/// The centre of the first of n pixels is at 0.5 / n. In both maps 0 and 1 are the edges of the film image without its
/// margin; positions outside are below 0 or above 1. Pixels without a source position have s = t = -1.
struct PETZVAL_API StMap {
  int width = 0, height = 0;       ///< pixels, with the margin
  int margin_x = 0, margin_y = 0;  ///< pixels on either side of the film image
  std::vector<float> s{}, t{};     ///< width x height, rows from the top

  /// True if the pixel has a source position; false outside the map.
  bool sees(int column, int row) const noexcept;
};

/// The two maps between a lens image and the image of its pinhole.
struct StMaps {
  StMap undistort;  ///< for pixels of the pinhole image and its margin: positions in the lens image
  StMap redistort;  ///< for pixels of the lens image: positions in the pinhole image
};

struct StMapOptions {
  /// Size of the pinhole image relative to the film image, 1 to 10. Unset: the smallest size that contains everything
  /// the film sees, at most 2. The outer part of a fisheye image is cut off by this limit.
  std::optional<double> overscan = {};
  int threads = 1;  ///< does not change the maps
};

/// Computes ST maps for the pixels of a film: `undistort` warps a lens image to the pinhole image, `redistort` back.
///
/// The maps are computed at nodes at most 16 pixels apart and interpolated. Cells in which interpolation is not
/// accurate enough, mostly at the edge of the lit region, are computed pixel by pixel.
///
/// @throws Error if the overscan is not 1 to 10, there is less than 1 thread, or the film is dark
///
/// Accuracy: within 0.001 pixels of LensDistortion, 0.02 near the edge of the lit region and 0.1 at fields beyond 70
/// degrees. With linear interpolation of the maps and exact or first-order models, one map after the other returns to
/// the start within 0.005 pixels (tests/analysis/st_map_test.cpp).
PETZVAL_API StMaps st_maps(const LensDistortion& distortion, const StMapOptions& options = {});

}  // namespace petzval
