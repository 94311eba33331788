// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>

#include "lens/quadric.hpp"

namespace petzval::kernel {

inline constexpr int max_asphere_order = 40;

/// Bounds of the shape of an asphere over a ring between two radii, rounded outwards.
template <class R>
struct AsphereRing {
  R inner2, outer2;         ///< squared radii; outer2 of the last ring is the largest number
  R outer;                  ///< outer radius
  R lowest, highest;        ///< bounds of the sag
  R least_bend, most_bend;  ///< bounds of (dz/dr) / r
};

/// Number of rings. Rings have equal areas, so that they are narrower towards the edge, where high orders matter.
inline constexpr int asphere_rings = 16;

/// A quadric with a polynomial in r added to its sag. r is measured in the curved section.
///
/// The polynomial is stored as a function of rho = r / height, with coefficients a_i height^i: raw coefficients such as
/// 1e-41 mm^-13 are denormal in float, and r^16 is outside the range of float unless r is between about 10^-2.4 and
/// 10^2.4 mm.
template <class R>
struct Asphere {
  Quadric<R> base;
  R height = 1;  ///< described up to this height: the clear semi-diameter, or less if the surface is too steep
  R rim2 = std::numeric_limits<R>::infinity();  ///< height^2 if there is a rim, which vignettes rays
  int even_count = 0, odd_count = 0;
  std::array<R, max_asphere_order / 2> even{};  ///< coefficients of rho^2, rho^4, ...
  std::array<R, max_asphere_order / 2> odd{};   ///< coefficients of rho^3, rho^5, ...
  R lowest = 0, highest = 0;                    ///< bounds of the sag up to the height
  R steepest = 0;                               ///< bound of |dz/dr| up to the height
  R edge = 0;                                   ///< sag at the height
  std::array<AsphereRing<R>, asphere_rings> rings{};
};

/// Sag and slope of an asphere at a squared distance from the axis: z = sag, dz/dx = ax x slope, dz/dy = ay y slope.
template <class T>
struct Sag {
  T z, slope;
  Mask<T> defined;  ///< false beyond the equator of the base conic
};

template <class T>
[[gnu::always_inline]] inline Sag<T> sag(const Asphere<Storage<T>>& s, const T& r2) noexcept {
  using R = Storage<T>;
  const R c = s.base.curvature;
  const T inside = R(1) - s.base.e * c * c * r2;
  const auto defined = inside > R(0);
  const T root = safe_sqrt(inside);
  // z = c r2 / (1 + root) and slope = c / root with one division.
  const T sum = R(1) + root;
  const T conic_factor = quotient(T(c), select(defined, T(root * sum), sum));
  const T conic_sag = conic_factor * (r2 * root);
  const T conic_slope = conic_factor * sum;

  const R per_height_squared = R(1) / (s.height * s.height);
  const T u = r2 * per_height_squared;  // rho^2
  T even(R(0)), even_derivative(R(0));
  for (int i = s.even_count - 1; i >= 0; --i) {
    even_derivative = even_derivative * u + even;
    even = even * u + T(s.even[i]);
  }
  even_derivative = even_derivative * u + even;  // d(u even) / du
  even = even * u;

  T odd(R(0)), odd_slope(R(0));
  if (s.odd_count > 0) {
    T q(R(0)), q_derivative(R(0));
    for (int i = s.odd_count - 1; i >= 0; --i) {
      q_derivative = q_derivative * u + q;
      q = q * u + T(s.odd[i]);
    }
    const T rho = safe_sqrt(u);
    odd = u * rho * q;
    odd_slope = rho * (R(1.5) * q + u * q_derivative);  // d(rho^3 q) / du
  }
  return {conic_sag + even + odd, conic_slope + R(2) * per_height_squared * (even_derivative + odd_slope), defined};
}

template <class T>
Vec<T> normal(const Asphere<Storage<T>>& s, const Vec<T>& point) noexcept {
  using R = Storage<T>;
  using std::sqrt;
  const T x = s.base.ax * point.x, y = s.base.ay * point.y;
  const T slope = sag(s, T(x * x + y * y)).slope;
  const Vec<T> n{T(-slope * x), T(-slope * y), T(R(1))};
  return n * T(R(1) / sqrt(dot(n, n)));
}

}  // namespace petzval::kernel
