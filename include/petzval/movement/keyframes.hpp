// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// A number over time, through keys: a piecewise cubic with a continuous derivative that never leaves the span of the
/// two keys about it. Constant before the first key and after the last, where it comes to rest smoothly too.
///
/// Slopes at keys are the weighted harmonic means of those on both sides, 0 where these differ in sign and at the ends.
/// Source: Brodlie's formula in Fritsch and Butland 1984, "A method for constructing local monotone piecewise cubic
/// interpolants".
class PETZVAL_API Keyframes {
 public:
  /// times: s, strictly increasing; as many values; at least one. Throws Error for none, numbers that are not finite,
  /// and keys so close or so far apart that differences or slopes between them overflow.
  Keyframes(std::vector<double> times, std::vector<double> values);
  /// Exact at keys. NaN at NaN.
  double at(double time) const noexcept;

 private:
  std::vector<double> times_, values_, slopes_;
};

}  // namespace petzval::inline v0
