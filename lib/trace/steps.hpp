// SPDX-License-Identifier: Apache-2.0
// One surface for a bundle of rays. Included like core/lanes.hpp.
//
// Directions are scaled by the index, |p| = n, so that refraction needs no division: p' = p + gamma N, where N is half
// the gradient of the surface equation, and p N and p' N come from two independent square roots. The algebra is from
// Feder 1951 and from Spencer and Murty 1962. References: kernel::intersect and kernel::refract, against which the
// results are tested.
#pragma once

#include <limits>

#include "bundle.hpp"
#include "media.hpp"
#include "trace/sequential.hpp"

namespace petzval::trace_detail {
namespace {

/// Hit points and refraction of rays at a surface: the data that derivatives need in addition to the bundle.
template <class R>
struct Contact {
  Lanes<R> q;              ///< the distance to the surface, in units of p
  Lanes<R> px, py, pz;     ///< in front of the surface
  Lanes<R> gx, gy, w;      ///< N = (-gx, -gy, w)
  Lanes<R> nn;             ///< N N
  Lanes<R> xi, xo, gamma;  ///< p N, p' N, (xo - xi) / nn
  Lanes<R> k;
  Lanes<R> cx, cy, cz;  ///< N changes by -(cx dx, cy dy, cz dz) ...
  Lanes<R> bx, by;      ///< ... - (bx x, by y, 0) (ax x dx + ay y dy)
};

/// Follower of rays without derivatives.
struct NoTangents {
  template <class R>
  PETZVAL_INLINE void shift(int, Lanes<R>) noexcept {}
  template <class R>
  PETZVAL_INLINE void pass(const kernel::Step<R>&, const Bundle<R>&, int, const Contact<R>&) noexcept {}
  template <class R>
  PETZVAL_INLINE void watch(const Route<R>&, std::size_t, const Bundle<R>&) noexcept {}
  static constexpr bool enabled = false;
};

/// Updates the tally of vector i of a bundle.
template <class R>
PETZVAL_INLINE void book(Bundle<R>& b, int i, Mask<R> found, Mask<R> inside, Mask<R> refracted) noexcept {
  const Mask<R> hit = also(b.alive[i], found);
  const Mask<R> let_in = hit & inside;
  b.alive[i] = let_in & refracted;
  count<1>(b.tally[i], hit);
  count<1>(b.tally[i], let_in);
  count<2>(b.tally[i], b.alive[i]);
}

/// Clips at a central obscuration and the iris, which few surfaces have.
/// @param j index of the step
template <class R>
void clip(const kernel::Step<R>& s, std::span<const kernel::StopEdge<R>> iris, std::size_t j, Bundle<R>& b) noexcept {
  using V = Lanes<R>;
  using Bits = typename Native<R>::Bits;
  for (int i = 0; i < b.used; ++i) {
    const Mask<R> open = (b.r2[i] >= V(s.obscuration2)) & kernel::within(iris, b.x[i], b.y[i]);
    b.alive[i] = b.alive[i] & open;
    const auto rim = static_cast<typename Native<R>::Bit>(4 * j + 1);  // the tally of a ray that hit and was clipped
    Bits clipped = Bits{} + rim;
    keep(clipped, open, b.tally[i]);
    b.tally[i] = b.tally[i] > rim ? clipped : b.tally[i];
  }
}

template <class R, class Media, class Follow>
PETZVAL_ONE_LANE_INLINE void plane(const kernel::Step<R>& s, const Lanes<R>& rim2, const Media& media, Bundle<R>& b,
                                   Follow& follow) noexcept {
  using V = Lanes<R>;
  PETZVAL_UNROLL
  for (int i = 0; i < b.used; ++i) {
    const V pz = b.pz[i];
    const V q = (V(s.gap) - b.z[i]) / pz;
    b.x[i] = b.x[i] + q * b.px[i];
    b.y[i] = b.y[i] + q * b.py[i];
    b.z[i] = V(R(0));
    b.r2[i] = b.x[i] * b.x[i] + b.y[i] * b.y[i];
    const Mask<R> found = pz > V(R(0));
    const V k = media.k(i);
    const V squared = pz * pz + k;
    if (s.bends) b.pz[i] = root(squared);
    book(b, i, found, b.r2[i] <= rim2, has_root(squared));
    const V none(R(0));
    follow.pass(s, b, i,
                {q, b.px[i], b.py[i], pz, none, none, V(R(1)), V(R(1)), pz, b.pz[i], b.pz[i] - pz, k, none, none, none,
                 none, none});
  }
}

/// Moves rays close to the vertex, so that the quadratic loses no digits: into the vertex plane, or to the nearest
/// point if they are steep or travel backwards.
template <class R, class Media, class Follow>
PETZVAL_INLINE void approach(const kernel::Step<R>& s, const Media& media, Bundle<R>& b, int i,
                             Follow& follow) noexcept {
  using V = Lanes<R>;
  const V px = b.px[i], py = b.py[i], pz = b.pz[i], z = b.z[i] - V(s.gap);
  const Mask<R> upright = pz * kernel::absolute(pz) * media.per_n2(i) > V(R(0.09));
  const V across = V(s.ax) * px * px + V(s.ay) * py * py + pz * pz;
  const V along = V(s.ax) * b.x[i] * px + V(s.ay) * b.y[i] * py + z * pz;
  const V t = -select(upright, z, along) / select(upright, pz, across);
  b.x[i] = b.x[i] + t * px;
  b.y[i] = b.y[i] + t * py;
  b.z[i] = select(upright, V(R(0)), z + t * pz);
  b.r2[i] = b.x[i] * b.x[i] + b.y[i] * b.y[i];
  follow.shift(i, t);
}

/// Number of vectors that are processed together. Some of them may hold no rays, because separate code for fewer
/// vectors would round differently.
#if defined(__AVX2__) && !defined(__AVX512F__)
inline constexpr int most_together = 4;
#else
inline constexpr int most_together = 2;
#endif
template <class R>
inline constexpr int vectors_together = Bundle<R>::vectors < most_together ? Bundle<R>::vectors : most_together;

/// Refracts vectors from `first` on at a sphere. The stages of the vectors are interleaved to hide the
/// latency of square roots.
template <bool far, class R, class Media, class Follow>
PETZVAL_INLINE void sphere(const kernel::Step<R>& s, const Lanes<R>& rim2, const Media& media, Bundle<R>& b, int first,
                           Follow& follow) noexcept {
  using V = Lanes<R>;
  constexpr int together = vectors_together<R>;
  const V c(s.curvature), one(R(1)), none(R(0));
  V z[together], f[together], slant[together], cn2[together], k[together], d[together], d_out[together];
  V xi[together], xo[together], q[together];
  for (int m = 0, i = first; m < together; ++m, ++i) {
    if constexpr (far) approach(s, media, b, i, follow);
    z[m] = far ? b.z[i] : b.z[i] - V(s.gap);
    cn2[m] = media.cn2(i);
    k[m] = media.k(i);
    f[m] = c * (b.r2[i] + z[m] * z[m]) - (z[m] + z[m]);
    slant[m] = b.pz[i] - c * (b.x[i] * b.px[i] + b.y[i] * b.py[i] + z[m] * b.pz[i]);
  }
  for (int m = 0; m < together; ++m) {
    d[m] = slant[m] * slant[m] - cn2[m] * f[m];
    d_out[m] = d[m] + k[m];
  }
  for (int m = 0; m < together; ++m) xi[m] = root(d[m]);
  for (int m = 0; m < together; ++m) {
    if constexpr (far) {  // beyond 90 degrees use the other form of the same root
      const Mask<R> facing = slant[m] >= none;
      q[m] = select(facing, f[m], slant[m] - xi[m]) / select(facing, slant[m] + xi[m], cn2[m]);
    } else {
      q[m] = f[m] / (slant[m] + xi[m]);
    }
  }
  for (int m = 0; m < together; ++m) xo[m] = second_root(d_out[m]);
  for (int m = 0, i = first; m < together; ++m, ++i) {
    const V px = b.px[i], py = b.py[i], pz = b.pz[i];
    b.x[i] = b.x[i] + q[m] * px;
    b.y[i] = b.y[i] + q[m] * py;
    b.z[i] = z[m] + q[m] * pz;
    b.r2[i] = b.x[i] * b.x[i] + b.y[i] * b.y[i];

    const V w = one - c * b.z[i];
    const V gamma = xo[m] - xi[m];
    const V bend = gamma * c;
    b.px[i] = px - bend * b.x[i];
    b.py[i] = py - bend * b.y[i];
    b.pz[i] = pz + gamma * w;
    book(b, i, w > none, b.r2[i] <= rim2, has_root(d_out[m]));
    if constexpr (Follow::enabled) {
      follow.pass(s, b, i,
                  {q[m], px, py, pz, c * b.x[i], c * b.y[i], w, one, xi[m], xo[m], gamma, k[m], c, c, c, none, none});
    }
  }
}

/// Refracting sphere.
template <bool far, class R, class Media, class Follow>
PETZVAL_ONE_LANE_INLINE void sphere(const kernel::Step<R>& s, const Lanes<R>& rim2, const Media& media, Bundle<R>& b,
                                    Follow& follow) noexcept {
  for (int i = 0; i < b.used; i += vectors_together<R>) sphere<far>(s, rim2, media, b, i, follow);
}

/// Reverses the frame behind a mirror.
template <class R>
PETZVAL_INLINE void turn(Bundle<R>& b, int i) noexcept {
  b.z[i] = -b.z[i];
  b.pz[i] = -b.pz[i];
}

/// Refracts or reflects at points with known N, and updates tally and follower.
template <class R, class Media, class Follow>
PETZVAL_INLINE void bend(const kernel::Step<R>& s, const Lanes<R>& rim2, const Media& media, Bundle<R>& b, int i,
                         Mask<R> found, Contact<R> at, Follow& follow) noexcept {
  using V = Lanes<R>;
  b.r2[i] = b.x[i] * b.x[i] + b.y[i] * b.y[i];
  at.nn = at.gx * at.gx + at.gy * at.gy + at.w * at.w;
  at.k = s.mirror ? V(R(0)) : media.k(i);
  const V d_out = at.xi * at.xi + at.k * at.nn;
  at.xo = s.mirror ? -at.xi : second_root(d_out);
  at.gamma = (at.xo - at.xi) / at.nn;
  b.px[i] = at.px - at.gamma * at.gx;
  b.py[i] = at.py - at.gamma * at.gy;
  b.pz[i] = at.pz + at.gamma * at.w;
  book(b, i, found, b.r2[i] <= rim2, has_root(d_out));
  follow.pass(s, b, i, at);
  if (s.mirror) turn(b, i);
}

/// The quadratic for q, the distance to a quadric in units of p: a q^2 - 2 slant q + f = 0.
template <class R>
struct Quadratic {
  Lanes<R> a, slant, f;
};

template <class R>
PETZVAL_INLINE Quadratic<R> quadratic(const kernel::Step<R>& s, const Bundle<R>& b, int i) noexcept {
  using V = Lanes<R>;
  const V c(s.curvature), ax(s.ax), ay(s.ay), e(s.e);
  const V x = b.x[i], y = b.y[i], z = b.z[i], px = b.px[i], py = b.py[i], pz = b.pz[i];
  return {c * (ax * px * px + ay * py * py + e * pz * pz), pz - c * (ax * x * px + ay * y * py + e * z * pz),
          c * (ax * x * x + ay * y * y + e * z * z) - (z + z)};
}

/// Conics, cylinders and all mirrors.
template <class R, class Media, class Follow>
void quadric(const kernel::Step<R>& s, const Lanes<R>& rim2, const Media& media, Bundle<R>& b,
             Follow& follow) noexcept {
  using V = Lanes<R>;
  const V c(s.curvature), ax(s.ax), ay(s.ay), e(s.e);
  for (int i = 0; i < b.used; ++i) {
    approach(s, media, b, i, follow);
    const V px = b.px[i], py = b.py[i], pz = b.pz[i];
    const auto [a, slant, f] = quadratic(s, b, i);
    const V xi = root(slant * slant - a * f);
    const Mask<R> facing = slant >= V(R(0));
    const V q = select(facing, f, slant - xi) / select(facing, slant + xi, a);
    b.x[i] = b.x[i] + q * px;
    b.y[i] = b.y[i] + q * py;
    b.z[i] = b.z[i] + q * pz;
    const V w = V(R(1)) - c * e * b.z[i];
    const V none(R(0));
    const Mask<R> found = (w > none) & (kernel::absolute(q) <= V(std::numeric_limits<R>::max()));
    bend(s, rim2, media, b, i, found,
         {q, px, py, pz, c * ax * b.x[i], c * ay * b.y[i], w, none, xi, none, none, none, c * ax, c * ay, c * e, none,
          none},
         follow);
  }
}

}  // namespace
}  // namespace petzval::trace_detail
