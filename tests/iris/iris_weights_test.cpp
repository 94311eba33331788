// SPDX-License-Identifier: Apache-2.0
#include "iris/iris_weights.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "../message.hpp"
#include "iris/iris_edges.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace iris_weights_test {

using iris_detail::IrisShape;
using iris_detail::IrisWeights;
using testing::expect_error;
using testing::expect_tokens;
using testing::message;

std::vector<Iris> irises() {
  return {{},
          {.blades = 3},
          {.blades = 5, .roundness = -1, .rotation_rad = 0.4},
          {.blades = 6, .roundness = 0.5},
          {.blades = 9, .rotation_rad = -1}};
}

/// Published rows of weights.
std::vector<EdgeWeight> edges_of_the_text() {
  std::vector<EdgeWeight> result;
  for (const double p : {0.8, 0.6, 0.4, 0.2, 0.0}) result.push_back({-4, p}), result.push_back({4, p});
  for (const double d : {5.5, 8.7, 12.7, 20.7, 50.7}) result.push_back({d, 0.6});
  return result;
}

/// A map with a bright half, a dark half and a spot.
IrisMap some_map(bool keep_mean = false) {
  IrisMap map{32, 24, {}, keep_mean};
  for (int i = 0; i < 32 * 24; ++i) map.values.push_back(i % 32 < 16 ? 0.2f : 0.9f);
  map.values[24 * 5 + 7] = 3;
  return map;
}

TEST(EdgeWeight, EqualsThePublishedFormula) {
  EXPECT_DOUBLE_EQ((EdgeWeight{4, 0.6}.at(0)), 0.4);
  EXPECT_DOUBLE_EQ((EdgeWeight{4, 0.6}.at(1)), 3.4);
  EXPECT_DOUBLE_EQ((EdgeWeight{4, 0.6}.at(0.5)), 0.4 + 3.0 / 16);
  EXPECT_DOUBLE_EQ((EdgeWeight{-4, 0.6}.at(0.25)), (EdgeWeight{4, 0.6}.at(0.75)));
  EXPECT_EQ((EdgeWeight{0, 0.5}.at(0.3)), 1);
  EXPECT_EQ((EdgeWeight{7, 0}.at(0.3)), 1);
}

TEST(EdgeWeight, ConservesTheMeanOnEveryShape) {
  for (const EdgeWeight& edge : edges_of_the_text()) {
    EXPECT_NEAR(edge.light_added(), 0, 1e-12);
    for (const Iris& iris : irises()) {
      const IrisShape shape(iris);
      const IrisWeights weights(iris, edge, {}, 0, "");
      EXPECT_NEAR(weights.mean(), 1, 1e-12);
      double sum = 0;
      constexpr std::size_t count = 1 << 15;
      for (std::size_t i = 0; i < count; ++i) {
        const auto [u, v] = testing::fibonacci_point(i, count);
        sum += weights.at(shape.sample(u, v));
      }
      EXPECT_NEAR(sum / count, 1, 1e-4) << iris.blades << ' ' << edge.distribution << ' ' << edge.strength;
    }
  }
}

TEST(EdgeWeight, ReportsTheChangeByClipping) {
  for (const EdgeWeight& edge : {EdgeWeight{4, 1.5}, EdgeWeight{-3, 2}, EdgeWeight{4, -0.9}, EdgeWeight{0.5, 3}}) {
    double sum = 0;
    constexpr int count = 1 << 16;
    for (int i = 0; i < count; ++i) sum += edge.at((i + 0.5) / count);
    EXPECT_GT(edge.light_added(), 0.01);
    EXPECT_NEAR(edge.light_added(), sum / count - 1, 1e-6);
    EXPECT_NEAR((IrisWeights({}, edge, {}, 0, "").mean()), sum / count, 1e-6);
  }
}

TEST(IrisWeights, WeightOverDensityIsConstant) {
  for (const EdgeWeight& edge : edges_of_the_text()) {
    const IrisWeights weights({.blades = 7}, edge, {}, 0, "");
    for (std::size_t i = 0; i < 10000; ++i) {
      const auto [u, v] = testing::fibonacci_point(i, 10000);
      const auto drawn = weights.draw(u, v);
      EXPECT_NEAR(weights.of_sample(drawn.u, drawn.v) / drawn.density, 1, 0.0125) << edge.distribution;
    }
  }
}

/// Chi-square of samples in cells of the square against their stated density.
TEST(IrisWeights, SamplesHaveTheStatedDensity) {
  constexpr std::size_t columns = 16, rows = 16, count = 1 << 18;
  for (const EdgeWeight& edge : {EdgeWeight{20.7, 0.6}, EdgeWeight{-4, 0.8}, EdgeWeight{}}) {
    for (const IrisMap& map : {IrisMap{}, some_map(), onion_rings({.period = 0.2}, 64)}) {
      for (const double uniform : {0.0, 0.25}) {
        const IrisWeights weights({.blades = 5, .roundness = 0.3}, edge, map, uniform, "");
        std::array<double, columns * rows> found{}, wanted{};
        for (std::size_t i = 0; i < count; ++i) {
          const auto [u, v] = testing::fibonacci_point(i, count);
          const auto drawn = weights.draw(u, v);
          ASSERT_TRUE(drawn.u >= 0 && drawn.u <= 1 && drawn.v >= 0 && drawn.v <= 1);
          ASSERT_NEAR(weights.density(drawn.u, drawn.v) / drawn.density, 1, 0.02);
          const auto cell = [](double x, std::size_t of) {
            return std::min(static_cast<std::size_t>(x * static_cast<double>(of)), of - 1);
          };
          ++found[cell(drawn.v, rows) * columns + cell(drawn.u, columns)];
          wanted[cell(v, rows) * columns + cell(u, columns)] += weights.density(u, v);
        }
        double chi2 = 0;
        for (std::size_t k = 0; k < found.size(); ++k) {
          if (wanted[k] > 5) chi2 += (found[k] - wanted[k]) * (found[k] - wanted[k]) / wanted[k];
        }
        // Low-discrepancy samples stay below 255, the mean of random samples.
        EXPECT_LT(chi2, 255);
      }
    }
  }
}

TEST(IrisWeights, MapsKeepTheirMeanOrAreNormalisedToOne) {
  const auto mean = [](const IrisWeights& weights, const Iris& iris) {
    const IrisShape shape(iris);
    double sum = 0;
    constexpr std::size_t count = 1 << 16;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [u, v] = testing::fibonacci_point(i, count);
      sum += weights.at(shape.sample(u, v)) / count;
    }
    return sum;
  };
  for (const Iris& iris : irises()) {
    const IrisWeights as_given(iris, {}, some_map(), 0, ""), kept(iris, {}, some_map(true), 0, "");
    EXPECT_NEAR(mean(as_given, iris), as_given.mean(), 1e-3);
    EXPECT_GT(as_given.mean(), 0.4);
    EXPECT_LT(as_given.mean(), 0.7);
    EXPECT_NEAR(mean(kept, iris), 1, 2e-3);
    EXPECT_NEAR(kept.mean(), 1, 1e-6);
  }
}

// A slit and a hole of one pixel.
TEST(IrisWeights, ResolveDetailsOfAPixel) {
  constexpr int pixels = 512;
  IrisMap slit{pixels, pixels, std::vector<float>(pixels * pixels)}, hole = slit;
  for (int i = 0; i < pixels; ++i) slit.values[static_cast<std::size_t>(i * pixels + pixels / 2)] = 1;
  hole.values[static_cast<std::size_t>(100 * pixels + 300)] = 1;
  EXPECT_NEAR(iris_area({}, slit), 2 * 2.0 / pixels, 0.02 * 4 / pixels);
  EXPECT_NEAR(iris_area({}, hole), 4.0 / (pixels * pixels), 0.02 * 4 / (pixels * pixels));
}

TEST(IrisWeights, MapHasXToTheRightAndYUp) {
  IrisMap map{2, 2, {1, 2, 3, 4}};
  const IrisWeights weights({}, {}, map, 0, "");
  EXPECT_FLOAT_EQ(weights.at({-0.6, 0.6}), 1);
  EXPECT_FLOAT_EQ(weights.at({0.6, 0.6}), 2);
  EXPECT_FLOAT_EQ(weights.at({-0.6, -0.6}), 3);
  EXPECT_FLOAT_EQ(weights.at({0.6, -0.6}), 4);
  EXPECT_FLOAT_EQ(weights.at({0, 0}), 2.5);
  EXPECT_EQ(iris_detail::upside_down(map, true, true).values, (std::vector<float>{4, 3, 2, 1}));
  EXPECT_EQ(iris_detail::upside_down(map, true, false).values, (std::vector<float>{2, 1, 4, 3}));
  EXPECT_EQ(iris_detail::upside_down(map, false, true).values, (std::vector<float>{3, 4, 1, 2}));
}

TEST(OnionRings, HaveTheStatedPeriod) {
  const IrisMap map = onion_rings({.period = 0.1, .contrast = 0.3, .jitter = 0}, 500);
  const auto at = [&](double radius) {
    return map.values[250 * 500 + static_cast<std::size_t>((radius + 1) / 2 * 500)];
  };
  for (const double radius : {0.2, 0.5, 0.9}) {
    EXPECT_NEAR(at(radius), 1.3, 0.01);
    EXPECT_NEAR(at(radius + 0.05), 0.7, 0.01);
  }
}

TEST(IrisWeights, InvalidNumbersHaveWeightZero) {
  for (const double no_number : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const IrisMap& map : {IrisMap{}, some_map()}) {
      const IrisWeights weights({.blades = 5}, {4, 0.6}, map, 0, "");
      EXPECT_EQ(weights.of_sample(no_number, 0.5), 0);
      EXPECT_EQ(weights.of_sample(0.5, no_number), 0);
      EXPECT_EQ(weights.at({no_number, 0}), 0);
    }
  }
}

TEST(IrisWeights, RefuseInvalidMaps) {
  const auto refused = [](const IrisMap& map) {
    return message([&] {
      iris_detail::check(map, "");
      IrisWeights({}, {}, map, 0, "");
    });
  };
  expect_tokens(refused({2, 2, {1, 2, 3}}), {"map", 3, 2});
  expect_tokens(refused({2, 1, {1, -1}}), {"map", -1, "row 0", "column 1"});
  expect_tokens(refused({1, 1, {std::numeric_limits<float>::quiet_NaN()}}), {"map", "nan"});
  expect_tokens(refused({1, 1, {std::numeric_limits<float>::infinity()}}), {"map", "inf"});
  expect_tokens(refused({1, 1, {0}}), {"map", "black"});
  expect_tokens(refused({1 << 14, 1 << 13, {}}), {"map", 1 << 14, 1 << 13});
  expect_tokens(refused({-1, -1, {1}}), {"map", -1});
  expect_error([] { IrisWeights({}, {std::nan(""), 0.5}, {}, 0, ""); }, {"nan"});
  expect_error([] { onion_rings({.period = 0}); }, {"period", 0});
  expect_error([] { onion_rings({.period = std::nan("")}); }, {"period", "nan"});
  expect_error([] { onion_rings({.contrast = 1.5}); }, {"contrast", 1.5});
  expect_error([] { onion_rings({.jitter = -1}); }, {"jitter", -1});
  expect_error([] { onion_rings({}, 1); }, {1});
}

}  // namespace iris_weights_test
}  // namespace petzval
