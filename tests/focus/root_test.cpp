// SPDX-License-Identifier: Apache-2.0
#include "focus/root.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace petzval {
namespace {

constexpr double undefined = -std::numeric_limits<double>::infinity();

struct Found {
  double at;
  int evaluations;
};

Found highest(const std::function<double(double)>& f, double from = 0, double to = 1) {
  Found found{0, 0};
  const auto counted = [&](double x) {
    EXPECT_TRUE(x >= from && x <= to);
    ++found.evaluations;
    return f(x);
  };
  found.at = focus_detail::highest(counted, from, to, 1e-9);
  return found;
}

TEST(Highest, IsTheMaximum) {
  EXPECT_NEAR(highest([](double x) { return std::sin(x); }, 0, 3).at, std::acos(0.0), 1e-7);  // half of the digits
  EXPECT_NEAR(highest([](double x) { return -std::abs(x - 0.2); }).at, 0.2, 4e-9);
  EXPECT_NEAR(highest([](double x) { return x; }).at, 1, 4e-9);
  EXPECT_NEAR(highest([](double x) { return -x; }).at, 0, 4e-9);
}

TEST(Highest, TakesFewStepsWhereItIsSmooth) {
  EXPECT_LT(highest([](double x) { return std::sin(x); }, 0, 3).evaluations, 20);
  EXPECT_LT(highest([](double x) { return -std::abs(x - 0.2); }).evaluations, 60);
}

TEST(Highest, LiesWhereTheFunctionIsDefined) {
  EXPECT_NEAR(highest([](double x) { return x < 0.6 ? x : undefined; }).at, 0.6, 4e-9);
  EXPECT_NEAR(highest([](double x) { return x > 0.6 ? -x : undefined; }).at, 0.6, 4e-9);
  EXPECT_NEAR(highest([](double x) { return x < 0.01 ? -x : undefined; }).at, 0, 4e-9);  // nearer to the first end
  EXPECT_LT(highest([](double) { return undefined; }).evaluations, 20);
}

}  // namespace
}  // namespace petzval
