// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "petzval/camera/bokeh.hpp"

namespace petzval::camera_detail {

/// A cubic spline as a sum of powers that start at its knots, which needs no search and no branch:
///
///     k(t) = first + square (t - t_0)^2 + sum_j cube_j max(0, t - t_j)^3.
template <class T>
struct PowerSpline {
  static constexpr std::size_t most_knots = 32;

  std::size_t knots = 0;  ///< k is 1 if there are 0 knots
  T first = 1, square = 0;
  std::array<T, most_knots> at{}, cube{};
};

/// Spline through knots, with slope 0 at the first and curvature 0 at the last; without knots k is 1.
/// @throws Error  prefixed with `where` if there are too many knots, radii do not grow from 0 to 1, or powers exceed
/// 1000
PowerSpline<double> power_spline(const std::string& where, const std::vector<PowerKnot>& knots);

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

/// The terms of the sum k(t) - 1: t limited to the knots, the terms that start at the first knot, and the cubic term of
/// knot j, which must not be the last knot.
template <class T, class N>
inline N within_knots(const PowerSpline<T>& spline, N t) noexcept {
  const T first = spline.at[0], last = spline.at[spline.knots - 1];
  t = t < first ? N(first) : t;
  return last < t ? N(last) : t;
}
template <class T, class N>
inline N beyond_one_at_first(const PowerSpline<T>& spline, N t) noexcept {
  const N from_first = t - spline.at[0];
  return from_first * from_first * spline.square + (spline.first - T(1));
}
template <class T, class N>
inline N of_knot(const PowerSpline<T>& spline, std::size_t j, N t) noexcept {
  const N over = t - spline.at[j];
  return (over < T(0) ? N(T(0)) : N(over * over * over)) * spline.cube[j];
}

/// k(t) - 1, constant outside the knots. N: T or a dual number over T.
template <class T, class N>
inline N beyond_one(const PowerSpline<T>& spline, N t) noexcept {
  if (spline.knots == 0) return N(T(0));
  t = within_knots(spline, t);
  N sum = beyond_one_at_first(spline, t);
  for (std::size_t j = 0; j + 1 < spline.knots; ++j) sum += of_knot(spline, j, t);
  return sum;
}

}  // namespace
}  // namespace petzval::camera_detail
