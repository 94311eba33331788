// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/image/image.hpp"

namespace lens_blur {

/// Similarity of two pictures, linear and clipped to 0 to 1.
struct Likeness {
  double psnr_db = 0;  ///< infinite for equal pictures
  double ssim = 0;     ///< mean structural similarity of luma, 11 x 11 window. Source: Wang et al. 2004
};

/// The similarity over pixels where `mask` is not 0, or over all pixels if `mask` is empty.
/// @throws petzval::Error if the sizes of the pictures differ
Likeness likeness(const petzval::RgbImage& picture, const petzval::RgbImage& reference,
                  const std::vector<unsigned char>& mask = {});

/// Differences visible to an observer who flips between two pictures, from 0 to 1 per pixel, at 67 pixels per degree.
/// Source: Andersson et al. 2020, "FLIP: a difference evaluator for alternating images".
std::vector<float> flip(const petzval::RgbImage& picture, const petzval::RgbImage& reference);

/// Relative difference of the total light: picture / reference - 1.
double energy_drift(const petzval::RgbImage& picture, const petzval::RgbImage& reference);

/// Mask (0 or 1, row by row) of the pixels within one circle of confusion of a depth edge in the first layer. A depth
/// edge is a step of inverse depth between neighbours that is larger than rays can follow.
std::vector<unsigned char> near_depth_edges(const petzval::LayerSet& layers, const petzval::LensRays& rays);

/// Likeness of a picture with some rays per pixel and a picture with many.
struct RayQuality {
  double rays = 0, psnr_db = 0;
};

/// A plot of PSNR over the number of rays, on a logarithmic axis, as SVG. Equal pictures are left out.
std::string quality_plot(std::vector<RayQuality> qualities, const std::string& remark);

}  // namespace lens_blur
