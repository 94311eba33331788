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

/// The point of the unit circle after a part u of the turn from +y towards +x, for u in [0, 1]. Within 2e-7 and 1e-15.
template <class R>
inline IrisPoint<R> circle_point(R u) noexcept {
  constexpr bool single = sizeof(R) == sizeof(float);
  constexpr int sine_terms = single ? 5 : 8, cosine_terms = single ? 5 : 9;
  const R quarters = R(4) * u;
  const auto quarter = static_cast<std::int32_t>(quarters + R(0.5));
  const R angle = R(std::numbers::pi / 2) * (quarters - static_cast<R>(quarter)), square = angle * angle;
  // Taylor's series, within an eighth of a turn.
  R sine = R(1), cosine = R(1);
  for (int k = sine_terms - 1; k > 0; --k) sine = R(1) - square * R(1. / (2 * k * (2 * k + 1))) * sine;
  for (int k = cosine_terms - 1; k > 0; --k) cosine = R(1) - square * R(1. / (2 * k * (2 * k - 1))) * cosine;
  sine *= angle;
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
