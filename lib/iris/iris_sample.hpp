// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/loop_math.hpp"

/// Uniform points of an iris, one at a time, for loops over many and for IrisShape.
namespace petzval::inline v0::iris_detail {

/// A polygon as triangles between the axis and its edges or parts of them, in order from +y towards +x. Borrowed.
template <class R>
struct IrisTriangles {
  std::size_t count = 0;               ///< 0: the unit disc instead
  const R* before = nullptr;           ///< [count + 1] the part of the area in the triangles before each
  const R *x = nullptr, *y = nullptr;  ///< [count + 1] corners; the last is the first
};

// Local names: this is compiled for several instruction sets, and the linker must not take one for another.
namespace {

template <class R>
struct IrisPoint {
  R x, y;
};

/// 1 - s / (first (first + 1)) (1 - s / ((first + 2) (first + 3)) (1 - ...)), Taylor's series of sine over angle
/// (first: 2) or cosine (1), s: the square of the angle. Every second term by itself: a single sample waits half as
/// long.
template <int first, int terms, class R>
inline R turning_series(R s) noexcept {
  struct Terms {
    R of[terms + 1] = {R(1)};  // the last one is 0
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

/// The point of the unit circle after a part u of the turn from +y towards +x, for u in [0, 1]. Within 2e-7 and 1e-15.
template <class R>
inline IrisPoint<R> circle_point(R u) noexcept {
  constexpr bool single = sizeof(R) == sizeof(float);
  constexpr int sine_terms = single ? 5 : 8, cosine_terms = single ? 5 : 9;
  const R quarters = R(4) * u;
  const auto quarter = static_cast<std::int32_t>(quarters + R(0.5));
  const R angle = R(std::numbers::pi / 2) * (quarters - static_cast<R>(quarter)), square = angle * angle;
  const R sine = angle * turning_series<2, sine_terms>(square), cosine = turning_series<1, cosine_terms>(square);
  // Without branches, which nobody could predict.
  const R swapped = static_cast<R>(quarter & 1), change = swapped * (cosine - sine);
  return {static_cast<R>(1 - (quarter & 2)) * (sine + change),
          static_cast<R>(1 - ((quarter + 1) & 2)) * (cosine - change)};
}

/// A uniform point of the unit disc.
template <class R>
inline IrisPoint<R> disc_point(R u, R v) noexcept {
  const auto [x, y] = circle_point(u);
  const R way = core_detail::square_root(v);
  return {way * x, way * y};
}

/// The triangle that holds the part u of the area.
template <class R>
inline std::size_t triangle_with(const IrisTriangles<R>& t, R u) noexcept {
  std::size_t k = 0;
  while (k + 1 < t.count && u >= t.before[k + 1]) ++k;
  return k;
}

/// A uniform point of a polygon whose triangle k holds the part u of the area.
template <class R>
inline IrisPoint<R> triangle_point(const IrisTriangles<R>& t, std::size_t k, R u, R v) noexcept {
  const R along = (u - t.before[k]) / (t.before[k + 1] - t.before[k]), way = core_detail::square_root(v);
  return {way * (t.x[k] + along * (t.x[k + 1] - t.x[k])), way * (t.y[k] + along * (t.y[k + 1] - t.y[k]))};
}

/// Whether a point lies on the inner side of the outer edge of triangle k.
template <class R>
inline bool within_edge(const IrisTriangles<R>& t, std::size_t k, R x, R y) noexcept {
  return (t.x[k + 1] - t.x[k]) * (y - t.y[k]) <= (t.y[k + 1] - t.y[k]) * (x - t.x[k]);
}

}  // namespace
}  // namespace petzval::inline v0::iris_detail
