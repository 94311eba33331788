// SPDX-License-Identifier: Apache-2.0
#include "analysis/histogram.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace petzval {
namespace histogram_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(CountPoints, RowsRunFromTheTop) {
  std::vector<std::uint64_t> counts(9, 0);
  const std::vector<double> x{9.2, 10.8, 10.1, 10.1}, y{20.9, 20.7, 19.2, 19.3};
  analysis_detail::count_points({{10, 20}, 0.7, 3}, x, y, counts);
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{1, 0, 1, 0, 0, 0, 0, 2, 0}));
}

TEST(CountPoints, HoldsEveryPointOnce) {
  // The count of a pixel is the number of points between its edges.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (const std::size_t count : {0u, 1u, 255u, 256u, 257u, 5000u}) {
    std::vector<double> x(count), y(count);
    for (double& value : x) value = uniform(random);
    for (double& value : y) value = uniform(random);
    std::vector<std::uint64_t> counts(64, 0);
    analysis_detail::count_points({{0, 0}, 0.25, 8}, x, y, counts);
    for (std::size_t k = 0; k < 64; ++k) {
      const double left = -1 + 0.25 * static_cast<double>(k % 8), top = 1 - 0.25 * static_cast<double>(k / 8);
      std::uint64_t within = 0;
      for (std::size_t i = 0; i < count; ++i) {
        within += x[i] >= left && x[i] < left + 0.25 && y[i] <= top && y[i] > top - 0.25;
      }
      ASSERT_EQ(counts[k], within) << "pixel " << k << " of " << count << " points";
    }
  }
}

TEST(CountPoints, IgnoresPointsOutside) {
  std::vector<std::uint64_t> counts(16, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> x{-2.001, 2, 0, 0, infinity, -infinity, 1e300, nan, 0};
  const std::vector<double> y{0, 0, 2.001, -2, 0, 0, -1e300, 0, nan};
  analysis_detail::count_points({{0, 0}, 1, 4}, x, y, counts);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t(0)), 0u);
}

TEST(CountPoints, CountsExactlyInFullPixels) {
  // Counts at the limits of integers in float (2^24), 32 bits and double (2^53).
  for (const std::uint64_t full : {std::uint64_t(1) << 24, std::uint64_t(1) << 32, std::uint64_t(1) << 53}) {
    std::vector<std::uint64_t> counts{full};
    const std::vector<double> places(3, 0.0);
    analysis_detail::count_points({{0, 0}, 1, 1}, places, places, counts);
    EXPECT_EQ(counts[0], full + 3);
  }
}

}  // namespace histogram_test
}  // namespace petzval
