// SPDX-License-Identifier: Apache-2.0
// Rays on their way, lane by lane. Included like lanes.hpp.
#pragma once

#include <cstdint>

#include "block.hpp"
#if defined(PETZVAL_ONE_LANE)
#include "one_lane.hpp"
#else
#include "lanes.hpp"
#endif

/// For what a single ray passes in registers.
#if defined(PETZVAL_ONE_LANE)
#define PETZVAL_ONE_LANE_INLINE PETZVAL_INLINE
#else
#define PETZVAL_ONE_LANE_INLINE
#endif

/// Where there are registers for four vectors of rays, the loop over them is laid out.
#if defined(__AVX512F__)
#define PETZVAL_UNROLL _Pragma("GCC unroll 4")
#else
#define PETZVAL_UNROLL
#endif

namespace petzval::trace_detail {
namespace {

/// Rays in front of the next step: points from its vertex, directions p of length n (the index), in the turned frame of
/// kernel::Step. The numbers of lost rays are meaningless; `alive` and `tally` tell which they are.
template <class R>
struct Bundle {
  using V = Lanes<R>;
  static constexpr int rays = rays_in_bundle<R>;
  static constexpr int vectors = rays / V::width;
#if defined(PETZVAL_ONE_LANE)
  static constexpr int used = 1;
#else
  int used = vectors;  ///< the first ones hold rays, the others none: a few rays need not cost what a whole bundle does
#endif
  static_assert(block_rays % rays == 0);

  V x[vectors], y[vectors], z[vectors];
  V px[vectors], py[vectors], pz[vectors];
  V r2[vectors];  ///< x^2 + y^2
  Mask<R> alive[vectors];
  /// Four for every surface passed: one for the hit, one for the rim, two for the refraction. What is missing at the
  /// last one tells the ray's fate.
  typename Native<R>::Bits tally[vectors];
};

/// The fate of a lost ray, from the excess of its tally over the surfaces passed, as a number, so that loops run on
/// lanes. unsettled: the search for a hit did not converge.
PETZVAL_INLINE std::int32_t lost_by(std::int32_t beyond, bool unsettled) noexcept {
  std::int32_t fate = beyond == 0 ? static_cast<std::int32_t>(RayFate::missed_surface)
                                  : static_cast<std::int32_t>(RayFate::totally_reflected);
  fate = beyond == 1 ? static_cast<std::int32_t>(RayFate::vignetted) : fate;
  return unsettled ? static_cast<std::int32_t>(RayFate::no_convergence) : fate;
}

/// How points and directions change with one parameter.
template <class R>
struct Tangent {
  Lanes<R> x[Bundle<R>::vectors], y[Bundle<R>::vectors], z[Bundle<R>::vectors];
  Lanes<R> px[Bundle<R>::vectors], py[Bundle<R>::vectors], pz[Bundle<R>::vectors];
};

}  // namespace
}  // namespace petzval::trace_detail
