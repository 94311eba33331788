// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "petzval/blur/gather.hpp"
#include "petzval/core/export.hpp"

namespace petzval::blur_detail {

/// The assignment of rays to the lanes of the processor.
enum class GatherPath : std::uint8_t {
  automatic,        ///< the fastest that the rays allow
  shift_invariant,  ///< neighbouring pixels, one ray: the same step for all
  coherent,         ///< neighbouring pixels, one ray each, nearly the same step
  general,          ///< the rays of one pixel
};
/// "automatic", ...
PETZVAL_API std::string_view name(GatherPath path) noexcept;

struct GatherWay {
  GatherPath path = GatherPath::automatic;
  /// The depths below the rays of a tile bound the steps of its rays. The bound changes no surface that a ray meets; it
  /// may change the guess for a ray that meets no surface.
  bool bounded = true;
};

/// petzval::gather() in one of its ways, for tests and benchmarks. Throws Error for a path that the rays do not allow.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                        const GatherWay& way, Blurred& picture);
PETZVAL_API Blurred gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                           const GatherWay& way);

}  // namespace petzval::blur_detail
