// SPDX-License-Identifier: Apache-2.0
#include "focus/keyframes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace keyframes_test {

using testing::expect_error;

using focus_detail::Keyframes;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Keys {
  std::vector<double> times, values;
};

/// Time steps from 0.001 to 100, values with plateaus and jumps.
Keys random_keys(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Keys keys;
  double time = 100 * uniform(random) - 50, value = 0;
  for (std::size_t count = 1 + random() % 8; keys.times.size() < count;) {
    keys.times.push_back(time);
    keys.values.push_back(value);
    time += std::pow(10, 5 * uniform(random) - 3);
    if (random() % 4 != 0) value += (uniform(random) - 0.5) * std::pow(10, 4 * uniform(random));
  }
  return keys;
}

TEST(Keyframes, StayBetweenAdjacentKeys) {
  std::mt19937 random(1);
  for (int draw = 0; draw < 500; ++draw) {
    const Keys keys = random_keys(random);
    const Keyframes curve(keys.times, keys.values);
    for (std::size_t k = 0; k + 1 < keys.times.size(); ++k) {
      const auto [low, high] = std::minmax(keys.values[k], keys.values[k + 1]);
      double last = keys.values[k];
      for (int i = 0; i <= 64; ++i) {
        const double value = curve.at(std::lerp(keys.times[k], keys.times[k + 1], i / 64.0));
        EXPECT_GE(value, low) << draw;
        EXPECT_LE(value, high) << draw;
        // Also monotone between keys.
        EXPECT_GE((value - last) * (keys.values[k + 1] - keys.values[k]), -1e-9 * (high - low) * (high - low)) << draw;
        last = value;
      }
    }
  }
}

TEST(Keyframes, AreExactAtKeysAndConstantOutside) {
  std::mt19937 random(2);
  for (int draw = 0; draw < 100; ++draw) {
    const Keys keys = random_keys(random);
    const Keyframes curve(keys.times, keys.values);
    for (std::size_t k = 0; k < keys.times.size(); ++k) EXPECT_EQ(curve.at(keys.times[k]), keys.values[k]);
    for (const double away : {1e-9, 1.0, infinity}) {
      EXPECT_EQ(curve.at(keys.times.front() - away), keys.values.front());
      EXPECT_EQ(curve.at(keys.times.back() + away), keys.values.back());
    }
    EXPECT_TRUE(std::isnan(curve.at(nan)));
  }
}

TEST(Keyframes, HaveAContinuousDerivative) {
  const std::vector<double> times{0, 1, 1.25, 4, 5}, values{2, 5, 6, 9, 9};
  const Keyframes curve(times, values);
  for (const double time : times) {
    // One-sided differences of third order; the derivatives of a curve with a kink differ by about 1 here.
    const auto slope = [&](double h) {
      return (-11 * curve.at(time) + 18 * curve.at(time + h) - 9 * curve.at(time + 2 * h) +
              2 * curve.at(time + 3 * h)) /
             (6 * h);
    };
    EXPECT_NEAR(slope(1e-4), slope(-1e-4), 1e-8) << time;
  }
  // The curve does not rest at keys that it passes.
  EXPECT_GT(curve.at(1.25 + 1e-3) - curve.at(1.25 - 1e-3), 2e-3);
}

TEST(Keyframes, TwoKeysGiveTheSmoothStep) {
  const Keyframes curve({-1, 3}, {10, 20});
  for (double s = 0; s <= 1; s += 0.125) EXPECT_NEAR(curve.at(4 * s - 1), 10 + 10 * s * s * (3 - 2 * s), 1e-13);
}

// Slopes 3/2 at 1 (harmonic mean of 1 and 3) and 0 at the ends, by hand.
TEST(Keyframes, PassKeysAtTheHarmonicMeanOfTheSlopes) {
  const Keyframes curve({0, 1, 2}, {0, 1, 4});
  EXPECT_NEAR(curve.at(0.5), 0.5 - 1.5 / 8, 1e-15);
  EXPECT_NEAR(curve.at(1.5), 2.5 + 1.5 / 8, 1e-15);
  // Unequal steps of 1 and 3 with slopes 1 and 2: 1 / (7/12 / 1 + 5/12 / 2) = 24/19.
  const Keyframes uneven({0, 1, 4}, {0, 1, 7});
  EXPECT_NEAR(uneven.at(0.5), 0.5 - 24.0 / 19 / 8, 1e-15);
}

TEST(Keyframes, RefuseInvalidKeys) {
  expect_error([] { Keyframes({}, {}); }, {"keyframes", 0, "times", 0});
  expect_error([] { Keyframes({1, 2}, {1}); }, {"keyframes", 2, "times", 1});
  expect_error([] { Keyframes({0, 2, 2}, {1, 1, 1}); }, {"keyframes", "key 2", "time", 2});
  expect_error([] { Keyframes({0, nan}, {1, 1}); }, {"keyframes", "key 1", "value", 1, "nan"});
  expect_error([] { Keyframes({0}, {infinity}); }, {"keyframes", "key 0", "value", "inf", 0});
  expect_error([] { Keyframes({0, 1}, {-1e308, 1e308}); }, {"keyframes", "key 1", "value", "1e+308", 1, "-1e+308", 0});
  expect_error([] { Keyframes({0, 1}, {1, 1e308}); }, {"keyframes", "1e+308"});
  expect_error([] { Keyframes({-1e308, 1e308}, {0, 1}); }, {"keyframes", "1e+308"});
}

}  // namespace keyframes_test
}  // namespace petzval
