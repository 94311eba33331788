// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "petzval/movement/focus_target.hpp"

namespace petzval::inline v0::movement_detail {

/// The root of the weighted mean square of blur less wanted over the targets used, without overflow; 0 without any.
inline double rms_error(std::span<const FocusTarget> targets, std::span<const TargetBlur> blurs) noexcept {
  const auto error = [&](std::size_t i) {
    return blurs[i].use == TargetUse::used ? blurs[i].blur_mm - blurs[i].wanted_mm : 0;
  };
  const auto weight = [&](std::size_t i) { return blurs[i].use == TargetUse::used ? targets[i].weight : 0; };
  double largest = 0, most = 0;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    largest = std::fmax(largest, std::abs(error(i)));
    most = std::fmax(most, weight(i));
  }
  if (!(largest > 0 && most > 0)) return 0;
  if (std::isinf(largest)) return largest;
  double squares = 0, total = 0;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    const double part = error(i) / largest, share = weight(i) / most;
    squares += share * part * part;
    total += share;
  }
  return largest * std::sqrt(squares / total);
}

}  // namespace petzval::inline v0::movement_detail
