// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "petzval/blur/gather.hpp"
#include "petzval/core/config.hpp"

namespace petzval::blur_detail {

/// Assignment of rays to SIMD lanes.
enum class GatherPath : std::uint8_t {
  automatic,        ///< the fastest path that the rays allow
  shift_invariant,  ///< adjacent pixels, one common ray: equal steps
  coherent,         ///< adjacent pixels, one ray each: nearly equal steps
  general,          ///< the rays of one pixel
};
/// "automatic", ...
PETZVAL_API std::string_view name(GatherPath path) noexcept;

struct GatherMethod {
  GatherPath path = GatherPath::automatic;
  /// Limits the steps of a tile's rays to the depths that occur below the rays. The limit does not change the surface
  /// that a ray meets, but it may change the guess for a ray that meets no surface.
  bool limit_steps = true;
};

/// petzval::gather() by a given path, for tests and benchmarks. Throws Error if the rays do not allow the path.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                        const GatherMethod& method, BlurredImage& picture);
PETZVAL_API BlurredImage gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                                const GatherMethod& method);

}  // namespace petzval::blur_detail
