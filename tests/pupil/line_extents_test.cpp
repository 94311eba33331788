// SPDX-License-Identifier: Apache-2.0
#include "pupil/line_extents.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace petzval::pupil_detail {
namespace line_extents_test {

constexpr double tolerance = 1e-9;

/// Extent along x from -1 to 1, sampled at distances of 1/8. clearance: clearance as a function of x.
LineExtent along_x(const std::function<double(double)>& clearance) {
  const auto at_places = [&](std::size_t count, const std::uint32_t*, const double* x, const double*, double* found) {
    std::transform(x, x + count, found, clearance);
  };
  // A second, empty line checks that lines do not share samples.
  const auto nothing = [&](std::size_t count, const std::uint32_t* points, const double* x, const double* y,
                           double* found) {
    at_places(count, points, x, y, found);
    for (std::size_t i = 0; i < count; ++i) found[i] = points[i] == 0 ? -1 : found[i];
  };
  const auto result = extents_along({{.point = 0, .dx = 1}, {.point = 1, .dx = 1}}, -1, 1, 16, tolerance, nothing);
  EXPECT_FALSE(result[0].any);
  return result[1];
}

TEST(LineExtents, EndAtTheEdges) {
  for (const double from : {-0.95, -0.4, 0.0, 0.3}) {
    for (const double to : {0.45, 0.7, 0.99}) {
      const LineExtent found = along_x([&](double x) { return std::min(x - from, to - x); });
      ASSERT_TRUE(found.any);
      EXPECT_NEAR(found.from, from, tolerance);
      EXPECT_NEAR(found.to, to, tolerance);
      EXPECT_NEAR(found.slope, -1, 1e-6);
      EXPECT_TRUE(found.gaps.empty());
      // With the sign of the clearance only.
      const LineExtent by_sign = along_x([&](double x) { return clearance_of(x >= from && x <= to); });
      EXPECT_NEAR(by_sign.from, from, tolerance);
      EXPECT_NEAR(by_sign.to, to, tolerance);
    }
  }
}

// Only the last or the first sample passes.
TEST(LineExtents, AreFoundFromOneSample) {
  const LineExtent last = along_x([](double x) { return x - 0.95; });
  ASSERT_TRUE(last.any);
  EXPECT_NEAR(last.from, 0.95, tolerance);
  EXPECT_EQ(last.to, 1);
  const LineExtent first = along_x([](double x) { return -0.95 - x; });
  ASSERT_TRUE(first.any);
  EXPECT_EQ(first.from, -1);
  EXPECT_NEAR(first.to, -0.95, tolerance);
  EXPECT_FALSE(along_x([](double) { return -0.1; }).any);
}

TEST(LineExtents, ReportTheWidestObscurationAndOtherGaps) {
  const auto outside = [](double x, double from, double to) { return std::max(from - x, x - to); };
  const LineExtent found = along_x([&](double x) {
    return std::min({x + 0.9, 0.9 - x, outside(x, -0.55, -0.05), outside(x, 0.3, 0.6)});
  });
  EXPECT_NEAR(found.obscured_from, -0.55, tolerance);
  EXPECT_NEAR(found.obscured_to, -0.05, tolerance);
  ASSERT_EQ(found.gaps.size(), 1u);
  EXPECT_NEAR(found.gaps[0].from, 0.3, 0.125);
  EXPECT_NEAR(found.gaps[0].to, 0.6, 0.125);
}

}  // namespace line_extents_test
}  // namespace petzval::pupil_detail
