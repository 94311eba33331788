// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace petzval::inline v0::camera_detail {

/// A cubic spline as a sum of powers that begin at its knots, so that lanes need no search and no branch:
///
///     k(t) = first + square (t - t_0)^2 + sum_j cube_j max(0, t - t_j)^3.
template <class T>
struct PowerSpline {
  static constexpr std::size_t most_knots = 32;

  std::size_t knots = 0;  ///< 0: k is 1
  T first = 1, square = 0;
  std::array<T, most_knots> at{}, cube{};
};

// Local names: this is compiled for several instruction sets, and the linker must not take one for another.
namespace {

/// k(t) - 1, constant outside the knots. N: T, or a dual number over it.
template <class T, class N>
inline N beyond_one(const PowerSpline<T>& spline, N t) noexcept {
  const std::size_t knots = spline.knots;
  if (knots == 0) return N(T(0));
  const T first = spline.at[0], last = spline.at[knots - 1];
  t = t < first ? N(first) : t;
  t = last < t ? N(last) : t;
  const N from_first = t - first;
  N sum = from_first * from_first * spline.square + (spline.first - T(1));
  for (std::size_t j = 0; j + 1 < knots; ++j) {
    const N over = t - spline.at[j];
    sum += (over < T(0) ? N(T(0)) : N(over * over * over)) * spline.cube[j];
  }
  return sum;
}

}  // namespace
}  // namespace petzval::inline v0::camera_detail
