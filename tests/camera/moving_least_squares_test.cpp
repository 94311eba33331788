// SPDX-License-Identifier: Apache-2.0
#include "camera/moving_least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../expect_error.hpp"

namespace moving_least_squares_test {

using namespace petzval;
using camera_detail::MovingLeastSquares;
using camera_detail::WeighedValue;

constexpr SurfaceKind kinds[] = {SurfaceKind::affine, SurfaceKind::shepard};
constexpr double betas[] = {1, 2, 2.5, 3, 4, 5.3, 8};

MovingLeastSquares through(const std::vector<WeighedValue>& points, SurfaceKind kind = SurfaceKind::affine,
                           double beta = 3, double side = 1) {
  return {"test: ", points, side, kind, beta};
}

std::vector<WeighedValue> random_points(unsigned seed, std::size_t count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<WeighedValue> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({{unit(random), unit(random)}, unit(random), 0.1 + std::abs(unit(random))});
  }
  return points;
}

// Values computed with 40 digits.
TEST(MovingLeastSquares, EqualsAnIndependentComputation) {
  std::vector<WeighedValue> points{{{0, 0}, 0.5}, {{1, 0}, 0.25}, {{0, 1}, 0.125, 2}};
  const FilmPoint at{0.3, 0.2};
  const double by_beta[] = {0.31177199880250149, 0.37830858618463525, 0.43180227305683083, 0.46544479750646939};
  for (int b = 0; b < 4; ++b) {
    EXPECT_NEAR(through(points, SurfaceKind::shepard, b + 1).at(at), by_beta[b], 1e-15) << b;
  }
  points.push_back({{1, 1}, 0.4});
  EXPECT_NEAR(through(points, SurfaceKind::shepard, 2).at(at), 0.37976240763813471, 1e-15);
  EXPECT_NEAR(through(points, SurfaceKind::affine, 2).at(at), 0.39068445475636171, 1e-12);
  EXPECT_NEAR(through(points, SurfaceKind::affine, 4).at(at), 0.38681544143619512, 1e-12);
}

// Two points have a closed form for every power.
TEST(MovingLeastSquares, TendsToTheNearestPointAsBetaGrows) {
  const std::vector<WeighedValue> points{{{0, 0}, 0.7}, {{4, 0}, -0.2, 0.5}};
  for (double beta = 1; beta <= 8; beta += 0.125) {
    const double other = 0.5 * std::pow(3, -beta), expected = (0.7 - 0.2 * other) / (1 + other);
    const auto surface = through(points, SurfaceKind::shepard, beta, 10);
    EXPECT_NEAR(surface.at({1, 0}), expected, 2e-15) << beta;
    const float x = 1, y = 0;
    float value = 0;
    surface.at(1, &x, &y, &value);
    EXPECT_NEAR(value, expected, 2e-7) << beta;
  }
}

TEST(MovingLeastSquares, CoincidentPointsGiveTheirMean) {
  for (const SurfaceKind kind : kinds) {
    for (const double beta : betas) {
      const std::vector<WeighedValue> points{{{1, 2}, 0.5, 1}, {{1, 2}, 0.1, 3}, {{-3, 1}, 5, 1}};
      EXPECT_DOUBLE_EQ(through(points, kind, beta, 10).at({1, 2}), 0.2);
      const std::vector<WeighedValue> alone(points.begin(), points.begin() + 2);
      EXPECT_DOUBLE_EQ(through(alone, kind, beta, 10).at({7, -9}), 0.2);
      const Vec2<double> slopes = through(alone, kind, beta, 10).slopes({7, -9});
      EXPECT_NEAR(std::abs(slopes.x) + std::abs(slopes.y), 0, 1e-15);
    }
  }
}

TEST(MovingLeastSquares, CollinearPointsGiveNoSlopeAcrossTheLine) {
  for (const double beta : betas) {
    std::vector<WeighedValue> points;
    for (const double t : {-1.0, 0.1, 0.5, 2.0}) points.push_back({{3 * t + 1, 1 - 2 * t}, 0.4 + 0.3 * t});
    const auto surface = through(points, SurfaceKind::affine, beta, 10);
    for (const double t : {-1.5, -0.3, 0.2, 0.9, 2.1}) {
      for (const double across : {-2.0, 0.0, 0.4}) {
        const FilmPoint at{3 * t + 1 + 2 * across, 1 - 2 * t + 3 * across};
        EXPECT_NEAR(surface.at(at), 0.4 + 0.3 * t, 1e-11) << beta;
        const float x = static_cast<float>(at.x), y = static_cast<float>(at.y);
        float value = 0;
        surface.at(1, &x, &y, &value);
        EXPECT_NEAR(value, 0.4 + 0.3 * t, 1e-4) << beta;
      }
    }
  }
}

TEST(MovingLeastSquares, SlopesAreExactFarFromThePoints) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double beta : betas) {
    std::vector<WeighedValue> two = random_points(4, 2);
    two[0].film_point = {0, -8}, two[0].value = 0;
    two[1].film_point = {0, 8}, two[1].value = 1e-3;
    const auto rising = through(two, SurfaceKind::affine, beta), any = through(random_points(4, 12), kinds[0], beta);
    for (const double far : {1e9, 1e200, infinity, -infinity, std::nan("")}) {
      EXPECT_EQ(rising.slopes({far, 1}).x, 0) << far;
      EXPECT_NEAR(rising.slopes({far, 1}).y, rising.at({far, 1.5}) - rising.at({far, 0.5}), 1e-9) << beta << ' ' << far;
      EXPECT_GT(rising.slopes({far, 1}).y, 1e-5) << beta << ' ' << far;
      EXPECT_EQ(rising.slopes({1, far}), Vec2<double>(0, 0)) << far;
      for (const FilmPoint& place : {FilmPoint{far, 1}, {1, far}, {far, far}}) {
        EXPECT_TRUE(std::isfinite(any.at(place))) << far;
        const Vec2<double> slopes = any.slopes(place);
        EXPECT_TRUE(std::isfinite(slopes.x) && std::isfinite(slopes.y)) << far;
      }
    }
  }
}

TEST(MovingLeastSquares, SlopesAreExactNextToThePoints) {
  for (const SurfaceKind kind : kinds) {
    for (const double beta : betas) {
      auto points = random_points(4, 12);
      points[0].film_point = {0, 0};
      const auto surface = through(points, kind, beta);
      const Vec2<double> at_point = surface.slopes({0, 0});
      const double size = std::hypot(at_point.x, at_point.y);
      for (double r = 1e-3; r > 0; r /= 2) {
        const Vec2<double> beside = surface.slopes({0, r});
        EXPECT_TRUE(std::isfinite(beside.x) && std::isfinite(beside.y)) << name(kind) << beta << ' ' << r;
        if (r > 1e-8 || beta < 2) continue;  // beta 1 has a cusp at each point
        EXPECT_NEAR(std::hypot(beside.x - at_point.x, beside.y - at_point.y), 0, 1e-4 * size + 1e-5)
            << beta << ' ' << r;
      }
    }
  }
}

TEST(MovingLeastSquares, SlopesEqualFiniteDifferences) {
  for (const SurfaceKind kind : kinds) {
    for (const double beta : betas) {
      const auto points = random_points(4, 12);
      const auto surface = through(points, kind, beta);
      for (const auto& at : random_points(5, 50)) {
        const auto& [x, y] = at.film_point;
        const double h = 1e-6;
        const Vec2<double> slopes = surface.slopes(at.film_point);
        EXPECT_NEAR(slopes.x, (surface.at({x + h, y}) - surface.at({x - h, y})) / (2 * h), 1e-6) << name(kind) << beta;
        EXPECT_NEAR(slopes.y, (surface.at({x, y + h}) - surface.at({x, y - h})) / (2 * h), 1e-6) << name(kind) << beta;
      }
      if (beta <= 1.5) continue;
      for (const auto& at : points) {
        const auto& [x, y] = at.film_point;
        const double h = beta < 3 ? 1e-9 : 1e-6;
        const Vec2<double> slopes = surface.slopes(at.film_point);
        const double tolerance = beta < 3 ? 3e-3 : 1e-3;
        EXPECT_NEAR(slopes.x, (surface.at({x + h, y}) - surface.at({x - h, y})) / (2 * h), tolerance)
            << name(kind) << beta;
        EXPECT_NEAR(slopes.y, (surface.at({x, y + h}) - surface.at({x, y - h})) / (2 * h), tolerance)
            << name(kind) << beta;
      }
    }
  }
}

}  // namespace moving_least_squares_test
