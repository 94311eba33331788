// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace petzval::core_detail {

/// The last parameter with a property, by bisection down to neighbouring doubles.
/// Requires that `with` has the property and that `without` lacks it.
template <class Property>
double last_with(double with, double without, const Property& property) {
  for (;;) {
    const double middle = with + (without - with) / 2;
    if (middle == with || middle == without) return with;
    (property(middle) ? with : without) = middle;
  }
}

/// Searches for the last parameter, within `tolerance`, at which a function is not negative. Evaluate the function at
/// next() and pass the value to take(), until done(). Several searches can run alternately. Superlinear if the function
/// is smooth; at most one evaluation more than bisection if it jumps.
/// Source: Oliveira and Takahashi 2020, "An enhancement of the bisection method average performance preserving minmax
/// optimality" (ITP, kappa1 = 0.2 / interval, kappa2 = 2, n0 = 1).
class LastAbove {
 public:
  /// @param above, at_above a parameter and its value, which is >= 0
  /// @param below, at_below a parameter and its value, which is negative
  LastAbove(double above, double at_above, double below, double at_below, double tolerance) noexcept
      : above_(above),
        at_above_(at_above),
        below_(below),
        at_below_(at_below),
        tolerance_(tolerance),
        first_(std::abs(below - above)) {
    reach_ = tolerance * std::exp2(std::ceil(std::log2(std::max(first_ / tolerance, 1.0))) + 1) / 2;
    choose();
  }

  bool done() const noexcept { return done_; }
  double next() const noexcept { return next_; }
  void take(double value) noexcept {
    if (value >= 0) {
      above_ = next_, at_above_ = value;
    } else {
      below_ = next_, at_below_ = value;
    }
    reach_ /= 2;
    choose();
  }

  /// The ends of the remaining interval.
  double above() const noexcept { return above_; }
  double below() const noexcept { return below_; }

 private:
  void choose() noexcept {
    const double width = std::abs(below_ - above_);
    const double middle = above_ + (below_ - above_) / 2;
    const double radius = reach_ - width / 2;
    const double falsi = above_ + (below_ - above_) * (at_above_ / (at_above_ - at_below_));
    const double towards = falsi < middle ? 1 : -1;  // from the secant to the middle
    const double truncation = 0.2 * (below_ - above_) * (below_ - above_) / first_;
    const double truncated = std::abs(middle - falsi) > truncation ? falsi + towards * truncation : middle;
    next_ = std::abs(truncated - middle) <= radius ? truncated : middle - towards * radius;
    if (!(next_ > std::min(above_, below_) && next_ < std::max(above_, below_))) next_ = middle;
    done_ = width <= tolerance_ || next_ == above_ || next_ == below_;
  }

  double above_, at_above_, below_, at_below_, tolerance_, first_, reach_, next_ = 0;
  bool done_ = false;
};

/// Runs LastAbove on one function and returns the parameter.
template <class Function>
double last_above(double above, double at_above, double below, double at_below, double tolerance,
                  const Function& function) {
  LastAbove search(above, at_above, below, at_below, tolerance);
  while (!search.done()) search.take(function(search.next()));
  return search.above();
}

}  // namespace petzval::core_detail
