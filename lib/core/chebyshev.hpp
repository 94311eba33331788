// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace petzval::core_detail {

/// Coefficients of the Chebyshev polynomials T_0 to T_(n-1) of the polynomial that equals value(x) at the n zeros of
/// T_n, which lie in -1 to 1.
template <std::size_t n, class Value>
std::array<double, n> chebyshev_series(const Value& value) {
  std::array<double, n> series{};
  for (std::size_t j = 0; j < n; ++j) {
    const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / n, f = value(std::cos(angle));
    for (std::size_t k = 0; k < n; ++k) {
      series[k] += (k == 0 ? 1.0 : 2.0) / n * f * std::cos(static_cast<double>(k) * angle);
    }
  }
  return series;
}

/// The first terms of a series in x = factor z + shift, as coefficients of the powers of z.
template <std::size_t n>
std::array<double, n> by_powers(const std::array<double, n>& series, std::size_t terms = n, double factor = 1,
                                double shift = 0) {
  std::array<double, n> powers{}, before{}, own{1};  // own: T_k in powers of z
  for (std::size_t k = 0; k < terms; ++k) {
    std::array<double, n> next{};  // T_(k+1) = 2 x T_k - T_(k-1)
    for (std::size_t i = 0; i < terms; ++i) {
      powers[i] += series[k] * own[i];
      next[i] = (k == 0 ? 1 : 2) * (shift * own[i] + (i > 0 ? factor * own[i - 1] : 0)) - before[i];
    }
    before = own, own = next;
  }
  return powers;
}

}  // namespace petzval::core_detail
