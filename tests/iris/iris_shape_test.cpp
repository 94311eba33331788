// SPDX-License-Identifier: Apache-2.0
#include "iris/iris_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../message.hpp"
#include "core/low_discrepancy.hpp"

namespace petzval {
namespace {

using iris_detail::IrisShape;
using testing::message;

constexpr double pi = std::numbers::pi;

/// An edge across the direction of an angle from +x towards +y.
IrisEdge edge(double angle, double distance) { return {std::cos(angle), std::sin(angle), distance}; }

/// The disc, regular polygons, one with a corner at +y, and one without symmetry that has an edge outside.
std::vector<Iris> irises() {
  std::vector<Iris> result{{}};
  for (const int blades : {3, 4, 5, 8, 20}) result.push_back(regular_iris(blades, 0.1 * blades));
  result.push_back(regular_iris(6, pi / 3));
  result.push_back({{edge(0.3, 0.5), edge(1.9, 0.3), edge(3.2, 0.45), edge(4.9, 0.2), edge(4.0, 0.95)}});
  return result;
}

TEST(IrisShape, HasTheAreaAndTheMomentsOfARegularPolygon) {
  const auto expect = [](const Iris& iris, double area, double mean_square) {
    const IrisShape shape(iris);
    EXPECT_NEAR(shape.area() / area, 1, 1e-14);
    constexpr std::uint32_t count = 1 << 16;
    const core_detail::Kronecker<2> random(1);
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [u, v] = random(i);
      const Vec2<double> p = shape.sample(u, v);
      x += p.x / count, y += p.y / count;
      xx += p.x * p.x / count, yy += p.y * p.y / count, xy += p.x * p.y / count;
    }
    for (const double zero : {x, y, xy}) EXPECT_NEAR(zero, 0, 1e-4);
    EXPECT_NEAR(xx, mean_square, 1e-4);
    EXPECT_NEAR(yy, mean_square, 1e-4);
  };
  expect({}, pi, 0.25);
  for (const int n : {3, 5, 6, 9, 20}) {
    expect(regular_iris(n, 0.2), n / 2.0 * std::sin(2 * pi / n), (2 + std::cos(2 * pi / n)) / 12);
  }
}

// The map of the unit square keeps areas everywhere: its Jacobian is the area of the iris.
TEST(IrisShape, MapsEqualAreasToEqualAreas) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    const core_detail::Kronecker<2> random(2);
    int checked = 0;
    for (std::uint32_t i = 0; i < 500; ++i) {
      const auto at = random(i);
      const double u = at[0], v = at[1];
      constexpr double h = 1e-6;
      if (u < h || u > 1 - h || v < 1e-3 || v > 1 - h) continue;
      const auto by = [&](double du, double dv) {
        const Vec2<double> after = shape.sample(u + du, v + dv), before = shape.sample(u - du, v - dv);
        return (after - before) / (2 * h);
      };
      const Vec2<double> by_u = by(h, 0), by_v = by(0, h);
      // From +y towards +x is the negative sense.
      const double jacobian = by_v.x * -by_u.y + by_v.y * by_u.x;
      const bool at_corner = std::abs(jacobian / shape.area() - 1) > 1e-4;
      checked += !at_corner;
    }
    EXPECT_GT(checked, 480) << iris.edges.size() << " edges";
  }
}

TEST(IrisShape, SamplesWhatItContains) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    const core_detail::Kronecker<2> random(3);
    std::uint32_t inside = 0;
    constexpr std::uint32_t count = 40000;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [u, v] = random(i);
      const Vec2<double> rim = shape.sample(u, 1), p = shape.sample(u, v);
      EXPECT_TRUE(shape.contains(0.9999999 * p.x, 0.9999999 * p.y));
      EXPECT_TRUE(shape.contains(0.9999999 * rim.x, 0.9999999 * rim.y));
      EXPECT_FALSE(shape.contains(1.0000001 * rim.x, 1.0000001 * rim.y));
      const double x = 2 * u - 1, y = 2 * v - 1;
      bool within = x * x + y * y <= 1;
      for (const IrisEdge& e : iris.edges) within = within && x * e.nx + y * e.ny <= e.distance;
      EXPECT_EQ(shape.contains(x, y), within);
      inside += within;
    }
    EXPECT_NEAR(4.0 * inside / count, shape.area(), 3e-3);
  }
}

TEST(IrisShape, BeginsAtTheTopAndRunsToTheRight) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    double last = -1e-9;
    for (int i = 0; i < 100; ++i) {
      const Vec2<double> p = shape.sample(i / 100.0, 0.7);
      double angle = std::atan2(p.x, p.y);
      if (angle < -1e-12) angle += 2 * pi;
      EXPECT_GT(angle, last);
      last = angle;
    }
    for (const double u : {0.0, 1.0}) {
      EXPECT_NEAR(shape.sample(u, 0.7).x, 0, 1e-14);
      EXPECT_GT(shape.sample(u, 0.7).y, 0);
    }
  }
}

TEST(IrisShape, IsTurnedByHalfATurnInAnImageUpsideDown) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris), image(iris_detail::upside_down(iris));
    EXPECT_NEAR(image.area(), shape.area(), 1e-15);
    for (std::uint32_t i = 0; i < 100; ++i) {
      const auto [x, y] = core_detail::Kronecker<2>(4)(i);
      EXPECT_EQ(shape.contains(2 * x - 1, 2 * y - 1), image.contains(1 - 2 * x, 1 - 2 * y));
    }
  }
}

template <class R>
double farthest_from_the_circle() {
  double farthest = 0;
  for (int i = 0; i <= 10000; ++i) {
    const R u = static_cast<R>(i) / 10000;
    const auto [x, y] = iris_detail::circle_point(u);
    const double angle = 2 * pi * static_cast<double>(u);
    farthest = std::max(farthest, std::hypot(x - std::sin(angle), y - std::cos(angle)));
  }
  return farthest;
}

TEST(IrisShape, KnowsTheCircle) {
  EXPECT_LT(farthest_from_the_circle<float>(), 2e-7);
  EXPECT_LT(farthest_from_the_circle<double>(), 1e-15);  // half of it the angle's own rounding
}

TEST(IrisShape, RefusesWhatIsNoPolygonWithinTheRim) {
  const auto refusal = [](const Iris& iris) { return message([&] { IrisShape{iris}; }); };
  EXPECT_EQ(refusal({{edge(2, 0), edge(0, 0.5), edge(4, 0.5)}}),
            "iris: edge 0: distance is 0, wanted a positive one: the axis within the iris");
  EXPECT_EQ(
      refusal({{edge(0, 0.5)}}),
      "iris: edge 0: it reaches inf semi-diameters from the axis, wanted a polygon with its corners within the rim");
  const double right = pi / 2;
  EXPECT_EQ(
      refusal({{edge(0, 0.8), edge(right, 0.8), edge(2 * right, 0.8), edge(3 * right, 0.8)}}),
      "iris: edge 0: it reaches 1.13137 semi-diameters from the axis, wanted a polygon with its corners within the "
      "rim");
  EXPECT_EQ(refusal({{edge(0, 0.8), edge(right, 0.6), edge(2 * right, 0.8), edge(3 * right, 0.6)}}), "no error");
}

}  // namespace
}  // namespace petzval
