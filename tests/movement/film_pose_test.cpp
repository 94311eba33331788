// SPDX-License-Identifier: Apache-2.0
#include "petzval/movement/film_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "../message.hpp"
#include "petzval/core/units.hpp"

namespace petzval {
namespace {

using testing::message;
using Vec = Vec3<double>;

const FilmPose poses[] = {{50, 0, 0},
                          {50, radians(8), 0},
                          {-3, 0, radians(-20)},
                          {120, radians(30), radians(40)},
                          {1e6, radians(-89), radians(89)},
                          {0, radians(1e-12), radians(-1e-12)}};

TEST(FilmPose, IsARotation) {
  for (const FilmPose& pose : poses) {
    const Vec r = pose.right(), u = pose.up(), n = pose.normal();
    EXPECT_NEAR(glm::dot(r, r), 1, 1e-15);
    EXPECT_NEAR(glm::dot(u, u), 1, 1e-15);
    EXPECT_NEAR(glm::dot(r, u), 0, 1e-16);
    const Vec across = glm::cross(r, u) - n;
    EXPECT_NEAR(glm::length(across), 0, 1e-15);
  }
}

TEST(FilmPose, TiltsAboutXFirstAndThenSwingsAboutY) {
  // A quarter of a right angle each: Rx takes e_z to (0, -sin, cos), Ry takes that to (cos sin, -sin, cos cos).
  const FilmPose pose{0, radians(22.5), radians(45)};
  const double s = std::sin(radians(22.5)), c = std::cos(radians(22.5)), h = std::sqrt(0.5);
  EXPECT_NEAR(glm::length(pose.normal() - Vec(c * h, -s, c * h)), 0, 1e-15);
  EXPECT_NEAR(glm::length(pose.right() - Vec(h, 0, -h)), 0, 1e-15);
  EXPECT_NEAR(glm::length(pose.up() - Vec(h * s, c, h * s)), 0, 1e-15);
}

TEST(FilmPose, AngleIsThatOfTheNormal) {
  EXPECT_EQ(FilmPose{}.angle(), 0);
  EXPECT_NEAR((FilmPose{0, radians(8), 0}).angle(), radians(8), 1e-15);
  EXPECT_NEAR((FilmPose{0, 3e-12, 4e-12}).angle(), 5e-12, 1e-24);
  EXPECT_NEAR((FilmPose{0, radians(30), radians(40)}).angle(), std::acos(std::cos(radians(30)) * std::cos(radians(40))),
              1e-15);
}

TEST(FilmPose, PointsComeBack) {
  for (const FilmPose& pose : poses) {
    const FilmPoint p{12.5, -7}, back = pose.point(pose.at(p));
    EXPECT_NEAR(back.x, p.x, 1e-15 * (std::abs(pose.film_z) + 15));
    EXPECT_NEAR(back.y, p.y, 1e-15 * (std::abs(pose.film_z) + 15));
    const Plane plane = pose.plane();
    EXPECT_NEAR(glm::dot(plane.normal, pose.at(p)), plane.offset, 1e-15 * (std::abs(pose.film_z) + 30));
  }
}

TEST(FilmPose, OfAPlaneGivesThePoseBackWhicheverWayTheNormalPoints) {
  for (const FilmPose& pose : poses) {
    for (const double side : {1.0, -1.0}) {
      const Plane plane = pose.plane();
      const FilmPose back = film_pose({side * plane.normal, side * plane.offset});
      EXPECT_NEAR(back.film_z, pose.film_z, 1e-15 * std::abs(pose.film_z));
      EXPECT_NEAR(back.tilt_rad, pose.tilt_rad, 1e-15);
      EXPECT_NEAR(back.swing_rad, pose.swing_rad, 1e-14);
    }
  }
  const FilmPose swung = film_pose({{std::sin(0.3), 0, std::cos(0.3)}, 0});
  EXPECT_EQ(swung.tilt_rad, 0);
  const FilmPose upright = film_pose({{-0.0, 0, 1}, 5});
  EXPECT_FALSE(std::signbit(upright.tilt_rad) || std::signbit(upright.swing_rad));
}

TEST(FilmPose, OfAPlaneAlongTheAxisIsRefused) {
  EXPECT_EQ(message([] {
              film_pose({{0, 1, 0}, 5});
            }),
            "film_pose: the plane has the normal (0, 1, 0) and the offset 5 mm, wanted finite ones and a plane that "
            "crosses the axis");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message([&] { film_pose({{nan, 0, 1}, 5}); }), "no error");
  EXPECT_NE(message([&] { film_pose({{0, 0, 1}, nan}); }), "no error");
}

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

}  // namespace
}  // namespace petzval
