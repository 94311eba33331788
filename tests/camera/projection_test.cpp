// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <ostream>
#include <string>

#include "../data_lenses.hpp"
#include "../low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/film.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace projection_test {

constexpr double pi = std::numbers::pi;

/// The film point of a ray in the scene.
FilmPoint at_film(const Lens& lens, const Ray<double>& ray) {
  const double t = (lens.film_z() - ray.origin.z) / ray.direction.z;
  return {ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y};
}

struct Case {
  std::string lens;
  Film film;
  double widest;  ///< field, degrees
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.lens; }

class Projections : public ::testing::TestWithParam<Case> {};

// The reference aims chief rays at the stop from the scene.
TEST_P(Projections, EqualAimedChiefRays) {
  const auto& [id, film, widest] = GetParam();
  const Lens lens = testing::data_lens(id);
  const double pupil_z = pupils(lens).entrance.z;
  const testing::Kronecker<3> random(6);
  for (const ModelKind model : {ModelKind::exact_double, ModelKind::exact_float}) {
    const Camera camera(lens, film, {.model = model});
    const double near = (model == ModelKind::exact_double ? 2e-5 : 1e-4) * film.radius_mm();
    int converged = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
      const auto [a, b, c] = random(i);
      const double field = a * widest * pi / 180, azimuth = 2 * pi * b, distance = 200 * std::pow(10, 7 * c);
      const double z = pupil_z - distance * std::cos(field);
      const double across = distance * std::sin(field);
      // Skips points inside or behind the lens.
      if (z > -30 && !(field > pi / 2 && across > 100)) continue;
      const AimedRay chief = chief_ray(lens, {field, z, azimuth});
      if (!chief) continue;
      const FilmPoint wanted = at_film(lens, chief.end.ray);
      const Projection p = camera.project({across * std::sin(azimuth), across * std::cos(azimuth), z});
      SCOPED_TRACE(std::to_string(field * 180 / pi) + " degrees, " + std::to_string(distance) + " mm, " +
                   std::string(name(p.status)));
      if (!film.contains(wanted)) {
        EXPECT_TRUE(p.status == AimStatus::outside_film || p.status == AimStatus::no_ray);
        continue;
      }
      EXPECT_TRUE(p || (chief.status == AimStatus::vignetted && p.status == AimStatus::vignetted));
      if (!p) continue;
      ++converged;
      EXPECT_NEAR(std::hypot(p.film.x - wanted.x, p.film.y - wanted.y), 0, near);
      EXPECT_EQ(p.raster, film.raster(p.film));
    }
    EXPECT_GT(converged, 100);
  }
}

const Film wide{.width_mm = 36, .height_mm = 24};
INSTANTIATE_TEST_SUITE_P(Lenses, Projections,
                         ::testing::Values(Case{"double_gauss_100mm_f2_28deg", wide, 15},
                                           Case{"biogon_35mm_f2.8", wide, 40},
                                           Case{"fisheye_8mm_f2.8", {.width_mm = 24, .height_mm = 24}, 94},
                                           Case{"fisheye_6.3mm_f2.8", {.width_mm = 24, .height_mm = 24}, 108},
                                           Case{"telephoto_392mm_f2.9", wide, 5}));

TEST(Projection, PointsOfCameraRaysProjectToTheirFilmPoint) {
  for (const ModelKind model :
       {ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::thick, ModelKind::polynomial(3),
        ModelKind::polynomial(9), ModelKind::exact_float, ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    const Camera camera(testing::data_lens("double_gauss_100mm_f2_28deg"), wide, {.model = model});
    for (const FilmPoint film : {FilmPoint{0, 0}, FilmPoint{0, 9}, FilmPoint{-17, 3}, FilmPoint{12, -10}}) {
      // Projecting a point of the chief ray returns its film point.
      const CameraRay any = camera.sample({.film = film, .pupil_u = 0.1, .pupil_v = 0.001});
      ASSERT_TRUE(any);
      for (const double distance : {150.0, 4000.0, 1e9}) {
        const Projection first = camera.project(any.ray.origin + any.ray.direction * distance);
        ASSERT_TRUE(first);
        // Points of other rays project near the film point, closer if they are nearer to focus.
        EXPECT_NEAR(std::hypot(first.film.x - film.x, first.film.y - film.y), 0, distance < 1000 ? 4 : 0.5);
        const double column = first.raster.x, row = first.raster.y;
        const FilmPoint again = camera.film().point(column, row);
        EXPECT_NEAR(std::hypot(again.x - first.film.x, again.y - first.film.y), 0, 1e-9);
      }
    }
  }
}

// Points whose chief rays are clipped or end outside the film.
TEST(Projection, ClippedChiefRaysAreExact) {
  for (const char* id :
       {"catadioptric_mangin_1000mm_f7.5", "petzval_portrait_100mm_f3.4", "double_gauss_100mm_f2_28deg"}) {
    SCOPED_TRACE(id);
    const Lens lens = testing::data_lens(id);
    const Film film{.width_mm = 36, .height_mm = 24};
    const Camera camera(lens, film, {.model = ModelKind::exact_double});
    const double pupil_z = pupils(lens).entrance.z;
    const double focal_length = std::abs(first_order(lens).effective_focal_length);
    const double widest = std::min(1.4 * film.radius_mm() / focal_length, 1.5);
    int clipped = 0;
    for (int i = 1; i <= 100; ++i) {
      const double field = widest * i / 100, azimuth = 0.1 * i, distance = 1e6;
      const double z = pupil_z - distance * std::cos(field), across = distance * std::sin(field);
      const AimedRay chief = chief_ray(lens, {field, z, azimuth});
      if (!chief || z > -1000) continue;
      const FilmPoint wanted = at_film(lens, chief.end.ray);
      const Projection p = camera.project({across * std::sin(azimuth), across * std::cos(azimuth), z});
      if (p.status == AimStatus::converged || p.status == AimStatus::no_ray) continue;
      ++clipped;
      EXPECT_NEAR(std::hypot(p.film.x - wanted.x, p.film.y - wanted.y), 0, 2e-5 * film.radius_mm()) << field;
    }
    EXPECT_GT(clipped, 10);
  }
}

TEST(Projection, ImageIsUpright) {
  const Camera camera(testing::data_lens("double_gauss_100mm_f2_28deg"), wide, {.model = ModelKind::exact_double});
  const Projection p = camera.project({300, 200, -5000});
  ASSERT_TRUE(p);
  EXPECT_GT(p.raster[0], wide.columns / 2.0);  // to the right
  EXPECT_LT(p.raster[1], wide.rows / 2.0);     // above
  EXPECT_EQ(camera.project({0, 0, -5000}).raster[0], wide.columns / 2.0);
}

TEST(Projection, FindsPointsThroughCylinders) {
  const Lens lens = testing::data_lens("anamorphic_60mm_2x");
  const Film film{.width_mm = 12, .height_mm = 8};
  for (const ModelKind model : {ModelKind::polynomial(7), ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    const Camera camera(lens, film, {.model = model});
    for (const auto& [x, y] : {std::array{0.0, 0.0}, {150.0, 0.0}, {0.0, 120.0}, {-180.0, 90.0}}) {
      const Vec3<double> point{x, y, -6000};
      const Projection p = camera.project(point);
      ASSERT_TRUE(p) << x << ' ' << y << ' ' << name(p.status);
      // The mean of connections through the whole pupil lies next to the projection.
      double sum_x = 0, sum_y = 0, weight = 0;
      const testing::Kronecker<2> random(7);
      for (std::uint32_t i = 0; i < 20000; ++i) {
        const auto [u, v] = random(i);
        const ImportanceSample s = camera.sample_importance(point, u, v);
        if (!s) continue;
        sum_x += s.importance.film.x / s.pdf, sum_y += s.importance.film.y / s.pdf, weight += 1 / s.pdf;
      }
      ASSERT_GT(weight, 0);
      EXPECT_NEAR(p.film.x, sum_x / weight, 0.1);
      EXPECT_NEAR(p.film.y, sum_y / weight, 0.1);
    }
  }
}

TEST(Projection, TiltedFilmEqualsAimedChiefRays) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  const Film tilted{
      .width_mm = 36, .height_mm = 24, .shift_y_mm = 3, .z_mm = lens.film_z(), .tilt_rad = 0.2, .swing_rad = -0.12};
  const Camera camera(lens, tilted, {.model = ModelKind::exact_double});
  const double pupil_z = pupils(lens).entrance.z;
  const testing::Kronecker<3> random(6);
  int converged = 0;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const auto [a, b, c] = random(i);
    const double field = a * 13 * pi / 180, azimuth = 2 * pi * b, distance = 300 * std::pow(10, 6 * c);
    const double z = pupil_z - distance * std::cos(field), across = distance * std::sin(field);
    const AimedRay chief = chief_ray(lens, {field, z, azimuth});
    if (!chief) continue;
    const auto& [origin, direction] = chief.end.ray;
    const double t = glm::dot(tilted.position({}) - origin, tilted.normal()) / glm::dot(direction, tilted.normal());
    const FilmPoint wanted = tilted.point(origin + t * direction);
    const Projection p = camera.project({across * std::sin(azimuth), across * std::cos(azimuth), z});
    if (!tilted.contains(wanted)) {
      EXPECT_EQ(p.status, AimStatus::outside_film);
      continue;
    }
    EXPECT_TRUE(p || (chief.status == AimStatus::vignetted && p.status == AimStatus::vignetted));
    if (!p) continue;
    ++converged;
    EXPECT_NEAR(std::hypot(p.film.x - wanted.x, p.film.y - wanted.y), 0, 5e-4);
    EXPECT_EQ(p.raster, tilted.raster(p.film));
    const Importance chief_importance = camera.importance(chief.ray);
    ASSERT_TRUE(chief_importance);
    EXPECT_NEAR(std::hypot(chief_importance.film.x - wanted.x, chief_importance.film.y - wanted.y), 0, 1e-9);
  }
  EXPECT_GT(converged, 100);
}

}  // namespace projection_test
}  // namespace petzval
