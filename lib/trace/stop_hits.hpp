// SPDX-License-Identifier: Apache-2.0
// Where a bundle of rays meets the stop. Included like lanes.hpp.
#pragma once

#include "steps.hpp"

namespace petzval::trace_detail {
namespace {

/// Follows a bundle as far as the stop (trace/stop_points.hpp).
template <class R>
class StopHits : public NoTangents {
  using V = Lanes<R>;

 public:
  StopHits(const Bundle<R>& b, R* x, R* y) noexcept : x_(x), y_(y) {
    for (int i = 0; i < b.used; ++i) {
      store(x_ + i * V::width, V(R(0)));
      store(y_ + i * V::width, V(R(0)));
    }
  }

  /// Behind a step.
  void watch(const Route<R>& route, std::size_t j, const Bundle<R>& b) noexcept {
    if (!route.sequence.steps[j].stop) return;
    for (int i = 0; i < b.used; ++i) {
      store(x_ + i * V::width, select(b.alive[i], b.x[i], V(R(0))));
      store(y_ + i * V::width, select(b.alive[i], b.y[i], V(R(0))));
    }
    met_ = true;
  }
  /// No more steps are wanted.
  bool done() const noexcept { return met_; }

 private:
  R *x_, *y_;
  bool met_ = false;
};

}  // namespace
}  // namespace petzval::trace_detail
