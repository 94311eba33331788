// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"

namespace petzval::focus_detail {

/// A number over time, through keys: a piecewise cubic with a continuous derivative that never leaves the span of the
/// two keys about it. Constant before the first key and after the last; the derivative is 0 there.
///
/// The slope at a key is the weighted harmonic mean of the slopes on both sides, and 0 if they differ in sign or at the
/// ends. Source: Brodlie's formula in Fritsch and Butland 1984, "A method for constructing local monotone piecewise
/// cubic interpolants".
class PETZVAL_API Keyframes {
 public:
  /// times: s, strictly increasing. values: as many. Throws Error for empty lists, numbers that are not finite, and
  /// keys between which differences or slopes overflow.
  Keyframes(std::vector<double> times, std::vector<double> values);
  /// Exact at keys. NaN for NaN.
  double at(double time) const noexcept;

 private:
  std::vector<double> times_, values_, slopes_;
};

}  // namespace petzval::focus_detail
