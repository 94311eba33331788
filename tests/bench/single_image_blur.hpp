// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/blur/layers.hpp"
#include "petzval/image/image.hpp"

/// Thin-lens parameters of an image-space blur filter.
struct CircleOfConfusion {
  double px_mm = 0;          ///< radius per inverse depth off focus: focal_px times the radius of the lens
  double inverse_focus = 0;  ///< 1/mm
};

/// Blurs the first layer like a post-process, from its depths only: the baseline of gather().
///
/// Each pixel gathers the light that the discs of pixels around it scatter onto it ("scatter as gather"), at points of
/// a Vogel spiral. Nearer surfaces cover the pixel by the fraction of their discs that reach it; the largest disc near
/// a tile limits the search. Farther surfaces count only within the disc of the pixel, so that a sharp foreground stays
/// sharp; they fill the gaps of a blurred foreground. Full resolution, linear colours.
///
/// camera: camera of the image; the overscan of the layers may be larger. taps: number of taps of a gather; pixels that
/// nearer discs may reach from beyond their own radius gather twice.
///
/// Source: Jimenez 2014, "Next generation post processing in Call of Duty: Advanced Warfare" (separate foreground and
/// background, tiles with the largest discs).
petzval::RgbImage single_image_blur(const petzval::LayerSet& layers, const petzval::LayerCamera& camera,
                                    const CircleOfConfusion& circle, int taps, int threads);

/// Blurs the first layer by filters of rows and columns: discs are sums of two complex Gaussians. The fields behind and
/// before the plane of focus are filtered separately, the field before with the largest disc that reaches a tile.
///
/// Source: Garcia 2017, "Circular separable convolution depth of field" (kernels with two components).
petzval::RgbImage separable_blur(const petzval::LayerSet& layers, const petzval::LayerCamera& camera,
                                 const CircleOfConfusion& circle, int threads);
