// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace petzval::detail {

/// The root of the weighted mean square, without overflow; 0 of nothing.
inline double weighted_rms(std::span<const double> errors, std::span<const double> weights) noexcept {
  double largest = 0, most = 0;
  for (const double error : errors) largest = std::fmax(largest, std::abs(error));
  for (const double weight : weights) most = std::fmax(most, weight);
  if (!(largest > 0 && most > 0)) return 0;
  if (std::isinf(largest)) return largest;
  double squares = 0, total = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double part = errors[i] / largest, weight = weights[i] / most;
    squares += weight * part * part;
    total += weight;
  }
  return largest * std::sqrt(squares / total);
}

}  // namespace petzval::detail
