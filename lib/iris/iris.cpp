// SPDX-License-Identifier: Apache-2.0
#include "petzval/iris/iris.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0 {

Iris regular_iris(int blades, double turn_rad) {
  if (blades < 3) throw Error("iris: blades is " + std::to_string(blades) + ", wanted 3 or more");
  if (!std::isfinite(turn_rad)) throw Error("iris: turn_rad is " + to_text(turn_rad) + ", wanted a finite angle");
  Iris iris;
  for (int i = 0; i < blades; ++i) {
    const double angle = turn_rad + 2 * std::numbers::pi * i / blades;
    iris.edges.push_back({std::cos(angle), std::sin(angle), std::cos(std::numbers::pi / blades)});
  }
  return iris;
}

}  // namespace petzval::inline v0
