// SPDX-License-Identifier: Apache-2.0
// A bundle of rays during a trace. Included like core/lanes.hpp.
#pragma once

#include <cstdint>

#include "block.hpp"
#if defined(PETZVAL_ONE_LANE)
#include "core/one_lane.hpp"
#else
#include "core/lanes.hpp"
#endif

/// Inlines the functions that must keep a single ray in registers.
#if defined(PETZVAL_ONE_LANE)
#define PETZVAL_ONE_LANE_INLINE PETZVAL_INLINE
#else
#define PETZVAL_ONE_LANE_INLINE
#endif

/// Unrolls the loop over vectors if the registers suffice for four vectors of rays.
#if defined(__AVX512F__)
#define PETZVAL_UNROLL _Pragma("GCC unroll 4")
#else
#define PETZVAL_UNROLL
#endif

namespace petzval::trace_detail {
namespace {

#if defined(PETZVAL_ONE_LANE)
using namespace core_detail::one_lane;
template <class R>
inline constexpr int rays_in_bundle = 1;
#else
using namespace core_detail;
/// A bundle has 64 or 32 rays, enough to hide the latency of square roots.
template <class R>
inline constexpr int rays_in_bundle = 256 / static_cast<int>(sizeof(R));
#endif

/// Rays in front of the next step: points relative to its vertex and directions p of length n (the index), in the frame
/// of kernel::Step. Values of lost rays are meaningless; see `alive` and `tally`.
template <class R>
struct Bundle {
  using V = Lanes<R>;
  static constexpr int rays = rays_in_bundle<R>;
  static constexpr int vectors = rays / V::width;
#if defined(PETZVAL_ONE_LANE)
  static constexpr int used = 1;
#else
  int used = vectors;  ///< number of vectors that hold rays, so that a few rays cost less than a bundle
#endif
  static_assert(block_rays % rays == 0);

  V x[vectors], y[vectors], z[vectors];
  V px[vectors], py[vectors], pz[vectors];
  V r2[vectors];  ///< x^2 + y^2
  Mask<R> alive[vectors];
  /// Four is added for every surface passed: one for the hit, one for the rim, two for the refraction. The remainder at
  /// the last surface tells the fate of a lost ray.
  typename Native<R>::Bits tally[vectors];
};

/// Fate of a lost ray, as a number so that loops vectorise.
/// @param beyond its tally minus four for each surface passed
/// @param unsettled true if the search for a hit did not converge
PETZVAL_INLINE std::int32_t lost_by(std::int32_t beyond, bool unsettled) noexcept {
  std::int32_t fate = beyond == 0 ? static_cast<std::int32_t>(RayFate::missed_surface)
                                  : static_cast<std::int32_t>(RayFate::totally_reflected);
  fate = beyond == 1 ? static_cast<std::int32_t>(RayFate::vignetted) : fate;
  return unsettled ? static_cast<std::int32_t>(RayFate::no_convergence) : fate;
}

/// Derivatives of points and directions with respect to one parameter.
template <class R>
struct Tangent {
  Lanes<R> x[Bundle<R>::vectors], y[Bundle<R>::vectors], z[Bundle<R>::vectors];
  Lanes<R> px[Bundle<R>::vectors], py[Bundle<R>::vectors], pz[Bundle<R>::vectors];
};

}  // namespace
}  // namespace petzval::trace_detail
