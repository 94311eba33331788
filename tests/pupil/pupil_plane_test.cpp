// SPDX-License-Identifier: Apache-2.0
#include "pupil/pupil_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace pupil_plane_test {

using testing::data_lens;
using testing::expect_error;
using testing::front_stop_lens;
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(PupilPlane, RaysJoinScenePointAndPupilPoint) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const double pupil_z = pupils(lens).entrance.z;
  const FieldPoint point{radians(25), pupil_z - 1000};
  const Ray<double> ray = PupilPlane(lens, point).ray(3, -4);
  EXPECT_EQ(ray.origin, Vec3<double>(3, -4, pupil_z));
  EXPECT_NEAR(glm::length(ray.direction), 1, 4e-16);
  const double t = (point.z - ray.origin.z) / ray.direction.z;
  EXPECT_NEAR(ray.origin.x + t * ray.direction.x, 0, 1e-12);
  EXPECT_NEAR(ray.origin.y + t * ray.direction.y, 1000 * std::tan(radians(25)), 1e-12);
}

TEST(PupilPlane, IgnoresPointsWithoutBothCoordinates) {
  const PupilPlane plane(front_stop_lens(), {0.3, -infinity});
  const std::vector<double> three(3, 1), two(2, 1);
  for (const bool shorter_x : {false, true}) {
    std::vector<double> out(18, 9);
    plane.rays(shorter_x ? two : three, shorter_x ? three : two,
               {&out[0], &out[3], &out[6], &out[9], &out[12], &out[15]});
    EXPECT_EQ(out[1], 1);
    for (std::size_t last = 2; last < out.size(); last += 3) EXPECT_EQ(out[last], 9) << shorter_x;
  }
}

TEST(PupilPlane, FarPointsTendToInfinity) {
  const Lens lens = front_stop_lens();
  const auto at_infinity = PupilPlane(lens, {radians(40), -infinity}).ray(5, 7);
  EXPECT_NEAR(at_infinity.direction.y, -std::sin(radians(40)), 2e-16);
  for (const double z : {-1e9, -1e15, -1e300}) {
    const auto ray = PupilPlane(lens, {radians(40), z}).ray(5, 7);
    EXPECT_NEAR(ray.direction.x, 5 / -z * std::cos(radians(40)), std::abs(500 / (z * z)) + 1e-30);
    EXPECT_NEAR(ray.direction.y, at_infinity.direction.y, std::abs(7 / z) + 2e-16);
  }
}

TEST(PupilPlane, FacesThePointFrom89DegreesOn) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  EXPECT_FALSE(PupilPlane(lens, {radians(88.9), -infinity}).turned());
  for (const double field : {89.1, 90.0, 110.0, -110.0, 179.0}) {
    const PupilPlane plane(lens, {radians(field), -infinity});
    ASSERT_TRUE(plane.turned()) << field;
    const Ray<double> middle = plane.ray(0, 0), other = plane.ray(1.5, -2.5);
    EXPECT_NEAR(glm::dot(other.origin - middle.origin, middle.direction), 0, 1e-15);
    EXPECT_NEAR(glm::length(other.origin - middle.origin), std::hypot(1.5, 2.5), 4e-15);
    // Seen from the point, x and y have the orientation of the pupil plane.
    EXPECT_GT((other.origin - middle.origin).x, 0);
  }
}

TEST(PupilPlane, FindsThePupilPointOfItsRays) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  for (const double field : {0.0, 50.0, 88.0, 95.0, 110.0}) {
    for (const double azimuth : {0.0, 1.0, -2.5}) {
      const PupilPlane plane(lens, {radians(field), -infinity, azimuth});
      Ray<double> ray = plane.ray(0.7, -1.1);
      ray.origin = ray.origin + ray.direction * 25.0;
      const Vec2<double> p = plane.meet(ray);
      EXPECT_NEAR(p.x, 0.7, 1e-12) << field;
      EXPECT_NEAR(p.y, -1.1, 1e-12) << field;
    }
  }
}

TEST(PupilPlane, AcceptsPlanesNextToTheLensBeyond90Degrees) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  const double pupil_z = pupils(lens).entrance.z, z = pupil_z + 200;
  const Ray<double> ray = PupilPlane(lens, {radians(100), z}).ray(0.4, 0.2);
  const Vec3<double> point{0, -200 * std::tan(radians(100)), z};
  EXPECT_GT(point.y, 0);
  EXPECT_LT(glm::length(glm::cross(point - ray.origin, ray.direction)), 1e-12);
  EXPECT_LT(glm::dot(point - ray.origin, ray.direction), 0);
}

TEST(PupilPlane, RaysOfAPointBehindTheEntrancePupilRunIntoTheLens) {
  // A stop behind the rear focal point has its image in front of the lens and in front of the point.
  Prescription p;
  p.name = "rear stop";
  p.surfaces = {{.radius = 100, .thickness = 4, .medium = {.nd = 1.5}, .semi_diameter = 40},
                {.radius = -100, .thickness = 112, .semi_diameter = 40},
                {.thickness = 50, .semi_diameter = 2, .stop = true}};
  const Lens lens = compile(p);
  const FieldPoint point{0.01, -500};
  const PupilPlane plane(lens, point);
  ASSERT_LT(plane.reciprocal_distance(), 0);
  const Vec3<double> place = plane.centre() + plane.towards() / plane.reciprocal_distance();
  const Ray<double> ray = plane.ray(0.3, -0.2);
  EXPECT_GT(ray.direction.z, 0);
  EXPECT_LT(glm::length(glm::cross(place - ray.origin, ray.direction)), 1e-10);
  EXPECT_LT(glm::length(plane.direction_at({2, 3, 0}) - glm::normalize(Vec3<double>{2, 3, 0} - place)), 1e-14);
  const AimedRay chief = chief_ray(lens, point);
  ASSERT_EQ(chief.status, AimStatus::converged);
  EXPECT_LT(glm::length(glm::cross(place - chief.ray.origin, chief.ray.direction)), 1e-10);
  EXPECT_TRUE(trace(lens, chief.ray).transmitted());
  EXPECT_FALSE(pupil_boundary(lens, point).empty());
}

TEST(PupilPlane, RaysOfAVirtualFilmRunIntoTheLens) {
  Prescription p;
  p.name = "diverging";
  p.surfaces = {{.radius = -100, .thickness = 2, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                {.radius = 100, .thickness = -90, .semi_diameter = 12}};
  const Lens lens = compile(p);
  const Ray<double> ray = PupilPlane::of_film(lens, {0, 1}).ray(0.5, 0);
  EXPECT_LT(ray.direction.z, 0);
  EXPECT_LT(glm::length(glm::cross(Vec3<double>{0, 1, lens.film_z()} - ray.origin, ray.direction)), 1e-12);
  EXPECT_TRUE(trace(lens, ray, {.travel = Travel::to_scene}).transmitted());
  EXPECT_GT(film_irradiance(lens, {}), 0);
}

TEST(PupilPlane, RaysOfAFilmPointRunToTheScene) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const PupilPlane plane = PupilPlane::of_film(lens, {3, -20});
  EXPECT_EQ(plane.travel(), Travel::to_scene);
  const Ray<double> ray = plane.ray(5, 7);
  EXPECT_EQ(ray.origin, Vec3<double>(5, 7, lens.surfaces().back().vertex_z));
  EXPECT_LT(ray.direction.z, 0);
  const Vec3<double> point{3, -20, lens.film_z()};
  EXPECT_LT(glm::length(glm::cross(point - ray.origin, ray.direction)), 1e-13);
  expect_error([&] { PupilPlane::of_film(lens, {std::nan(""), 0}); }, {lens.name(), "film point", "nan"});
  Prescription touching = testing::data_prescription("double_gauss_100mm_f2.0");
  touching.surfaces.back().thickness = 0;
  const Lens in_contact = compile(touching);
  expect_error([&] { PupilPlane::of_film(in_contact, {}); }, {"film", "z", in_contact.film_z(), "last vertex"});
}

TEST(PupilPlane, RefusesInvalidPoints) {
  const Lens lens = front_stop_lens();
  const auto plane = [](const Lens& of, const FieldPoint& point) { return [=] { PupilPlane(of, point); }; };
  const double nan = std::nan("");
  expect_error(plane(lens, {radians(181), -1000}), {"front stop", "scene point", "field", 181, -180, 180});
  expect_error(plane(lens, {nan, -1000}), {"front stop", "scene point", "field", "nan"});
  expect_error(plane(lens, {0, -1000, infinity}), {"front stop", "scene point", "azimuth", "inf"});
  expect_error(plane(lens, {0, nan}), {"front stop", "scene point", "z", "nan"});
  expect_error(plane(lens, {0, infinity}), {"front stop", "scene point", "z", "inf"});
  expect_error(plane(lens, {0, 50}), {"front stop", "scene point", "z", 50, 0, "first surface"});
  expect_error(plane(lens, {0, 0}), {"front stop", "scene point", "z", 0, "entrance pupil"});
  expect_error(plane(lens, {radians(100), -1000}), {"front stop", "scene point", "z", -1000, "field", 100, 0});
  expect_error(plane(lens, {radians(100), 0.1}), {"front stop", "scene point", "z", 0.1});
  // Half a millimetre behind the pupil, rays of this field run inside the glass.
  const Lens fisheye = data_lens("fisheye_6.3mm_f2.8");
  const double just_behind = pupils(fisheye).entrance.z + 0.5;
  expect_error(plane(fisheye, {radians(100), just_behind}), {fisheye.name(), "scene point", "z", "field", 100});

  // The stop lies in the rear focal plane of the preceding surfaces.
  Prescription p;
  p.name = "front stop";
  p.surfaces = {{.radius = 50, .medium = {.nd = 1.5}, .semi_diameter = 10},
                {.thickness = 100, .semi_diameter = 10},
                {.thickness = 20, .semi_diameter = 5, .stop = true}};
  expect_error(plane(compile(p), {0, -1000}), {"front stop", "entrance pupil", "infinity"});
}

}  // namespace pupil_plane_test
}  // namespace petzval
