// SPDX-License-Identifier: Apache-2.0
// Distance of a bundle of rays from the rims. Included like core/lanes.hpp.
#pragma once

#include <limits>

#include "steps.hpp"

namespace petzval::trace_detail {
namespace {

/// Follows a bundle and keeps the smallest clearance of each ray (trace/clearances.hpp).
template <class R>
class LeastClearance : public NoTangents {
  using V = Lanes<R>;

 public:
  explicit LeastClearance(const Bundle<R>& b) noexcept {
    for (int i = 0; i < Bundle<R>::vectors; ++i) {
      least_[i] = V(std::numeric_limits<R>::infinity());
      lost_[i] = select(b.alive[i], V(R(0)), V(R(-2)));
      alive_[i] = b.alive[i];
    }
  }

  /// Called behind each step.
  void watch(const Route<R>& route, std::size_t j, const Bundle<R>& b) noexcept {
    const kernel::Step<R>& s = route.sequence.steps[j];
    // The sign of a difference of squares equals the result of the comparison with the rim in the trace; scaling does
    // not change the sign.
    const R scale = s.rim2 > 4 * std::numeric_limits<R>::min() ? 1 / s.rim2 : R(1);
    const auto iris = s.stop ? route.iris : std::span<const kernel::StopEdge<R>>{};
    const V left(R(-1) - static_cast<R>(route.steps - j) / static_cast<R>(route.steps)), none(R(0));
    for (int i = 0; i < Bundle<R>::vectors; ++i) {
      V own = (V(s.rim2) - b.r2[i]) * V(scale);
      if (s.obscuration2 > 0) own = smaller((b.r2[i] - V(s.obscuration2)) * V(scale), own);
      for (const auto& edge : iris) own = smaller(kernel::edge_clearance(edge, b.x[i], b.y[i]) * sqrt(V(scale)), own);
      // Without apertures, rims do not block rays.
      const Mask<R> lost = without(alive_[i], b.alive[i]);
      const Mask<R> otherwise = route.apertures ? without(lost, own < none) : lost;
      lost_[i] = select(otherwise, left, lost_[i]);
      least_[i] = select(without(alive_[i], otherwise), smaller(own, least_[i]), least_[i]);
      alive_[i] = b.alive[i];
    }
  }

  /// Writes the clearances, one per ray. Call it after the bundle has left the lens.
  void leave(const Bundle<R>& b, R* to) const noexcept {
    const V none(R(0)), one(R(1));
    for (int i = 0; i < Bundle<R>::vectors; ++i) {
      const V value = select(least_[i] < none, least_[i] / (one - least_[i]), least_[i]);
      const V lost = select(without(alive_[i], b.alive[i]), -one, lost_[i]);
      store(to + i * V::width, select(lost < none, smaller(value, none) + lost, value));
    }
  }

 private:
  static PETZVAL_INLINE V smaller(V a, V b) noexcept { return select(a < b, a, b); }

  V least_[Bundle<R>::vectors];  ///< minimum over the rims so far
  V lost_[Bundle<R>::vectors];   ///< below 0 for rays that were not lost at a rim
  Mask<R> alive_[Bundle<R>::vectors];
};

}  // namespace
}  // namespace petzval::trace_detail
