// SPDX-License-Identifier: Apache-2.0
// Derivatives of a bundle of rays with two parameters. Included like core/lanes.hpp.
#pragma once

#include "steps.hpp"

namespace petzval::trace_detail {
namespace {

/// Propagates derivatives by the chain rule; a dot stands for d/du or d/dv.
template <class R>
struct TwoTangents {
  using V = Lanes<R>;
  static constexpr bool enabled = true;
  Tangent<R> u, v;

  /// Moves the start of a ray along the ray: x + t p. The derivative of t has no effect before the next surface.
  PETZVAL_INLINE void shift(int i, V t) noexcept {
    shift(u, i, t);
    shift(v, i, t);
  }
  PETZVAL_INLINE void pass(const kernel::Step<R>& s, const Bundle<R>& b, int i, const Contact<R>& at) noexcept {
    // gamma nn = xo - xi and xo^2 = xi^2 + k nn.
    const V one(R(1)), per_xo = one / at.xo;
    const Rates rates{one / at.xi, -at.gamma * per_xo, (V(R(0.5)) * at.k * per_xo - at.gamma) / at.nn};
    pass(u, s, b, i, at, rates);
    pass(v, s, b, i, at, rates);
  }

  PETZVAL_INLINE void watch(const Route<R>&, std::size_t, const Bundle<R>&) noexcept {}

 private:
  /// Values common to both derivatives: 1 / xi, and the derivatives of gamma with respect to xi and nn.
  struct Rates {
    V per_xi, with_xi, with_nn;
  };

  static PETZVAL_INLINE void shift(Tangent<R>& d, int i, V t) noexcept {
    d.x[i] = d.x[i] + t * d.px[i];
    d.y[i] = d.y[i] + t * d.py[i];
    d.z[i] = d.z[i] + t * d.pz[i];
  }

  static PETZVAL_INLINE void pass(Tangent<R>& d, const kernel::Step<R>& s, const Bundle<R>& b, int i,
                                  const Contact<R>& at, const Rates& rates) noexcept {
    // The point stays on the surface: N x. = 0 gives the change of the distance along the ray.
    shift(d, i, at.q);
    const V on = (at.gx * d.x[i] + at.gy * d.y[i] - at.w * d.z[i]) * rates.per_xi;
    d.x[i] = d.x[i] + on * at.px;
    d.y[i] = d.y[i] + on * at.py;
    d.z[i] = d.z[i] + on * at.pz;

    // N. = -(ngx, ngy, ngz), and the change of gamma. On planes and spheres the length of N is constant.
    V ngx = at.cx * d.x[i], ngy = at.cy * d.y[i];
    const V ngz = at.cz * d.z[i];
    if (s.kind == kernel::StepKind::asphere) {
      const V h = V(s.ax) * b.x[i] * d.x[i] + V(s.ay) * b.y[i] * d.y[i];
      ngx = ngx + at.bx * b.x[i] * h;
      ngy = ngy + at.by * b.y[i] * h;
    }
    const V xi = at.w * d.pz[i] - at.gx * d.px[i] - at.gy * d.py[i] - (ngx * at.px + ngy * at.py + ngz * at.pz);
    V gamma = rates.with_xi * xi;
    if (s.kind == kernel::StepKind::quadric || s.kind == kernel::StepKind::asphere) {
      gamma = gamma + rates.with_nn * V(R(2)) * (at.gx * ngx + at.gy * ngy - at.w * ngz);
    }
    d.px[i] = d.px[i] - gamma * at.gx - at.gamma * ngx;
    d.py[i] = d.py[i] - gamma * at.gy - at.gamma * ngy;
    d.pz[i] = d.pz[i] + gamma * at.w - at.gamma * ngz;
    if (s.mirror) {
      d.z[i] = -d.z[i];
      d.pz[i] = -d.pz[i];
    }
  }
};

}  // namespace
}  // namespace petzval::trace_detail
