// SPDX-License-Identifier: Apache-2.0
// Samples of tilted films, compared with positions in space.
#include "camera/tilted_film.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "camera/ray_model.hpp"
#include "camera_parts.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace tilted_film_test {

using camera_detail::TiltedFilm;
using testing::CameraParts;
using testing::expect_error;

using testing::pose_of;
using testing::random_samples;
using testing::shifted;
using testing::tilted_by;
using testing::wide;

// A film tilted by 1e-9 degrees has the rays, weights and densities of an upright film, up to the errors of two tables.
TEST(TiltedFilm, TinyTiltEqualsUprightFilm) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  for (const ModelKind model : models()) {
    const Camera upright(lens, shifted, {.model = model});
    const Camera tilted(lens, tilted_by(shifted, 1e-9, -1e-9), {.model = model});
    const testing::Kronecker<2> random(3);
    for (const FilmPoint& film : {FilmPoint{0, 0}, FilmPoint{-20.5, 17.5}, FilmPoint{14, -5}}) {
      double weights[2] = {0, 0}, area[2] = {0, 0};
      constexpr std::uint32_t count = 4096;
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto [u, v] = random(i);
        int side = 0;
        for (const Camera* camera : {&upright, &tilted}) {
          const CameraRay ray = camera->sample({film, u, v});
          weights[side] += ray.weight / count;
          area[side++] += ray ? 1 / ray.pdf_pupil / count : 0;
        }
      }
      EXPECT_NEAR(weights[1] / weights[0], 1, 1e-3) << name(model);
      EXPECT_NEAR(area[1] / area[0], 1, 1e-3) << name(model);
    }
  }
}

/// Pupil sample of a pinhole: the sample of the exit pupil of the upright model, projected from the film point into the
/// plane of the pupil.
PupilSample pinhole_sample(const Lens& lens, const Film& film, const FilmPupilTable& pupil_table,
                           const CameraSample& s) {
  const Vec3<double> from = pose_of(lens, film).position(s.film);
  const TwoPlanes& space = pupil_table.space();
  const double exit_z = pupils(lens, s.wavelength).exit.z;
  const auto along = [](const Vec3<double>& a, const Vec3<double>& b, double z) {
    return a + (b - a) * ((z - a.z) / (b.z - a.z));
  };
  const Vec3<double> chief = along(from, {0, 0, exit_z}, space.film_z);
  const PupilSample p = pupil_table.sample({chief.x, chief.y}, s.pupil_u, s.pupil_v, s.wavelength);
  const Vec3<double> exit = along(chief, {p.x, p.y, space.pupil_z}, exit_z), seen = along(from, exit, space.pupil_z);
  const double larger = (space.pupil_z - from.z) / (exit_z - from.z) * (exit_z - chief.z) / (space.pupil_z - chief.z);
  return {seen.x, seen.y, p.area * larger * larger};
}

// The densities of samples equal densities derived from the positions of film point and pupil sample, and the densities
// of the reversed rays.
TEST(TiltedFilm, DensitiesEqualPositionsInSpace) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  for (const ModelKind model : models()) {
    const CameraParts parts(lens, tilted_by(shifted, 14, -9), model);
    const Camera camera(lens, tilted_by(shifted, 14, -9), {.model = model});
    const TiltedFilm& tilted = *parts.tilted;
    const Film pose = pose_of(lens, camera.film());
    auto samples = random_samples(camera.film(), 60);
    samples.run(camera);
    int checked = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const CameraSample s = samples.one(i);
      const PupilSample p = model == ModelKind::pinhole
                                ? pinhole_sample(lens, camera.film(), parts.pupils(), s)
                                : tilted.pupils().sample(tilted.plane(0).virtual_point(s.film), s.pupil_u, s.pupil_v);
      const Vec3<double> along = Vec3<double>{p.x, p.y, parts.pupils().space().pupil_z} - pose.position(s.film);
      const double length = glm::length(along), pdf = std::pow(length, 3) / (p.area * std::abs(along.z));
      EXPECT_NEAR(samples.pdf_pupil[i] * p.area, 1, 1e-9);
      EXPECT_NEAR(samples.pdf_direction[i] / pdf, 1, 1e-9) << name(model);
      if (samples.fates[i] != RayFate::transmitted) continue;
      EXPECT_NEAR(samples.weights[i] * pdf * length / -glm::dot(along, pose.normal()), 1, 1e-9) << name(model);
      if (model == ModelKind::pinhole) continue;
      const Importance met = camera.importance({samples.ray(i).origin, -samples.ray(i).direction});
      if (!met) continue;  // a float ray next to a rim may not return
      ++checked;
      const double eps = model == ModelKind::exact_double || model <= ModelKind::thick ? 1e-9 : 2e-3;
      EXPECT_NEAR(std::hypot(met.film.x - s.film.x, met.film.y - s.film.y), 0, 100 * eps) << name(model);
      EXPECT_NEAR(met.we / (met.pdf_position * met.pdf_direction) / samples.weights[i], 1, eps) << name(model);
      EXPECT_NEAR(met.pdf_pupil / samples.pdf_pupil[i], 1, eps);
    }
    EXPECT_GT(checked, model == ModelKind::pinhole ? -1 : 50) << name(model);
  }
}

TEST(TiltedFilm, RaysFromBehindHaveNoWeight) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  for (const ModelKind model : {ModelKind::thick, ModelKind::exact_float, ModelKind::exact_double}) {
    const Camera camera(lens, tilted_by({.width_mm = 4, .height_mm = 4}, 80, 0), {.model = model});
    auto samples = random_samples(camera.film(), 500);
    auto in_float = random_samples<float>(camera.film(), 500);
    samples.run(camera), in_float.run(camera);
    int dark = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(samples.weights[i] > 0, samples.fates[i] == RayFate::transmitted) << name(model);
      EXPECT_EQ(in_float.weights[i] > 0, in_float.fates[i] == RayFate::transmitted) << name(model);
      dark += samples.weights[i] == 0;
    }
    EXPECT_GT(dark, 20) << name(model);
  }
}

// The film and the plane of focus of a thin lens intersect in the plane of the lens. With 1/s + 1/s' = 1/f, film points
// (y, s' + y tan(tilt)) have images on one plane, and all rays of a film point meet in its image.
TEST(TiltedFilm, ObeysTheScheimpflugPrinciple) {
  const Lens lens = with_focus(testing::data_lens("double_gauss_100mm_f2.0"), 2000);
  const Film film = tilted_by(wide, 7, -4);
  const Camera camera(lens, film, {.model = ModelKind::thin});
  const auto f = testing::cardinal_points(testing::CameraParts(lens, film, ModelKind::thin).model);
  const Film pose = pose_of(lens, film);
  auto samples = random_samples(film, 400);
  constexpr int rays = 16;
  std::vector<Vec3<double>> images;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3<double> place = pose.position({samples.film_x[i], samples.film_y[i]});
    // The image from the distances to the principal planes.
    const double behind = place.z - f.rear_principal_z;
    const double before = 1 / (1 / f.focal_length - 1 / behind);
    const Vec3<double> image{-place.x * before / behind, -place.y * before / behind, f.front_principal_z - before};
    images.push_back(image);
    int passed = 0;
    for (int k = 0; k < rays; ++k) {
      const CameraRay ray = camera.sample({{samples.film_x[i], samples.film_y[i]}, (k + 0.5) / rays, 0.9});
      if (!ray) continue;
      ++passed;
      const auto& [origin, direction] = ray.ray;
      const Vec3<double> to = image - origin;
      EXPECT_NEAR(glm::length(glm::cross(to, direction)) / before, 0, 1e-10);
    }
    EXPECT_GT(passed, rays / 2);
  }
  // All images lie on one tilted plane.
  const auto side = [&](std::size_t a, std::size_t b, std::size_t c) {
    return glm::normalize(glm::cross(images[b] - images[a], images[c] - images[a]));
  };
  const Vec3<double> normal = side(0, 1, 2);
  for (const auto& image : images) EXPECT_NEAR(glm::dot(image - images[0], normal) / 2000, 0, 1e-10);
  EXPECT_LT(std::abs(normal.z), 0.7);
}

TEST(TiltedFilm, RefusesFilmsInsideTheLens) {
  const auto camera = [](const char* id, const Film& film, ModelKind model = ModelKind::exact_float) {
    return [=] { Camera(testing::data_lens(id), film, {.model = model}); };
  };
  const char *const gauss = "double_gauss_100mm_f2.0", *const fisheye = "fisheye_6.3mm_f2.8";
  EXPECT_NO_THROW(camera(gauss, tilted_by(wide, 30, 0))());
  expect_error(camera(gauss, tilted_by({.width_mm = 36, .height_mm = 240}, 40, 0)), {"film", "corner", -18, -120});
  expect_error(camera(gauss, tilted_by(wide, 90, 0)), {"film", "tilt_rad", radians(90.0)});
  expect_error(camera(gauss, tilted_by(wide, std::nan(""), 0)), {"film", "tilt_rad", "nan"});
  expect_error(camera(fisheye, tilted_by({.width_mm = 20, .height_mm = 20}, 45, 0), ModelKind::thin),
               {"corner", -10, "pupil"});
}

}  // namespace tilted_film_test
}  // namespace petzval
