// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/exports/distortion.hpp"

namespace petzval {

/// A rectangle of raster positions.
struct RasterBox {
  Vec2<double> least{0, 0}, largest{0, 0};
};
/// Bounding box, in the pinhole image, of the scene region that the film sees; nullopt if the film is dark.
///
/// Sampled at 65 x 65 film points.
std::optional<RasterBox> undistorted_box(const LensDistortion& distortion);

}  // namespace petzval
