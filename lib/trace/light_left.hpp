// SPDX-License-Identifier: Apache-2.0
// The light that a bundle of rays keeps. Included like core/lanes.hpp.
#pragma once

#include "light_view.hpp"
#include "steps.hpp"

namespace petzval::trace_detail {
namespace {

/// Follows a bundle, multiplies the transmittances of the surfaces and adds the optical depths of the spaces.
/// @tparam RowAt row_at(row, i): a number of LightRows for each ray of vector i
template <class R, class RowAt>
class LightLeft : public NoTangents {
  using V = Lanes<R>;

 public:
  static constexpr bool enabled = true;

  PETZVAL_INLINE LightLeft(const LightView<R>& view, Travel travel, const RowAt& row_at) noexcept
      : view_(view), row_at_(row_at), space_in_front_(travel == Travel::to_film ? 0 : 1) {
    for (int i = 0; i < Bundle<R>::vectors; ++i) {
      left_[i] = V(R(1));
      depth_[i] = moved_[i] = variable_[i] = V(R(0));
    }
  }

  PETZVAL_INLINE void shift(int i, V t) noexcept { moved_[i] = t; }

  PETZVAL_INLINE void pass(const kernel::Step<R>& s, const Bundle<R>&, int i, const Contact<R>& at) noexcept {
    const SurfacePolynomial<R>& own = view_.surfaces[s.surface];
    if (own.terms > 0) {
      V low = at.xi, high = at.xo;
      if (own.lower == LowerIndex::varies) {
        const Mask<R> denser = at.xi < at.xo;
        low = select(denser, at.xi, at.xo);
        high = select(denser, at.xo, at.xi);
      } else if ((own.lower == LowerIndex::before) != (space_in_front_ == 0) && !s.mirror) {
        low = at.xo, high = at.xi;
      }
      V variable = low;
      if (own.variable == LightVariable::ratio) {
        variable = high * near_reciprocal(low + V(own.pole) * high);
      } else if (s.kind == kernel::StepKind::quadric || s.kind == kernel::StepKind::asphere) {
        variable = low / root(at.nn);
      }
      variable_[i] = V(own.scale) * variable + V(own.offset);
    }
    if (!view_.absorbs) return;
    const auto space = static_cast<std::uint32_t>(s.surface + space_in_front_);
    depth_[i] = depth_[i] + row_at_(view_.first_depth + space, i) * (at.q + moved_[i]);
    moved_[i] = V(R(0));
  }

  /// Evaluates the polynomials of several vectors together, to hide the latency of multiplications.
  PETZVAL_INLINE void watch(const Route<R>& route, std::size_t j, const Bundle<R>& b) noexcept {
    const SurfacePolynomial<R>& own = view_.surfaces[route.sequence.steps[j].surface];
    if (own.terms == 0) return;
    constexpr int together = Bundle<R>::vectors < 4 ? Bundle<R>::vectors : 4;
    for (int first = 0; first < b.used; first += together) {
      V x[together], value[together];
      PETZVAL_UNROLL
      for (int m = 0; m < together; ++m) x[m] = variable_[first + m], value[m] = row_at_(own.first, first + m);
      for (std::uint32_t k = 1; k < own.terms; ++k) {
        PETZVAL_UNROLL
        for (int m = 0; m < together; ++m) value[m] = value[m] * x[m] + row_at_(own.first + k, first + m);
      }
      PETZVAL_UNROLL
      for (int m = 0; m < together; ++m) left_[first + m] = left_[first + m] * value[m];
    }
  }

  /// Writes the light, one number for each ray. Call it after the bundle has left the lens.
  PETZVAL_INLINE void leave(const Bundle<R>& b, R* to) const noexcept {
    for (int i = 0; i < b.used; ++i) {
      const V light = view_.absorbs ? left_[i] / exponential(depth_[i]) : left_[i], none(R(0));
      // At grazing incidence a polynomial may be just below 0.
      store(to + i * V::width, select(b.alive[i] & (light > none), light, none));
    }
  }

 private:
  /// Taylor's series of a 32nd of the argument, squared five times: the relative error is below 1e-10 up to 4.
  static PETZVAL_INLINE V exponential(V x) noexcept {
    const V y = V(R(1. / 32)) * x;
    V sum(R(1));
    for (int k = 8; k > 0; --k) sum = V(R(1)) + sum * y * V(R(1) / static_cast<R>(k));
    for (int k = 0; k < 5; ++k) sum = sum * sum;
    return sum;
  }

  const LightView<R>& view_;
  const RowAt& row_at_;
  int space_in_front_;
  V left_[Bundle<R>::vectors], depth_[Bundle<R>::vectors], moved_[Bundle<R>::vectors], variable_[Bundle<R>::vectors];
};

}  // namespace
}  // namespace petzval::trace_detail
