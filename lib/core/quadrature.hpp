// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace petzval::core_detail {

struct QuadratureNode {
  double x, weight;  ///< on (0, 1); the weights sum to 1
};

/// Gauss-Legendre nodes, computed by Newton's iteration on the three-term recurrence.
template <std::size_t count>
std::array<QuadratureNode, count> gauss_legendre() {
  std::array<QuadratureNode, count> nodes;
  for (std::size_t i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (count + 0.5));
    double slope = 0;
    for (int iteration = 0; iteration < 6; ++iteration) {
      double p = 1, before = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const double order = static_cast<double>(k);
        const double next = ((2 * order + 1) * x * p - order * before) / (order + 1);
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    nodes[i] = {(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)};
  }
  return nodes;
}

}  // namespace petzval::core_detail
