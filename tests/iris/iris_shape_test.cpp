// SPDX-License-Identifier: Apache-2.0
#include "iris/iris_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "../blades.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "../message.hpp"
#include "iris/iris_edges.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace iris_shape_test {

using iris_detail::IrisShape;
using testing::expect_tokens;
using testing::message;
using testing::room_between_blades;

constexpr double pi = std::numbers::pi;

/// A disc and polygons with straight, rounded and hollow edges.
std::vector<Iris> irises() {
  std::vector<Iris> result{{}};
  for (const int blades : {3, 4, 5, 6, 8, 20}) {
    for (const double roundness : {-1.0, 0.0, 1e-9, 0.3, 0.9}) {
      result.push_back({.blades = blades, .roundness = roundness, .rotation_rad = 0.1 * blades});
    }
  }
  return result;
}

::testing::Message text(const Iris& iris) {
  return ::testing::Message() << iris.blades << " blades, roundness " << iris.roundness;
}

TEST(Iris, AreaEqualsPolygonAndCircularSegments) {
  EXPECT_EQ(iris_area({}), pi);
  for (const int n : {3, 4, 5, 6, 7, 12, 20}) {
    const double straight = n / 2.0 * std::sin(2 * pi / n);
    EXPECT_NEAR(iris_area({.blades = n}) / straight, 1, 1e-15);
    EXPECT_NEAR(iris_area({.blades = n, .roundness = 1, .rotation_rad = 1}) / pi, 1, 1e-15);
    EXPECT_NEAR(iris_area({.blades = n, .roundness = 1 - 1e-12}) / pi, 1, 1e-11);
    if (n >= 6) {
      EXPECT_NEAR(iris_area({.blades = n, .roundness = -1}) / (2 * straight - pi), 1, 1e-13) << n;
    }
    for (const double roundness : {-0.7, -1e-3, 1e-2, 0.2, 0.8}) {
      const double own = pi / n, angle = roundness * (roundness < 0 ? std::min(own, pi / 4 - own / 2) : own);
      const double radius = std::sin(own) / std::sin(angle);
      const double segments = n * radius * radius * (angle - std::sin(angle) * std::cos(angle));
      const double sense = angle < 0 ? -1 : 1;
      EXPECT_NEAR(iris_area({.blades = n, .roundness = roundness}), straight + sense * std::abs(segments), 2e-10);
    }
  }
  EXPECT_NEAR(equal_area_f_number({.blades = 4}, 5.6), 5.6 * std::sqrt(2 / pi), 1e-14);
  for (const double f_number : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)equal_area_f_number({.blades = 6}, f_number), Error) << f_number;
  }
}

// The map from the unit square preserves areas: its Jacobian is the area of the iris.
TEST(IrisShape, MapsEqualAreasToEqualAreas) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    const testing::Kronecker<2> random(2);
    int checked = 0, kept = 0;
    for (std::uint32_t i = 0; i < 500; ++i) {
      const auto at = random(i);
      const double u = at[0], v = at[1];
      constexpr double h = 1e-6;
      const double in_sector = u * std::max(iris.blades, 1) - std::floor(u * std::max(iris.blades, 1));
      if (in_sector < 1e-4 || in_sector > 1 - 1e-4 || v < 1e-3 || v > 1 - h) continue;
      const auto by = [&](double du, double dv) {
        const Vec2<double> after = shape.sample(u + du, v + dv), before = shape.sample(u - du, v - dv);
        return (after - before) / (2 * h);
      };
      const Vec2<double> by_u = by(h, 0), by_v = by(0, h);
      // From +y towards +x the sense is negative.
      const double jacobian = by_v.x * -by_u.y + by_v.y * by_u.x;
      ++checked;
      kept += std::abs(jacobian / shape.area() - 1) < 1e-6;
    }
    EXPECT_GT(checked, 480) << text(iris);
    EXPECT_EQ(kept, checked) << text(iris);
  }
}

TEST(IrisShape, SamplesAreContained) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    const testing::Kronecker<2> random(3);
    for (std::uint32_t i = 0; i < 5000; ++i) {
      const auto [u, v] = random(i);
      const Vec2<double> rim = shape.sample(u, 1), p = shape.sample(u, v);
      EXPECT_TRUE(shape.contains(0.9999999 * p.x, 0.9999999 * p.y));
      EXPECT_TRUE(shape.contains(0.9999999 * rim.x, 0.9999999 * rim.y));
      EXPECT_FALSE(shape.contains(1.0000001 * rim.x, 1.0000001 * rim.y));
      if (!iris.round()) {
        EXPECT_NEAR(room_between_blades(iris, rim.x, rim.y), 0, 1e-12) << text(iris);
      }
      const double x = 2 * u - 1, y = 2 * v - 1, room = room_between_blades(iris, x, y);
      EXPECT_FALSE(shape.contains(5 * (x + std::copysign(1, x)), 5 * y)) << text(iris);
      if (std::abs(room) < 1e-12) continue;
      EXPECT_EQ(shape.contains(x, y), room > 0 && x * x + y * y <= 1) << text(iris);
    }
  }
}

TEST(IrisShape, PositionsMapBackToTheSquare) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    const testing::Kronecker<2> random(7);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const auto [u, v] = random(i);
      const Vec2<double> p = shape.sample(u, v), place = shape.position(p.x, p.y);
      EXPECT_NEAR(place.x, u, 3e-12) << text(iris);
      EXPECT_NEAR(place.y, v, 3e-12) << text(iris);
      EXPECT_GT(shape.position(p.x / std::sqrt(v) * 1.001, p.y / std::sqrt(v) * 1.001).y, 1);
    }
    EXPECT_EQ(shape.position(0, 0).y, 0);
  }
}

TEST(IrisShape, FloatEqualsDouble) {
  for (const Iris& iris : irises()) {
    if (iris.round()) continue;
    const IrisShape shape(iris);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const auto [u, v] = testing::Kronecker<2>(8)(i);
      const auto [x, y] = iris_detail::iris_point(shape.sectors<float>(), static_cast<float>(u), static_cast<float>(v));
      const Vec2<double> p = shape.sample(static_cast<float>(u), static_cast<float>(v));
      EXPECT_NEAR(x, p.x, 2e-6) << text(iris) << " " << u;
      EXPECT_NEAR(y, p.y, 2e-6) << text(iris) << " " << u;
    }
  }
}

TEST(IrisShape, StartsAtTheFirstCornerAndRunsClockwise) {
  for (const Iris& iris : irises()) {
    const IrisShape shape(iris);
    const double corner = iris.round() ? 0 : -iris.rotation_rad;
    for (const double u : {0.0, 1.0}) {
      const Vec2<double> p = shape.sample(u, 1);
      EXPECT_NEAR(p.x, std::sin(corner), 1e-12) << text(iris);
      EXPECT_NEAR(p.y, std::cos(corner), 1e-12) << text(iris);
    }
    double last = -1e-9;
    for (int i = 1; i < 100; ++i) {
      const Vec2<double> p = shape.sample(i / 100.0, 0.7);
      double angle = std::atan2(p.x, p.y) - corner;
      angle -= 2 * pi * std::floor(angle / (2 * pi));
      EXPECT_GT(angle, last) << text(iris);
      last = angle;
    }
  }
}

TEST(IrisShape, IsMirroredInAnImageUpsideDown) {
  for (const Iris& iris : irises()) {
    for (const auto& [along_x, along_y] : {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
      const IrisShape shape(iris), image(iris_detail::upside_down(iris, along_x, along_y));
      EXPECT_NEAR(image.area(), shape.area(), 1e-15);
      for (std::uint32_t i = 0; i < 100; ++i) {
        const auto [u, v] = testing::Kronecker<2>(4)(i);
        const double x = 2 * u - 1, y = 2 * v - 1;
        EXPECT_EQ(shape.contains(x, y), image.contains(along_x ? -x : x, along_y ? -y : y)) << text(iris);
      }
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

TEST(IrisShape, RoundIrisIsACircle) {
  EXPECT_LT(farthest_from_the_circle<float>(), 2e-7);
  EXPECT_LT(farthest_from_the_circle<double>(), 1e-15);  // half of it is the rounding of the angle
}

TEST(IrisShape, RefusesInvalidIrises) {
  const auto refusal = [](const Iris& iris) { return message([&] { IrisShape{iris}; }); };
  for (const int blades : {-1, 1, 2, 21}) {
    expect_tokens(refusal({.blades = blades}), {"iris", "blades", blades});
  }
  expect_tokens(refusal({.blades = 3, .roundness = -1.01}), {"iris", "roundness", -1.01});
  expect_tokens(refusal({.blades = 3, .rotation_rad = std::numeric_limits<double>::infinity()}),
                {"iris", "rotation_rad", "inf"});
}

}  // namespace iris_shape_test
}  // namespace petzval
