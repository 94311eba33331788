// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/config.hpp"

namespace petzval::focus_detail {

/// A number over time: a piecewise cubic through keys, with a continuous derivative, that stays between the values of
/// adjacent keys. It is constant before the first key and after the last key; the derivative at these two keys is 0.
///
/// The slope at any other key is the weighted harmonic mean of the slopes on both sides, and 0 if they differ in sign.
/// Source: Brodlie's formula in Fritsch and Butland 1984, "A method for constructing local monotone piecewise cubic
/// interpolants".
class PETZVAL_API Keyframes {
 public:
  /// @param times strictly increasing (s)
  /// @param values one for each time
  /// @throws Error if the lists are empty or differ in length, a number is not finite, or a difference or slope between
  ///   keys overflows
  Keyframes(std::vector<double> times, std::vector<double> values);
  /// Exact at keys; NaN for NaN.
  double at(double time) const noexcept;

 private:
  std::vector<double> times_, values_, slopes_;
};

}  // namespace petzval::focus_detail
