// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/export.hpp"

namespace petzval {

struct GatherOptions {
  int threads = 1;
  /// Surfaces brighter than this in any channel, of which the rays of a pixel would meet too few to show their blur
  /// evenly, are spread over the pixels instead: even discs of the lens's own shape. 0: none.
  double highlights_above = 1;
};

struct GatherStatistics {
  std::uint64_t rays = 0;
  std::uint64_t missed = 0;  ///< found no surface although the scene goes on there
  std::uint64_t steps = 0;   ///< of all lanes of the processor
  std::uint64_t highlights = 0;
  double gather_seconds = 0, highlight_seconds = 0;
};

/// A picture. Refilled without allocation if it does not grow. Colours are darkened where the lens passes less light;
/// alpha and missed are shares of the light that it passes there, so that a surface all over a dark corner has alpha 1.
struct Blurred {
  int columns = 0, rows = 0;
  std::vector<float> rgba;    ///< columns x rows x 4, linear, colours multiplied with alpha
  std::vector<float> missed;  ///< columns x rows: the share, by weight, of rays that met what the layers do not know
  GatherStatistics statistics;

  /// What gather() works with.
  struct Memory;
  std::shared_ptr<Memory> memory;
};

/// The picture of layers through a lens.
///
/// Each ray is followed from near to far, pixel after pixel along its main direction, until it meets a surface in the
/// pixel that it passes at the surface's own depth; those with alpha below 1 let the rest through. A ray that passes
/// between a pixel's surface and a nearer one of the next pixel meets the farther one if their inverse depths differ by
/// less than the bias of peeling: what lies between is not in the layers. A ray that meets nothing is transparent if
/// the first layer is empty where it ends, at the depth of the farthest surface. Else it slipped behind a surface: it
/// counts as missed, and takes what it passed last before, or where there is nothing, the mean of the pixel's others.
/// Beyond the layers' edges their last pixels repeat. Layers reach beyond the picture equally on all sides
/// (PeelPlan::camera). The same bits for any number of threads.
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 3.1.
///
/// Throws Error for layers of another size, options out of range, and rays of a tile that reach over more than 256 MiB
/// of layers beyond their edges. A picture that memory does not suffice for is left empty.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options, Blurred& picture);
PETZVAL_API Blurred gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options = {});

}  // namespace petzval
