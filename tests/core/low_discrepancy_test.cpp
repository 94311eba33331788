// SPDX-License-Identifier: Apache-2.0
#include "core/low_discrepancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace petzval::core_detail {
namespace low_discrepancy_test {

TEST(Kronecker, StepsAreThePowersOfTheGeneralisedGoldenRatio) {
  EXPECT_NEAR(kronecker_steps<1>()[0], (std::sqrt(5.0) - 1) / 2, 2e-16);
  const auto plane = kronecker_steps<2>();  // the plastic number: x^3 = x + 1
  EXPECT_NEAR(plane[0], 1 / 1.32471795724474602596, 2e-16);
  EXPECT_NEAR(plane[1], plane[0] * plane[0], 2e-16);
  for (const double step : kronecker_steps<5>()) EXPECT_TRUE(step > 0 && step < 1) << step;
}

/// Largest error of the fraction of points in boxes [0, x) x [0, y).
template <class PointAt>
double discrepancy(std::size_t first, std::size_t count, const PointAt& point_at) {
  constexpr int steps = 16;
  double worst = 0;
  for (int i = 1; i <= steps; ++i) {
    for (int k = 1; k <= steps; ++k) {
      const double x = static_cast<double>(i) / steps, y = static_cast<double>(k) / steps;
      std::size_t inside = 0;
      for (std::size_t n = first; n < first + count; ++n) {
        const auto point = point_at(n);
        if (point[0] < x && point[1] < y) ++inside;
      }
      worst = std::max(worst, std::abs(static_cast<double>(inside) / static_cast<double>(count) - x * y));
    }
  }
  return worst;
}

TEST(Kronecker, AnyStretchIsUniform) {
  // Boxes are off by at most 8 of 1000 points; 40 with random points.
  for (const std::uint64_t seed : {0u, 1u, 77u}) {
    const Kronecker<2> points(seed);
    for (const std::size_t first : {0u, 5u, 1000u, 123457u}) {
      for (const std::size_t count : {100u, 333u, 1000u}) {
        EXPECT_LT(discrepancy(first, count, points), 10.0 / static_cast<double>(count))
            << "seed " << seed << ", " << count << " from " << first;
      }
    }
  }
}

TEST(Kronecker, SeedsShiftTheSequence) {
  const Kronecker<3> one(1), other(2);
  const auto a = one(0), b = other(0), c = one(40), d = other(40);
  for (std::size_t k = 0; k < 3; ++k) {
    const double shift = b[k] - a[k], later = d[k] - c[k];
    EXPECT_GT(std::abs(shift), 1e-6);
    EXPECT_NEAR(std::remainder(shift - later, 1), 0, 1e-13);
    EXPECT_NEAR(Kronecker<3>()(0)[k], kronecker_steps<3>()[k] / 2, 1e-16);
  }
}

TEST(FibonacciPoint, HasEveryHeightOnceAndIsUniform) {
  constexpr std::size_t count = 610;
  const auto point = [](std::size_t i) { return fibonacci_point(i, count); };
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(static_cast<std::size_t>(point(i)[1] * count), i);
  EXPECT_LT(discrepancy(0, count, point), 3.0 / count);
}

}  // namespace low_discrepancy_test
}  // namespace petzval::core_detail
