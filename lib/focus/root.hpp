// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::inline v0::focus_detail {

/// A zero of f between a and b, where f has opposite signs (or is 0), within 2 eps of x. Bisection, with inverse
/// quadratic interpolation where the last three points show f to be nearly straight. f must be finite;
/// it may jump, and be constant far from the root.
template <class Function>
double root(const Function& f, double a, double b) {
  double at_a = f(a), at_b = f(b);
  if (at_a == 0) return a;
  double t = 0.5;
  for (;;) {
    const double x = a + t * (b - a), at_x = f(x);
    double c = a, at_c = at_a;
    if ((at_x > 0) != (at_a > 0)) {
      c = b, at_c = at_b;
      b = a, at_b = at_a;
    }
    a = x, at_a = at_x;

    const double best = std::abs(at_a) < std::abs(at_b) ? a : b;
    const double tolerance =
        2 * std::numeric_limits<double>::epsilon() * std::abs(best) + std::numeric_limits<double>::min();
    const double least_step = tolerance / std::abs(b - a);
    if (at_a == 0 || !(least_step < 0.5)) return at_a == 0 ? a : best;

    const double xi = (a - b) / (c - b), phi = (at_a - at_b) / (at_c - at_b);
    const bool straight = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    t = straight ? at_a / (at_b - at_a) * at_c / (at_b - at_c) +
                       (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
                 : 0.5;
    t = std::clamp(t, least_step, 1 - least_step);
  }
}

/// The maximum of f between two positions by golden section. f may be -infinite where it is not defined; if it is at
/// both positions compared, the search goes on nearer to `from`.
template <class Function>
double highest(const Function& f, double from, double to, double tolerance) {
  constexpr double golden = 0.6180339887498949;
  constexpr double undefined = -std::numeric_limits<double>::infinity();
  double a = to - golden * (to - from), b = from + golden * (to - from);
  double at_a = f(a), at_b = f(b);
  while (std::abs(to - from) > tolerance) {
    if (at_a > at_b || at_a == undefined) {
      to = b, b = a, at_b = at_a;
      a = to - golden * (to - from), at_a = f(a);
    } else {
      from = a, a = b, at_a = at_b;
      b = from + golden * (to - from), at_b = f(b);
    }
  }
  return at_a > at_b ? a : b;
}

}  // namespace petzval::inline v0::focus_detail
