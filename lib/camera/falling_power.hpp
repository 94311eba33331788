// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "moving_least_squares_loops.hpp"

namespace petzval::camera_detail {
namespace {

/// base^exponent for base in [0, 1], by binary logarithm and exponential, because std::pow differs between processors.
/// Results below the normal numbers become 0. Relative error: a few roundings times 1 + |exponent log2 base|.
inline double power(double base, double exponent) noexcept {
  constexpr double ln2 = 0.693147180559945309417;
  constexpr std::int64_t root_half = 0x3fe6a09e667f3bcd;  // the bits of 0.70710678
  // base = 2^whole * fraction, with a fraction close to 1.
  const auto bits = __builtin_bit_cast(std::int64_t, base);
  const std::int64_t whole = (bits - root_half) >> 52;
  const auto fraction = __builtin_bit_cast(double, bits - (whole << 52));
  const double s = (fraction - 1) / (fraction + 1), s2 = s * s;
  double series = 1.0 / 19;
  for (int k = 8; k >= 0; --k) series = series * s2 + 1.0 / (2 * k + 1);
  const double log2_result = (static_cast<double>(whole) + s * series * (2 / ln2)) * exponent;
  if (!(log2_result >= -1021 && base >= 2.3e-308)) return 0;
  constexpr double rounding = 1.5 * 4503599627370496.0;  // adding 1.5 * 2^52 rounds to the nearest whole number
  const double shifted = log2_result + rounding, rest = (log2_result - (shifted - rounding)) * ln2;
  double result = 1;
  for (int k = 13; k >= 1; --k) result = result * rest * (1.0 / k) + 1;
  const std::int64_t steps = (__builtin_bit_cast(std::int64_t, shifted) - __builtin_bit_cast(std::int64_t, rounding))
                             << 52;
  return __builtin_bit_cast(double, __builtin_bit_cast(std::int64_t, result) + steps);
}

/// ratio^exponent for ratios in [0, 1]: a double, or lanes of double.
template <class V>
inline V falling(const FallingPower& by, V ratio) noexcept {
  using std::sqrt;
  if (by.wholes < 0) {
    if constexpr (requires { ratio.v; }) {
      for (int l = 0; l < V::width; ++l) ratio.v[l] = power(ratio.v[l], by.exponent);
      return ratio;
    } else {
      return power(ratio, by.exponent);
    }
  }
  V result = by.half ? sqrt(ratio) : ratio;
  for (int k = by.half ? 0 : 1; k < by.wholes; ++k) result = result * ratio;
  return result;
}

}  // namespace
}  // namespace petzval::camera_detail
