// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/film.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "../expect_error.hpp"
#include "../film_at.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {
namespace film_test {

using testing::expect_error;
using testing::film_at;
using Vec = Vec3<double>;

const Film films[] = {film_at(50),
                      film_at(50, radians(8)),
                      film_at(-3, 0, radians(-20)),
                      film_at(120, radians(30), radians(40)),
                      film_at(1e6, radians(-89), radians(89)),
                      film_at(0, radians(1e-12), radians(-1e-12))};

TEST(Film, IsARotation) {
  for (const Film& film : films) {
    const Vec r = film.right(), u = film.up(), n = film.normal();
    EXPECT_NEAR(glm::dot(r, r), 1, 1e-15);
    EXPECT_NEAR(glm::dot(u, u), 1, 1e-15);
    EXPECT_NEAR(glm::dot(r, u), 0, 1e-16);
    const Vec across = glm::cross(r, u) - n;
    EXPECT_NEAR(glm::length(across), 0, 1e-15);
  }
}

TEST(Film, TiltsAboutXFirstAndThenSwingsAboutY) {
  // A quarter of a right angle each: Rx takes e_z to (0, -sin, cos), Ry takes the result to (cos sin, -sin, cos cos).
  const Film film = film_at(0, radians(22.5), radians(45));
  const double s = std::sin(radians(22.5)), c = std::cos(radians(22.5)), h = std::sqrt(0.5);
  EXPECT_NEAR(glm::length(film.normal() - Vec(c * h, -s, c * h)), 0, 1e-15);
  EXPECT_NEAR(glm::length(film.right() - Vec(h, 0, -h)), 0, 1e-15);
  EXPECT_NEAR(glm::length(film.up() - Vec(h * s, c, h * s)), 0, 1e-15);
}

TEST(Film, AngleEqualsTheAngleOfTheNormal) {
  EXPECT_EQ(Film{}.angle(), 0);
  EXPECT_NEAR(film_at(0, radians(8), 0).angle(), radians(8), 1e-15);
  EXPECT_NEAR(film_at(0, 3e-12, 4e-12).angle(), 5e-12, 1e-24);
  EXPECT_NEAR(film_at(0, radians(30), radians(40)).angle(), std::acos(std::cos(radians(30)) * std::cos(radians(40))),
              1e-15);
}

TEST(Film, PointsRoundTrip) {
  for (const Film& film : films) {
    const FilmPoint p{12.5, -7}, back = film.point(film.position(p));
    EXPECT_NEAR(back.x, p.x, 1e-15 * (std::abs(film.z()) + 15));
    EXPECT_NEAR(back.y, p.y, 1e-15 * (std::abs(film.z()) + 15));
    const Plane plane = film.plane();
    EXPECT_NEAR(glm::dot(plane.normal, film.position(p)), plane.offset, 1e-15 * (std::abs(film.z()) + 30));
  }
}

TEST(Film, InItsPlaneRoundTripsForEitherNormal) {
  for (const Film& film : films) {
    for (const double side : {1.0, -1.0}) {
      const Plane plane = film.plane();
      const Film back = film_in({side * plane.normal, side * plane.offset});
      EXPECT_NEAR(back.z(), film.z(), 1e-15 * std::abs(film.z()));
      EXPECT_NEAR(back.tilt_rad, film.tilt_rad, 1e-15);
      EXPECT_NEAR(back.swing_rad, film.swing_rad, 1e-14);
    }
  }
  const Film swung = film_in({{std::sin(0.3), 0, std::cos(0.3)}, 0});
  EXPECT_EQ(swung.tilt_rad, 0);
  const Film upright = film_in({{-0.0, 0, 1}, 5});
  EXPECT_FALSE(std::signbit(upright.tilt_rad) || std::signbit(upright.swing_rad));
}

TEST(Film, InAPlaneAlongTheAxisIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Plane along_axis{{0, 1, 0}, 5}, no_normal{{nan, 0, 1}, 5}, no_offset{{0, 0, 1}, nan};
  expect_error([&] { film_in(along_axis); }, {"film_in", "normal", 0, 1, "offset", 5});
  expect_error([&] { film_in(no_normal); }, {"normal", "nan"});
  expect_error([&] { film_in(no_offset); }, {"offset", "nan"});
}

TEST(Film, RasterIsUpright) {
  const Film film{.width_mm = 36, .height_mm = 24, .columns = 360, .rows = 240, .shift_x_mm = 5, .shift_y_mm = -3};
  const FilmPoint upper_left = film.point(0, 0), lower_right = film.point(360, 240), middle = film.point(180, 120);
  EXPECT_EQ(upper_left.x, 5 + 18);
  EXPECT_EQ(upper_left.y, -3 - 12);
  EXPECT_EQ(lower_right.x, 5 - 18);
  EXPECT_EQ(lower_right.y, -3 + 12);
  EXPECT_EQ(middle.x, 5);
  EXPECT_EQ(middle.y, -3);
  for (const FilmPoint& corner : film.corners()) EXPECT_TRUE(film.contains(corner));
  EXPECT_FALSE(film.contains({5 + 18.001, -3}));
  const Vec2<double> raster = film.raster(film.point(12.25, 200.5));
  EXPECT_NEAR(raster.x, 12.25, 1e-12);
  EXPECT_NEAR(raster.y, 200.5, 1e-12);
}

TEST(Film, HasAMarginAroundItsRaster) {
  Film film{.width_mm = 36, .height_mm = 24, .columns = 360, .rows = 240, .shift_x_mm = 5};
  const double radius = film.radius_mm();
  const FilmPoint beside = film.point(-1.5, 120), corner = film.point(361.5, -1.5);
  EXPECT_FALSE(film.contains(beside));
  film.margin_mm = 0.15;
  EXPECT_TRUE(film.contains(beside));
  EXPECT_TRUE(film.contains(corner));
  EXPECT_FALSE(film.contains(film.point(-1.51, 120)));
  EXPECT_EQ(film.point(-1.5, 120).x, beside.x);
  EXPECT_EQ(film.area_mm2(), 36 * 24);
  EXPECT_GT(film.radius_mm(), radius);
  EXPECT_NEAR(film.raster(film.corners()[0]).x, 361.5, 1e-12);
}

TEST(Film, BatchEqualsSinglePoints) {
  const Film film{.width_mm = 36, .height_mm = 24, .columns = 360, .rows = 240, .shift_y_mm = -3};
  const float raster_x[]{0, 12.5f, 360}, raster_y[]{240, 7, -1};
  float x[3], y[3];
  film.points(3, raster_x, raster_y, x, y);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(x[i], static_cast<float>(film.point(raster_x[i], raster_y[i]).x));
    EXPECT_EQ(y[i], static_cast<float>(film.point(raster_x[i], raster_y[i]).y));
  }
}

TEST(Film, WithoutZHasAxesAndNoPositions) {
  const Film film{.tilt_rad = 0.1};
  EXPECT_NEAR(film.angle(), 0.1, 1e-15);
  expect_error([&] { film.plane(); }, {"film", "z_mm"});
  expect_error([&] { film.position({1, 2}); }, {"film", "z_mm"});
  expect_error([&] { film.point(Vec(0, 0, 0)); }, {"film", "z_mm"});
}

TEST(Film, InAPlaneKeepsItsRectangle) {
  const Film film{.width_mm = 60, .height_mm = 45, .columns = 800, .rows = 600, .shift_x_mm = 2};
  const Film laid = film_in(film_at(80, 0.1, -0.2).plane(), film);
  EXPECT_EQ(laid.width_mm, 60);
  EXPECT_EQ(laid.columns, 800);
  EXPECT_EQ(laid.shift_x_mm, 2);
  EXPECT_NEAR(laid.z(), 80, 1e-13);
}

}  // namespace film_test
}  // namespace petzval
