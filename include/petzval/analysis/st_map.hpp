// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "petzval/analysis/lens_distortion.hpp"
#include "petzval/core/export.hpp"

namespace petzval {

/// For each pixel of a picture, the place of another picture that it shows: s from 0 at the left edge to 1 at the right
/// one, t from 0 at the bottom to 1 at the top, as Nuke's STMap reads them. The centre of the first of n pixels is at
/// 0.5 / n.
///
/// 0 and 1 are the edges of the film's picture in both maps, whatever the margin; places beside it are below 0 or above
/// 1. A pixel that sees nothing has s = t = -1.
struct PETZVAL_API StMap {
  int width = 0, height = 0;       ///< pixels, with the margin
  int margin_x = 0, margin_y = 0;  ///< pixels on either side of the film's picture
  std::vector<float> s{}, t{};     ///< width x height, rows from the top

  /// False outside the map.
  bool sees(int column, int row) const noexcept;
};

/// The two maps between the picture of a lens and that of its pinhole.
struct StMaps {
  StMap undistort;  ///< pixels of the pinhole's picture, with the margin: where the lens's picture shows them
  StMap redistort;  ///< pixels of the lens's picture, those of the film: where the pinhole's picture shows them
};

struct StMapOptions {
  /// Size of the pinhole's picture over that of the film, at least 1. Unset: the smallest that holds all that the film
  /// sees, and at most 2: what lies farther out in a picture of a fisheye is cut.
  std::optional<double> overscan = {};
  int threads = 1;  ///< the maps do not depend on them
};

/// Maps of the film's pixels. A pinhole's picture through `redistort` looks as the lens shows it, a lens's picture
/// through `undistort` as the pinhole does.
///
/// Both are computed at nodes, 16 pixels apart at most, and interpolated in between: within 0.001 pixels of
/// LensDistortion, 0.02 near the end of the light and 0.1 at fields beyond 70 degrees. Where that does not reach it,
/// mostly at the edge of what the film sees, they are computed pixel by pixel. One after the other they lead back
/// within 0.005 pixels by exact and first-order models, where they are interpolated linearly
/// (tests/analysis/st_map_test.cpp). Throws Error for an overscan below 1 or above 10, for fewer than 1 thread, and
/// for a dark film.
PETZVAL_API StMaps st_maps(const LensDistortion& distortion, const StMapOptions& options = {});

}  // namespace petzval
