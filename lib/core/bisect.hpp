// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace petzval::inline v0::core_detail {

/// The last parameter with a property, between one that has it and one that does not, by bisection down to neighbouring
/// doubles.
template <class Property>
double last_with(double with, double without, const Property& property) {
  for (;;) {
    const double middle = with + (without - with) / 2;
    if (middle == with || middle == without) return with;
    (property(middle) ? with : without) = middle;
  }
}

/// The last parameter, within `tolerance`, at which a function is not negative. above, at_above: a parameter and its
/// value >= 0; below, at_below: one with a negative value. Superlinear where the function is smooth, never
/// more than one evaluation beyond bisection where it jumps. Source: Oliveira and Takahashi 2020, "An enhancement of
/// the bisection method average performance preserving minmax optimality" (ITP, kappa1 = 0.2 / interval, kappa2 = 2, n0
/// = 1).
template <class Function>
double last_above(double above, double at_above, double below, double at_below, double tolerance,
                  const Function& function) {
  const double first = std::abs(below - above);
  double reach = tolerance * std::exp2(std::ceil(std::log2(std::max(first / tolerance, 1.0))) + 1) / 2;
  while (std::abs(below - above) > tolerance) {
    const double middle = above + (below - above) / 2;
    const double radius = reach - std::abs(below - above) / 2;
    const double falsi = above + (below - above) * (at_above / (at_above - at_below));
    const double towards = falsi < middle ? 1 : -1;  // from the secant to the middle
    const double truncation = 0.2 * (below - above) * (below - above) / first;
    const double truncated = std::abs(middle - falsi) > truncation ? falsi + towards * truncation : middle;
    double x = std::abs(truncated - middle) <= radius ? truncated : middle - towards * radius;
    if (!(x > std::min(above, below) && x < std::max(above, below))) x = middle;
    if (x == above || x == below) break;
    const double value = function(x);
    if (value >= 0) {
      above = x, at_above = value;
    } else {
      below = x, at_below = value;
    }
    reach /= 2;
  }
  return above;
}

}  // namespace petzval::inline v0::core_detail
