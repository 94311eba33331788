// SPDX-License-Identifier: Apache-2.0
#include "power_spline.hpp"

#include <cmath>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::camera_detail {

PowerSpline<double> power_spline(const std::string& where, const std::vector<PowerKnot>& knots) {
  PowerSpline<double> spline;
  const std::size_t n = knots.size();
  if (n == 0) return spline;
  if (n > spline.most_knots) {
    throw Error(where + "power: number of knots = " + std::to_string(n) + "; must be " +
                std::to_string(spline.most_knots) + " or fewer");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto [radius, power] = knots[i];
    const std::string knot = where + "power: knot " + std::to_string(i + 1) + ": ";
    constexpr double min_knot_spacing = 1e-3;
    if (!(radius >= 0 && radius <= 1) || (i > 0 && !(radius - knots[i - 1].radius >= (1 - 1e-9) * min_knot_spacing))) {
      throw Error(knot + "radius = " + to_text(radius) + "; must be 0 to 1, and at least " + to_text(min_knot_spacing) +
                  " above the previous radius");
    }
    if (!(std::abs(power) <= 1000)) {
      throw Error(knot + "power = " + to_text(power) + "; must be -1000 to 1000");
    }
    spline.at[i] = radius;
  }
  spline.knots = n;
  spline.first = knots[0].power;
  if (n == 1) return spline;
  // Second derivatives by Thomas's algorithm; coefficients below, on and above the diagonal.
  const auto width = [&](std::size_t i) { return knots[i + 1].radius - knots[i].radius; };
  const auto slope = [&](std::size_t i) { return (knots[i + 1].power - knots[i].power) / width(i); };
  std::vector<double> over(n, 0), second(n, 0);
  over[0] = 0.5, second[0] = 3 * slope(0) / width(0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double below = width(i - 1), above = width(i), on = 2 * (below + above) - below * over[i - 1];
    over[i] = above / on;
    second[i] = (6 * (slope(i) - slope(i - 1)) - below * second[i - 1]) / on;
  }
  second[n - 1] = 0;
  for (std::size_t i = n - 1; i-- > 0;) second[i] -= over[i] * second[i + 1];
  spline.square = second[0] / 2;
  double before = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double third = (second[i + 1] - second[i]) / width(i);
    spline.cube[i] = (third - std::exchange(before, third)) / 6;
  }
  return spline;
}

}  // namespace petzval::camera_detail
