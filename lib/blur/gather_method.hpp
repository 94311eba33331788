// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/config.hpp"

namespace petzval::blur_detail {

struct GatherMethod {
  /// Pixels of a block follow the line at its middle if their own lines differ little; false: each pixel follows lines
  /// of its own.
  bool by_blocks = true;
  /// Limits the steps of a tile's rays to the depths that occur below the rays. The limit does not change the surface
  /// that a ray meets, but it may change the guess for a ray that meets no surface.
  bool limit_steps = true;
};

/// petzval::gather() by a given method, for tests and benchmarks.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                        const GatherMethod& method, BlurredImage& picture);
PETZVAL_API BlurredImage gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                                const GatherMethod& method);

}  // namespace petzval::blur_detail
