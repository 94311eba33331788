// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/version.hpp"

namespace petzval::inline v0 {

/// A ray-transfer (ABCD) matrix on (y, n u): height in mm and optical direction, n the signed index (negative while
/// light runs backwards after a mirror). Its determinant is 1.
///
/// Maps between other pairs that describe a ray have the same form, with any determinant: height and slope, or the
/// points where a ray meets two planes.
struct RayMatrix {
  double a = 1, b = 0, c = 0, d = 1;  ///< b in mm, c in 1/mm

  /// The matrix of `*this` followed by `next`.
  constexpr RayMatrix then(const RayMatrix& next) const noexcept {
    return {next.a * a + next.b * c, next.a * b + next.b * d, next.c * a + next.d * c, next.c * b + next.d * d};
  }
  constexpr RayMatrix inverse() const noexcept {
    const double determinant = a * d - b * c;
    return {d / determinant, -b / determinant, -c / determinant, a / determinant};
  }
  /// The same section on height and slope, between media of index n_in and n_out (signed).
  constexpr RayMatrix on_slopes(double n_in, double n_out) const noexcept {
    return {a, b * n_in, c / n_out, d * n_in / n_out};
  }
  /// Light power of the section: the negative of c, in 1/mm.
  constexpr double power() const noexcept { return -c; }
};

}  // namespace petzval::inline v0
