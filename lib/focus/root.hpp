// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::focus_detail {

/// A zero of f between a and b, where f has opposite signs or is 0, within 2 eps of x plus eps^2 of |b - a|. Uses
/// bisection and, if f is nearly linear between the last three points, inverse quadratic interpolation: at most five
/// evaluations for each halving. f must be finite; it may jump, and may be constant far from the root.
template <class Function>
double root(const Function& f, double a, double b) {
  double at_a = f(a), at_b = f(b);
  if (at_a == 0) return a;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const double least = eps * eps * std::abs(b - a) + std::numeric_limits<double>::min();
  double t = 0.5;
  int slow = 0;  // steps since the interval was last halved
  for (;;) {
    const double x = a + t * (b - a), at_x = f(x), width = std::abs(b - a);
    double c = a, at_c = at_a;
    if ((at_x > 0) != (at_a > 0)) {
      c = b, at_c = at_b;
      b = a, at_b = at_a;
    }
    a = x, at_a = at_x;

    const double best = std::abs(at_a) < std::abs(at_b) ? a : b;
    const double tolerance = 2 * eps * std::abs(best) + least;
    const double least_step = tolerance / std::abs(b - a);
    if (at_a == 0 || !(least_step < 0.5)) return at_a == 0 ? a : best;

    const double xi = (a - b) / (c - b), phi = (at_a - at_b) / (at_c - at_b);
    const bool straight = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    // Close to a jump f appears linear, with a root at the next number.
    slow = std::abs(b - a) > width / 2 ? slow + 1 : 0;
    t = straight && slow < 4 ? at_a / (at_b - at_a) * at_c / (at_b - at_c) +
                                   (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
                             : 0.5;
    t = std::clamp(t, least_step, 1 - least_step);
  }
}

/// The maximum of f between from and to, from < to. Each step goes to the vertex of the parabola through the three
/// highest points if these steps become shorter, otherwise to a golden section. If two values are equal, the search
/// continues on the side of `from`. f may be -infinity; a search that finds no other value ends within a thousandth of
/// the range. Source: Brent 1973, "Algorithms for Minimization without Derivatives", chapter 5.
template <class Function>
double highest(const Function& f, double from, double to, double tolerance) {
  constexpr double golden = 0.3819660112501051;
  const double unseen = (to - from) / 1000;
  double x = from + golden * (to - from), second = x, third = x;  // positions of the three highest values
  double at_x = f(x), at_second = at_x, at_third = at_x;
  double step = 0, step_before = 0;
  for (;;) {
    const double middle = from + (to - from) / 2;
    if (!(std::abs(x - middle) > 2 * tolerance - (to - from) / 2)) return x;
    if (std::isinf(at_x) && to - from < unseen) return x;

    double offset = 0, divisor = 0;  // the vertex is x + offset / divisor; not finite if a value is infinite
    if (std::abs(step_before) > tolerance) {
      const double r = (x - second) * (at_x - at_third), q = (x - third) * (at_x - at_second);
      offset = (x - third) * q - (x - second) * r, divisor = 2 * (r - q);
    }
    const double vertex = x + offset / divisor;
    if (vertex > from && vertex < to && std::abs(vertex - x) < std::abs(step_before) / 2) {
      step_before = step, step = vertex - x;
      if (std::min(vertex - from, to - vertex) < 2 * tolerance) step = std::copysign(tolerance, middle - x);
    } else {
      step_before = x < middle ? to - x : from - x;
      step = golden * step_before;
    }

    const double u = x + (std::abs(step) < tolerance ? std::copysign(tolerance, step) : step);
    if (u == x) return x;
    const double at_u = f(u);
    const bool higher = at_u > at_x || (at_u == at_x && u < x);
    ((u < x) == higher ? to : from) = higher ? x : u;
    if (higher) {
      third = second, at_third = at_second;
      second = x, at_second = at_x;
      x = u, at_x = at_u;
    } else if (at_u >= at_second || second == x) {
      third = second, at_third = at_second;
      second = u, at_second = at_u;
    } else if (at_u >= at_third || third == x || third == second) {
      third = u, at_third = at_u;
    }
  }
}

}  // namespace petzval::focus_detail
