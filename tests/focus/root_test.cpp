// SPDX-License-Identifier: Apache-2.0
#include "focus/root.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace petzval {
namespace root_test {

struct Found {
  double at;
  int evaluations;
};

constexpr double undefined = -std::numeric_limits<double>::infinity();

Found root(const std::function<double(double)>& f, double a, double b) {
  Found found{0, 0};
  found.at = focus_detail::root([&](double x) { return ++found.evaluations, f(x); }, a, b);
  return found;
}

TEST(Root, IsWhereTheSignChanges) {
  const Found smooth = root([](double x) { return std::cos(x); }, 0, 3);
  EXPECT_NEAR(smooth.at, std::acos(0.0), 1e-15);
  EXPECT_LT(smooth.evaluations, 12);
  EXPECT_NEAR(root([](double x) { return x < 0.3 ? -1.0 : 1.0; }, 0, 1).at, 0.3, 1e-15);
  EXPECT_EQ(root([](double x) { return x; }, 0, 1).at, 0);
}

// The function looks linear, with a root at the next number.
TEST(Root, TakesFewStepsBeforeAJump) {
  for (const double small : {1e-3, 1e-9, 1e-15, 1e-30}) {
    const auto jump = [small](double x) { return x < 0.3 ? -small * (1 + 1e-3 * (0.3 - x)) : 1e9; };
    for (const auto& [a, b] : {std::pair{0.0, 1.0}, std::pair{1.0, 0.0}}) {
      const Found found = root(jump, a, b);
      EXPECT_NEAR(found.at, 0.3, 1e-15);
      EXPECT_LT(found.evaluations, 300);
    }
  }
  EXPECT_LT(root([](double x) { return x > 0 ? 1.0 : -1.0; }, 0, 1).evaluations, 150);  // at 0, to eps^2
}

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

TEST(Highest, TakesFewStepsOnSmoothFunctions) {
  EXPECT_LT(highest([](double x) { return std::sin(x); }, 0, 3).evaluations, 20);
  EXPECT_LT(highest([](double x) { return -std::abs(x - 0.2); }).evaluations, 60);
}

TEST(Highest, LiesWhereTheFunctionIsDefined) {
  EXPECT_NEAR(highest([](double x) { return x < 0.6 ? x : undefined; }).at, 0.6, 4e-9);
  EXPECT_NEAR(highest([](double x) { return x > 0.6 ? -x : undefined; }).at, 0.6, 4e-9);
  EXPECT_NEAR(highest([](double x) { return x < 0.01 ? -x : undefined; }).at, 0, 4e-9);  // nearer to the first end
  EXPECT_LT(highest([](double) { return undefined; }).evaluations, 20);
}

}  // namespace root_test
}  // namespace petzval
