// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/scalar.hpp"
#include "core/simd.hpp"

/// Uniform points of an iris, one at a time. Used by loops over many samples and by IrisShape.
namespace petzval::iris_detail {

/// Number of terms in the polynomials of an edge: accurate to 1e-7 semi-diameters in float and 2e-13 in double.
template <class R>
inline constexpr std::size_t edge_terms = sizeof(R) == sizeof(float) ? 8 : 17;

/// Squared radius of the rim, with a tolerance for rounding at the corners. It is needed for edges that are bent
/// inwards: they are circles, and points on the far side of a circle also satisfy the condition of the edge.
template <class R>
inline constexpr R rim_squared = 1 + 8 * std::numeric_limits<R>::epsilon();

/// The sectors of a bladed iris in order from +y towards +x, each between the centre and a blade's edge. Arrays are
/// borrowed.
template <class R>
struct IrisSectors {
  std::size_t count = 0;     ///< 0 for the unit disc
  const R* turns = nullptr;  ///< [count] sine and cosine of the angle from +y towards +x to the middle of the edge
  /// Edge points, in a frame across and along the direction to the middle of the edge. If the fraction (1 + q) / 2 of
  /// the area of the sector lies before a point, its coordinates are (q across(2 q^2 - 1), along(2 q^2 - 1)).
  /// Coefficients by ascending power, [edge_terms].
  const R *across = nullptr, *along = nullptr;
  const R* edges = nullptr;  ///< [count] the four members of each IrisEdge
};

// Anonymous namespace: the code is compiled for several instruction sets, and the linker must not merge the versions.
namespace {

template <class V>
struct IrisPoint {
  V x, y;
};

/// Taylor series of sin(a) / a (first = 2) or cos(a) (first = 1) in s = a^2:
///     1 - s / (first (first + 1)) (1 - s / ((first + 2) (first + 3)) (1 - ...)).
/// Even and odd terms are summed separately, which halves the latency of a single sample.
template <int first, int terms, class V>
PETZVAL_INLINE V turning_series(const V& s) noexcept {
  using R = kernel::Storage<V>;
  struct Terms {
    R of[terms + 1] = {R(1)};  // the last term is 0
    constexpr Terms() {
      double c = 1;
      for (int k = 1; k < terms; ++k) of[k] = static_cast<R>(c /= -(first + 2. * k - 2) * (first + 2. * k - 1));
    }
  };
  constexpr Terms term;
  constexpr int last = (terms - 1) / 2 * 2;
  const V s2 = s * s;
  V even(term.of[last]), odd(term.of[last + 1]);
  for (int k = last - 2; k >= 0; k -= 2) {
    even = even * s2 + V(term.of[k]);
    odd = odd * s2 + V(term.of[k + 1]);
  }
  return even + s * odd;
}

/// The point of the unit circle at the fraction u of a turn from +y towards +x, u in [0, 1]. Accurate to 2e-7 in float
/// and 1e-15 in double.
template <class V>
PETZVAL_INLINE IrisPoint<V> circle_point(const V& u) noexcept {
  using Table = kernel::Table<V>;
  using R = kernel::Storage<V>;
  constexpr bool single = sizeof(R) == sizeof(float);
  constexpr int sine_terms = single ? 5 : 8, cosine_terms = single ? 5 : 9;
  const V quarters = V(R(4)) * u;
  const auto quarter = Table::whole(V(quarters + V(R(0.5))));
  const V angle = V(R(std::numbers::pi / 2)) * (quarters - Table::number(quarter)), square = angle * angle;
  const V sine = angle * turning_series<2, sine_terms>(square), cosine = turning_series<1, cosine_terms>(square);
  // Branch-free, because a branch on a random quarter is mispredicted.
  const V change = Table::number(quarter & 1) * (cosine - sine), one(R(1));
  return {(one - Table::number(quarter & 2)) * (sine + change),
          (one - Table::number((quarter + 1) & 2)) * (cosine - change)};
}

/// A uniform point of the iris for u and v in [0, 1].
template <class V, class R>
PETZVAL_INLINE IrisPoint<V> iris_point(const IrisSectors<R>& s, const V& u, const V& v) noexcept {
  using Table = kernel::Table<V>;
  using kernel::select, std::sqrt;
  const V radius = sqrt(v);
  if (s.count == 0) {
    const IrisPoint<V> p = circle_point(u);
    return {radius * p.x, radius * p.y};
  }
  const auto count = static_cast<R>(static_cast<std::int32_t>(s.count));
  const V at = u * V(count), last(count - R(1));
  const auto k = Table::whole(select(at < last, at, last));
  const V q = V(R(2)) * (at - Table::number(k)) - V(R(1)), t = V(R(2)) * q * q - V(R(1));
  V across(s.across[edge_terms<R> - 1]), along(s.along[edge_terms<R> - 1]);
  for (std::size_t i = edge_terms<R> - 1; i-- > 0;) {
    across = V(s.across[i]) + t * across;
    along = V(s.along[i]) + t * along;
  }
  across = across * q;
  const auto turns = Table::template rows<2>(s.turns, k * 2);
  return {radius * (along * turns[0] + across * turns[1]), radius * (along * turns[1] - across * turns[0])};
}

/// True if the point lies on the open side of the edge of blade k.
template <class V, class R>
PETZVAL_INLINE kernel::Mask<V> within_edge(const IrisSectors<R>& s, std::size_t k, const V& x, const V& y) noexcept {
  const R* edge = s.edges + 4 * k;
  return x * V(edge[0]) + y * V(edge[1]) + V(edge[2]) * (x * x + y * y) <= V(edge[3]);
}

}  // namespace
}  // namespace petzval::iris_detail
