// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>

namespace petzval::analysis_detail {

/// Partial sums, or maxima, each over every eighth point. A loop over points may run on SIMD lanes, and its result does
/// not depend on the number of lanes.
using PartialSums = std::array<double, 8>;

inline double sum(const PartialSums& parts) noexcept { return std::accumulate(parts.begin(), parts.end(), 0.0); }

inline double largest(const PartialSums& parts) noexcept { return *std::max_element(parts.begin(), parts.end()); }

/// Number of points that have both coordinates and, unless weights are empty, a weight.
template <class Points>
std::size_t point_count(const Points& points) noexcept {
  const std::size_t count = std::min(points.x.size(), points.y.size());
  return points.weights.empty() ? count : std::min(count, points.weights.size());
}

/// Calls see(part, x, y, weight) for all points of several sets. Weights are 1 if a set has no weights. Consecutive
/// points of a set go to consecutive parts.
template <class Sets, class See>
void for_each(const Sets& sets, See&& see) noexcept {
  constexpr std::size_t parts = std::tuple_size_v<PartialSums>;
  for (const auto& points : sets) {
    const std::span<const double> xs = points.x, ys = points.y, weights = points.weights;
    const std::size_t count = point_count(points), whole = count - count % parts;
    const auto see_all = [&](const auto& weight) {
      for (std::size_t i = 0; i < whole; i += parts) {
        for (std::size_t part = 0; part < parts; ++part) see(part, xs[i + part], ys[i + part], weight(i + part));
      }
      for (std::size_t i = whole; i < count; ++i) see(i - whole, xs[i], ys[i], weight(i));
    };
    if (weights.empty()) {
      see_all([](std::size_t) { return 1.0; });
    } else {
      see_all([weights](std::size_t i) { return weights[i]; });
    }
  }
}

}  // namespace petzval::analysis_detail
