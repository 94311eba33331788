// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/config.hpp"

namespace petzval {

/// Options of gather().
struct GatherOptions {
  int threads = 1;
  /// Surfaces brighter than this in any channel are spread over the image as discs of the lens's own shape, if the rays
  /// of a pixel would meet too few of them for a smooth blur. 0: no surfaces are spread.
  double highlights_above = 1;
  /// Cancels gather() from another thread, within the time of about two tiles of 64 x 16 pixels: gather() throws
  /// Cancelled, and the picture is empty.
  std::stop_token stop{};
};

/// Counts and times of a gather().
struct GatherStatistics {
  std::uint64_t rays = 0;
  std::uint64_t missed = 0;  ///< rays that met a region unknown to the layers
  std::uint64_t steps = 0;   ///< summed over SIMD lanes
  std::uint64_t highlights = 0;
  double gather_seconds = 0, highlight_seconds = 0;
};

/// The result of gather(). It can be refilled without allocation if its size does not grow.
///
/// Colours include the vignetting of the lens. `missed` and alpha are relative to the light that the lens passes at the
/// pixel: a surface that fills a dark corner has alpha 1.
struct BlurredImage {
  int columns = 0, rows = 0;
  std::vector<float> rgba;    ///< columns x rows x 4, linear, premultiplied by alpha
  std::vector<float> missed;  ///< columns x rows: fraction of rays, by weight, that met regions unknown to the layers
  GatherStatistics statistics;

  /// Working memory of gather().
  struct Memory;
  std::shared_ptr<Memory> memory;
};

/// Renders the image of layers through a lens.
///
/// Each ray is followed from near to far, pixel by pixel along its main direction, until it meets a surface at the
/// depth of the ray in that pixel. Surfaces with alpha below 1 transmit the remainder. A ray that meets no surface is
/// transparent if the first layer is empty where it ends, at the depth of the farthest surface. Otherwise it has
/// slipped behind a surface: it counts as missed and takes the colour of the last surface that it passed or, failing
/// that, the mean of the other rays of its pixel. The result is bit-identical for any number of threads.
///
/// @param layers   the scene; they extend beyond the image equally on all sides (PeelPlan::camera). Their border pixels
///                 are repeated outwards
/// @param rays     the lens
/// @param options  threads, highlights and cancelling
/// @param picture  the result; left empty if an error occurs while it is filled
/// @throws Error   if the layers do not fit the image, options are out of range, rays reach more than 16384 pixels
///                 beyond the image, or the rays of a tile need more than 256 MiB of layers beyond their edges
/// @throws Cancelled  if `options.stop` requests a stop before the picture is complete
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 3.1.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                        BlurredImage& picture);
PETZVAL_API BlurredImage gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options = {});

}  // namespace petzval
