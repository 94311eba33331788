// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/image/image.hpp"

namespace lens_blur {

/// How alike two pictures are, linear and clipped to 0 to 1.
struct Likeness {
  double psnr_db = 0;  ///< infinity where they are the same
  double ssim = 0;     ///< mean structural similarity of luma. Source: Wang et al. 2004, with their 11 x 11 window
};

/// Over pixels where `mask` is not 0, or all without a mask. Throws petzval::Error for pictures of different sizes.
Likeness likeness(const petzval::RgbImage& picture, const petzval::RgbImage& reference,
                  const std::vector<unsigned char>& mask = {});

/// What an observer sees who flips between two pictures, from 0 to 1 per pixel, at 67 pixels per degree. Source:
/// Andersson et al. 2020, "FLIP: a difference evaluator for alternating images".
std::vector<float> flip(const petzval::RgbImage& picture, const petzval::RgbImage& reference);

/// The light of a picture over that of another, less 1.
double energy_drift(const petzval::RgbImage& picture, const petzval::RgbImage& reference);

/// The pixels of a picture that lie within one circle of confusion of an edge of depth in the first layer: where a
/// neighbour's inverse depth differs by more than rays can follow. 0 or 1, row by row.
std::vector<unsigned char> near_depth_edges(const petzval::LayerSet& layers, const petzval::LensRays& rays);

}  // namespace lens_blur
