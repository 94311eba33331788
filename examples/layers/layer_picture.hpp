// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "layers/layer_input.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/image/image.hpp"

/// Steps from layers to a picture that `petzval blur` and `petzval view` share.
namespace lens_blur {

/// Depth for which rays and layers are set up. It is less than the depth of the nearest surface in the picture, because
/// objects in the overscan of the layers may be nearer.
inline double least_depth(double nearest_mm) { return 0.8 * nearest_mm; }

/// The layers for rays. Files have a fixed number of pixels.
petzval::PeelPlan plan_of(const LayerInput& input, const petzval::LensRays& rays, double nearest_mm);

/// Default of --highlights-above, the radiance above which small lights become uniform discs.
///
/// A light much brighter than its surroundings would show the dots of single rays. The threshold is 6 times the mean of
/// the first layer, and at most 1 (white). It is at most 0.75 for files without values above white, such as PNG, whose
/// white pixels may be lights.
double threshold_of(const petzval::LayerSet& layers, bool of_file);

/// The colours of a blurred image.
petzval::RgbImage colours_of(const petzval::BlurredImage& picture);

/// The layers within the picture, composited as a pinhole sees them.
petzval::RgbImage sharp_of(const petzval::LayerSet& layers, const petzval::LayerCamera& camera);

/// A part of the picture with light above a threshold.
struct BrightPart {
  petzval::Vec2<double> raster{0, 0};  ///< middle of its light, px
  double inverse_depth = 0;            ///< mean, 1/mm
  std::array<double, 3> light{};       ///< sum of the radiances of its pixels
};

/// The parts with the most light above a threshold, at most `most` of 24 x 24 parts, by decreasing light.
/// Infinite pixels do not count.
std::vector<BrightPart> bright_parts(const petzval::LayerSet& layers, const petzval::LayerCamera& camera, double above,
                                     std::size_t most);

/// The mean over squares of side x side pixels.
petzval::RgbImage averaged(const petzval::RgbImage& image, int side);

}  // namespace lens_blur
