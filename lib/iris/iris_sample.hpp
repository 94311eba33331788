// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/loop_math.hpp"

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

template <class R>
struct IrisPoint {
  R x, y;
};

/// Taylor series of sin(a) / a (first = 2) or cos(a) (first = 1) in s = a^2:
///     1 - s / (first (first + 1)) (1 - s / ((first + 2) (first + 3)) (1 - ...)).
/// Even and odd terms are summed separately, which halves the latency of a single sample.
template <int first, int terms, class R>
inline R turning_series(R s) noexcept {
  struct Terms {
    R of[terms + 1] = {R(1)};  // the last term is 0
    constexpr Terms() {
      double c = 1;
      for (int k = 1; k < terms; ++k) of[k] = static_cast<R>(c /= -(first + 2. * k - 2) * (first + 2. * k - 1));
    }
  };
  constexpr Terms term;
  constexpr int last = (terms - 1) / 2 * 2;
  const R s2 = s * s;
  R even = term.of[last], odd = term.of[last + 1];
  for (int k = last - 2; k >= 0; k -= 2) {
    even = even * s2 + term.of[k];
    odd = odd * s2 + term.of[k + 1];
  }
  return even + s * odd;
}

/// The point of the unit circle at the fraction u of a turn from +y towards +x, u in [0, 1]. Accurate to 2e-7 in float
/// and 1e-15 in double.
template <class R>
inline IrisPoint<R> circle_point(R u) noexcept {
  constexpr bool single = sizeof(R) == sizeof(float);
  constexpr int sine_terms = single ? 5 : 8, cosine_terms = single ? 5 : 9;
  const R quarters = R(4) * u;
  const auto quarter = static_cast<std::int32_t>(quarters + R(0.5));
  const R angle = R(std::numbers::pi / 2) * (quarters - static_cast<R>(quarter)), square = angle * angle;
  const R sine = angle * turning_series<2, sine_terms>(square), cosine = turning_series<1, cosine_terms>(square);
  // Branch-free, because a branch on a random quarter is mispredicted.
  const R swapped = static_cast<R>(quarter & 1), change = swapped * (cosine - sine);
  return {static_cast<R>(1 - (quarter & 2)) * (sine + change),
          static_cast<R>(1 - ((quarter + 1) & 2)) * (cosine - change)};
}

template <class R>
inline IrisPoint<R> disc_point(R u, R v) noexcept {
  const auto [x, y] = circle_point(u);
  const R radius = core_detail::square_root(v);
  return {radius * x, radius * y};
}

template <class R>
inline IrisPoint<R> sector_point(const IrisSectors<R>& s, R u, R v) noexcept {
  const R at = u * static_cast<R>(static_cast<std::int32_t>(s.count));
  const auto whole = static_cast<std::int32_t>(at), last = static_cast<std::int32_t>(s.count) - 1;
  const std::int32_t k = whole < last ? whole : last;
  const R q = R(2) * (at - static_cast<R>(k)) - R(1), t = R(2) * q * q - R(1);
  R across = s.across[edge_terms<R> - 1], along = s.along[edge_terms<R> - 1];
  for (std::size_t i = edge_terms<R> - 1; i-- > 0;) {
    across = s.across[i] + t * across;
    along = s.along[i] + t * along;
  }
  const R radius = core_detail::square_root(v), sine = s.turns[2 * k], cosine = s.turns[2 * k + 1];
  across *= q;
  return {radius * (along * sine + across * cosine), radius * (along * cosine - across * sine)};
}

/// True if the point lies on the open side of the edge of blade k.
template <class R>
inline bool within_edge(const IrisSectors<R>& s, std::size_t k, R x, R y) noexcept {
  const R* edge = s.edges + 4 * k;
  return x * edge[0] + y * edge[1] + edge[2] * (x * x + y * y) <= edge[3];
}

}  // namespace
}  // namespace petzval::iris_detail
