// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "petzval/blur/gather.hpp"
#include "petzval/core/export.hpp"

namespace petzval::blur_detail {

/// How rays are brought to the lanes of the processor.
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
  /// Whether the depths below the rays of a tile bound the way of its rays. What they meet does not depend on it;
  /// guesses for those that meet nothing may.
  bool bounded = true;
};

/// petzval::gather() in one of its ways, for tests and benchmarks. Throws Error for a path that the rays do not allow.
PETZVAL_API void gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                        const GatherWay& way, Blurred& picture);
PETZVAL_API Blurred gather(const LayerSet& layers, const LensRays& rays, const GatherOptions& options,
                           const GatherWay& way);

}  // namespace petzval::blur_detail
