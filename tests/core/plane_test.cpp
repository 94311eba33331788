// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/geometry.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace petzval {
namespace plane_test {

using Vec = Vec3<double>;

TEST(LineAt, LiesInBothPlanesNearestToTheAxis) {
  const Plane plane{glm::normalize(Vec(1, -2, 3)), 20};
  for (const double z : {-1000.0, 0.0, 7.5}) {
    const auto line = line_at(plane, z);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->point.z, z);
    EXPECT_NEAR(glm::dot(plane.normal, line->point), plane.offset, 1e-12);
    EXPECT_NEAR(glm::dot(plane.normal, line->direction), 0, 1e-16);
    EXPECT_NEAR(glm::dot(line->direction, line->direction), 1, 1e-15);
    EXPECT_NEAR(line->point.x * line->direction.x + line->point.y * line->direction.y, 0, 1e-12);
    EXPECT_EQ(line->direction.z, 0);
    EXPECT_GT(line->direction.x, 0);
  }
  EXPECT_EQ(line_at({{1, 0, 0}, 3}, 5)->direction, Vec(0, 1, 0));
  EXPECT_EQ(line_at({{-1, 0, 0}, 3}, 5)->direction, Vec(0, 1, 0));
  EXPECT_EQ(line_at({{-1, 0, 0}, 3}, 5)->point, Vec(-3, 0, 5));
  EXPECT_FALSE(line_at({{0, 0, 1}, 3}, 5));
}

}  // namespace plane_test
}  // namespace petzval
