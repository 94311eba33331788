// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/blur/layers.hpp"
#include "petzval/image/image.hpp"

/// A thin lens as a filter of pictures sees it.
struct CircleOfConfusion {
  double px_mm = 0;          ///< radius per inverse depth off focus: focal_px times the radius of the lens
  double inverse_focus = 0;  ///< 1/mm
};

/// The first layer blurred as a post-process does it, with its depths alone: the baseline of gather().
///
/// Each pixel gathers what the discs of pixels around it would scatter onto it ("scatter as gather"), at points of a
/// Vogel spiral. Nearer things cover it by the share of their discs that reach it, from as far away as the largest disc
/// near a tile. What lies behind it is seen only within its own disc, so that a sharp foreground stays sharp, and fills
/// what a blurred foreground leaves open there. Full resolution, all colours linear.
///
/// camera: of the picture; the layers' overscan may be larger. taps: of one gathering; pixels that nearer discs may
/// reach from farther than their own radius gather twice.
///
/// Source of the ideas: Jimenez 2014, "Next generation post processing in Call of Duty: Advanced Warfare" (foreground
/// and background apart, tiles of largest discs).
petzval::RgbImage single_image_blur(const petzval::LayerSet& layers, const petzval::LayerCamera& camera,
                                    const CircleOfConfusion& circle, int taps, int threads);
