// SPDX-License-Identifier: Apache-2.0
// Cameras whose focus depends on the film point: focal surfaces and expressive lenses.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../low_discrepancy.hpp"
#include "camera_parts.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"
#include "settings.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace local_focus_test {

using testing::aberrations;
using testing::pose_of;
using testing::shifted;
using testing::surface_of;
using testing::tilted_by;
using testing::wide;

const std::array first_order{ModelKind::thin, ModelKind::thick, ModelKind::thin_two_disc};

Lens double_gauss() { return testing::data_lens("double_gauss_100mm_f2_28deg"); }

struct Setting {
  std::string what;
  CameraOptions options;
  Film film;
};

/// Surfaces, extents and expressive lenses on upright, tilted and travelling films.
std::vector<Setting> settings(const Lens& lens, const std::vector<ModelKind>& models) {
  std::vector<Setting> result;
  Film travels = tilted_by(shifted, -4, 2);
  travels.travel_mm = 1;
  for (const auto& [where, film] : {std::pair<std::string, Film>{"upright", wide},
                                    {"tilted", tilted_by(shifted, 7, -5)},
                                    {"travelling", travels}}) {
    for (const ModelKind model : models) {
      const std::string of = std::string(name(model)) + ", " + where;
      result.push_back({of + ", surface", {.model = model, .focal_surface = surface_of(lens, film, false)}, film});
      result.push_back({of + ", extents", {.model = model, .focal_surface = surface_of(lens, film, true)}, film});
      result.push_back({of + ", lens", {.model = model, .expressive = aberrations()}, film});
      result.push_back({of + ", all",
                        {.model = model, .focal_surface = surface_of(lens, film, true), .expressive = aberrations()},
                        film});
    }
  }
  return result;
}

Vec3<double> in_plane(const Ray<double>& ray, double z) {
  return ray.origin + ray.direction * ((z - ray.origin.z) / ray.direction.z);
}

// In every first-order model and film pose, the rays of a film point meet on the surface.
TEST(LocalFocus, RaysMeetOnTheFocalSurface) {
  const Lens lens = double_gauss();
  const testing::Kronecker<4> random(5);
  for (const Film& film : {wide, tilted_by(shifted, 7, -5)}) {
    for (const bool extents : {false, true}) {
      const FocalSurface surface = surface_of(lens, film, extents);
      for (const ModelKind model : first_order) {
        const Camera camera(lens, film, {.model = model, .focal_surface = surface});
        for (std::uint32_t i = 0; i < 50; ++i) {
          const auto [x, y, u, v] = random(i);
          const FilmPoint place = film.point(x * film.columns, y * film.rows);
          const double inverse = surface.at(place).inverse_distance, distance = 1 / inverse;
          const CameraRay one = camera.sample({place, u, v}), other = camera.sample({place, u + 0.5, 1 - v});
          if (!one || !other) continue;
          if (inverse == 0) {  // infinity, where the surface ends
            EXPECT_LT(glm::length(one.ray.direction - other.ray.direction), 1e-12);
            continue;
          }
          const double z = surface.origin_z() - distance;
          const Vec3<double> apart = in_plane(one.ray, z) - in_plane(other.ray, z);
          EXPECT_LT(glm::length(apart), 1e-9 * std::abs(distance) + 1e-9) << name(model) << " at " << distance;
          // At twice the distance the rays are apart.
          EXPECT_GT(glm::length(in_plane(one.ray, 2 * z) - in_plane(other.ray, 2 * z)), 1e-3);
        }
      }
    }
  }
}

TEST(LocalFocus, ExtentsScaleBlurAndKeepExposure) {
  const Lens lens = double_gauss();
  const auto with = [&](double stops) {
    const std::array points{FocalPoint{.film_point = {0, 0}, .inverse_distance = 1 / 2000., .extent_stops = stops}};
    return Camera(
        lens, wide,
        {.model = ModelKind::thick, .focal_surface = FocalSurface(thick_lens(lens), pose_of(lens, wide), points)});
  };
  const Camera plain = with(0), closed = with(4), open = with(-2);
  for (const FilmPoint place : {FilmPoint{0, 0}, FilmPoint{-15, 8}}) {
    const auto blur = [&](const Camera& camera) {
      const auto at = [&](double u) { return in_plane(camera.sample({place, u, 0.9}).ray, -5000); };
      return glm::length(at(0.1) - at(0.6));
    };
    EXPECT_NEAR(blur(closed) / blur(plain), 0.25, 1e-9);
    EXPECT_NEAR(blur(open) / blur(plain), 2, 1e-9);
    EXPECT_EQ(closed.sample({place, 0.3, 0.7}).weight, plain.sample({place, 0.3, 0.7}).weight);
  }
}

// Importance recovers film point, weight and density of a camera sample from its ray.
TEST(LocalFocus, SceneAndFilmAreInverse) {
  const Lens lens = double_gauss();
  const testing::Kronecker<5> random(2);
  for (const auto& [what, options, film] :
       settings(lens, {ModelKind::thin, ModelKind::thick, ModelKind::thin_two_disc})) {
    const Camera camera(lens, film, options);
    EXPECT_LT(camera.focal_steepness(), 0.7) << what;
    EXPECT_GT(camera.focal_steepness(), 0.001) << what;
    int seen = 0;
    for (std::uint32_t i = 0; i < 40; ++i) {
      const auto [x, y, u, v, time] = random(i);
      const FilmPoint place = film.point(x * film.columns, y * film.rows);
      const CameraSample sample{place, u, v, {}, time};
      const CameraRay ray = camera.sample(sample);
      if (!ray) continue;
      ++seen;
      const Importance found = camera.importance({ray.ray.origin, -ray.ray.direction}, {}, time);
      ASSERT_TRUE(found) << what << ", sample " << i << ": " << name(found.fate);
      EXPECT_NEAR(std::hypot(found.film.x - place.x, found.film.y - place.y), 0, 1e-8) << what;
      EXPECT_NEAR(found.we / (found.pdf_position * found.pdf_direction) / ray.weight, 1, 1e-8) << what;
      EXPECT_NEAR(found.pdf_pupil / ray.pdf_pupil, 1, 1e-8) << what;
    }
    EXPECT_GT(seen, 20) << what;
  }
}

// Connections sample the pupil of the scene point, not its bounding box.
TEST(LocalFocus, MostConnectionsArrive) {
  const Lens lens = double_gauss();
  const testing::Kronecker<5> random(3);
  for (const auto& [what, options, film] : settings(lens, {ModelKind::thin, ModelKind::thick})) {
    const Camera camera(lens, film, options);
    int sent = 0, arrived = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
      const auto [x, y, z, u, v] = random(i);
      const double away = 1000 + 4000 * z;
      const Vec3<double> point{0.1 * (x - 0.5) * away, 0.1 * (y - 0.5) * away, -away};
      ++sent;
      const ImportanceSample found = camera.sample_importance(point, u, v);
      arrived += found && found.importance.we > 0;
    }
    // Connections sample the widest pupil; an extent of two stops makes its area four times as large.
    const bool extents = what.ends_with("extents") || what.ends_with("all");
    EXPECT_GT(arrived, (extents ? 0.28 : 0.73) * sent) << what;
  }
}

// The Jacobian is computed by finite differences of film point and pupil sample.
TEST(LocalFocus, DensitiesEqualTheJacobianOfTheRays) {
  const Lens lens = double_gauss();
  for (const auto& [what, options, film] : settings(lens, {ModelKind::thin, ModelKind::thick})) {
    const Camera camera(lens, film, options);
    for (const auto& [u, v, place] : {std::tuple{0.2, 0.3, FilmPoint{-9, 4}}, {0.7, 0.8, FilmPoint{10, 3}}}) {
      // Height and slope in a plane across the axis, by film x and y, u and v.
      const auto at = [&](const std::array<double, 4>& s) -> std::array<double, 4> {
        const Ray<double> ray = camera.sample({{s[0], s[1]}, s[2], s[3]}).ray;
        const Vec3<double> point = in_plane(ray, -100);
        return {point.x, point.y, ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
      };
      const std::array<double, 4> middle{place.x, place.y, u, v}, step{1e-3, 1e-3, 1e-5, 1e-5};
      std::array<std::array<double, 4>, 4> by;
      for (std::size_t k = 0; k < 4; ++k) {
        auto before = middle, behind = middle;
        before[k] -= step[k], behind[k] += step[k];
        const auto from = at(before), to = at(behind);
        for (std::size_t j = 0; j < 4; ++j) by[k][j] = (to[j] - from[j]) / (2 * step[k]);
      }
      double determinant = 1;
      for (std::size_t k = 0; k < 4; ++k) {  // Gauss's elimination
        std::size_t pivot = k;
        for (std::size_t r = k; r < 4; ++r) pivot = std::abs(by[r][k]) > std::abs(by[pivot][k]) ? r : pivot;
        if (pivot != k) std::swap(by[k], by[pivot]), determinant = -determinant;
        determinant *= by[k][k];
        for (std::size_t r = k + 1; r < 4; ++r) {
          const double part = by[r][k] / by[k][k];
          for (std::size_t j = 0; j < 4; ++j) by[r][j] -= part * by[k][j];
        }
      }
      // u and v are uniform in the unit square, film points on the film.
      const CameraRay ray = camera.sample({place, u, v});
      const double cosine = std::abs(ray.ray.direction.z);
      const double density = 1 / film.area_mm2() / std::abs(determinant) / std::pow(cosine, 4);
      const Importance found = camera.importance({ray.ray.origin, -ray.ray.direction});
      ASSERT_TRUE(found) << what;
      EXPECT_NEAR(found.pdf_position * found.pdf_direction / density, 1, 1e-5) << what;
    }
  }
}

TEST(LocalFocus, DifferentialsEqualFiniteDifferences) {
  const Lens lens = double_gauss();
  const testing::Kronecker<5> random(9);
  for (const auto& [what, options, film] : settings(lens, {ModelKind::thick, ModelKind::thin_two_disc})) {
    const Camera camera(lens, film, options);
    const testing::CameraParts parts(camera);
    for (std::uint32_t i = 0; i < 11; ++i) {
      const auto [x, y, u, v, time] = random(i);
      const CameraSample sample{film.point(x * film.columns, y * film.rows), u, v, {}, time};
      const CameraRayDifferential found = camera.sample_differential(sample);
      if (!found.sample) continue;
      EXPECT_LT(glm::length(found.sample.ray.direction - camera.sample(sample).ray.direction), 1e-12);
      constexpr double step = 1e-4;
      const CameraRay from = camera.sample(parts.moved(sample, -step, 0));
      const CameraRay to = camera.sample(parts.moved(sample, step, 0));
      if (!from || !to) continue;
      const Vec3<double> by = (to.ray.direction - from.ray.direction) / (2 * step);
      EXPECT_LT(glm::length(found.by_film_x.direction - by), 1e-6 * glm::length(by)) << what;
      const Vec3<double> moved = (to.ray.origin - from.ray.origin) / (2 * step);
      EXPECT_LT(glm::length(found.by_film_x.origin - moved), 1e-5 * (1 + glm::length(moved))) << what;
    }
  }
}

// A surface through points of a plane is this plane; by the Scheimpflug principle a tilted film has the same focus.
TEST(LocalFocus, SurfaceThroughAPlaneFocusesAsATiltedFilm) {
  const Lens lens = with_f_number(double_gauss(), 11);  // small spherical aberration
  const IdealLens ideal = thick_lens(lens);
  const Vec3<double> through{0, -150, -2500}, normal = glm::normalize(Vec3<double>{0.2, 0.6, 1});
  const Film upright = pose_of(lens, wide),
             tilted = film_in(*ideal.image_of({normal, glm::dot(normal, through)}), wide);
  EXPECT_GT(tilted.angle(), radians(1.0));
  const Camera plain(lens, upright, {.model = ModelKind::thick}), by_film(lens, tilted, {.model = ModelKind::thick});
  std::vector<FocalPoint> points;
  for (const auto& [x, y] : {std::pair{-300.0, 150.0}, {320.0, 120.0}, {-250.0, -220.0}, {260.0, -180.0}}) {
    const double z = through.z - (normal.x * (x - through.x) + normal.y * (y - through.y)) / normal.z;
    const Projection seen = plain.project({x, y, z});
    ASSERT_TRUE(seen);
    points.push_back({.film_point = seen.film, .inverse_distance = 1 / (ideal.pupils.entrance.z - z)});
  }
  const Camera by_surface(lens, upright,
                          {.model = ModelKind::thick, .focal_surface = FocalSurface(ideal, upright, points)});
  const testing::Kronecker<2> random(3);
  for (const Camera* camera : {&by_surface, &by_film}) {
    for (std::uint32_t i = 0; i < 40; ++i) {
      const auto [x, y] = random(i);
      const FilmPoint place = camera->film().point(x * wide.columns, y * wide.rows);
      const Ray<double> one = camera->sample({place, 0.1, 0.9}).ray, other = camera->sample({place, 0.6, 0.9}).ray;
      // Intersections with the plane.
      const auto met = [&](const Ray<double>& ray) {
        return ray.origin + ray.direction * (glm::dot(through - ray.origin, normal) / glm::dot(ray.direction, normal));
      };
      const double distance = glm::length(met(one));
      if (distance > 20000) continue;
      // The focus of the film includes the remaining spherical aberration.
      const bool film = camera == &by_film;
      EXPECT_LT(glm::length(met(one) - met(other)), (film ? 5e-5 : 1e-9) * distance) << (film ? "film" : "surface");
      EXPECT_GT(glm::length(in_plane(one, -600) - in_plane(other, -600)), 1);
    }
  }
}

// At wavelengths in nm the surface holds for the primary wavelength and the lens adds its axial colour; film side and
// scene side agree.
TEST(LocalFocus, HoldsAtAnyWavelength) {
  const Lens lens =
      testing::compiled(testing::data_prescription("double_gauss_100mm_f2_28deg"), {587.56, 430., 480., 540., 680.});
  const Camera camera(
      lens, wide,
      {.model = ModelKind::thick, .focal_surface = surface_of(lens, wide, true), .expressive = aberrations()});
  const testing::Kronecker<4> random(1);
  for (const Wavelength wavelength : {Wavelength(1), Wavelength(4), Wavelength::nm(500), Wavelength::nm(611)}) {
    for (std::uint32_t i = 0; i < 30; ++i) {
      const auto [x, y, u, v] = random(i);
      const FilmPoint place = wide.point(x * wide.columns, y * wide.rows);
      const CameraRay ray = camera.sample({place, u, v, wavelength});
      ASSERT_TRUE(ray);
      const Importance found = camera.importance({ray.ray.origin, -ray.ray.direction}, wavelength);
      ASSERT_TRUE(found);
      EXPECT_NEAR(std::hypot(found.film.x - place.x, found.film.y - place.y), 0, 1e-7);
      EXPECT_NEAR(found.we / (found.pdf_position * found.pdf_direction) / ray.weight, 1, 1e-7);
    }
  }
}

// On steep surfaces the rays of adjacent film points cross; samples stay valid, and the camera reports the steepness.
TEST(LocalFocus, SteepSurfacesAreReported) {
  const Lens lens = double_gauss();
  const auto with = [&](double apart) {
    const std::array points{FocalPoint{.film_point = {-apart, 0}, .inverse_distance = 1 / 600.},
                            FocalPoint{.film_point = {apart, 0}, .inverse_distance = 0}};
    return Camera(
        lens, wide,
        {.model = ModelKind::thin,
         .focal_surface = FocalSurface(thick_lens(lens), pose_of(lens, wide), points, {.kind = SurfaceKind::shepard})});
  };
  FilmPoint steepest;
  const double gentle = with(17).focal_steepness(), steep = with(1).focal_steepness(&steepest);
  EXPECT_LT(gentle, 1);
  EXPECT_GT(steep, 1);
  EXPECT_LT(std::abs(steepest.x), 1.5);
  EXPECT_NEAR(steep / gentle, 17, 2);
  const Camera camera = with(1);
  for (const double x : {-0.3, 0.0, 0.4}) EXPECT_TRUE(camera.sample({{x, 0.1}, 0.3, 0.8}));
  EXPECT_EQ(Camera(lens, wide, {.model = ModelKind::thin}).focal_steepness(), 0);
}

TEST(LocalFocus, ExtentsWithoutDistancesKeepTheFocus) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f1.1");
  const std::array points{FocalPoint{.film_point = {0, 0}, .extent_stops = 2}};
  const FocalSurface surface(thick_lens(lens), pose_of(lens, wide), points);
  EXPECT_FALSE(surface.fixes_distance());
  const Camera plain(lens, wide, {.model = ModelKind::thick}),
      closed(lens, wide, {.model = ModelKind::thick, .focal_surface = surface});
  for (const FilmPoint place : {FilmPoint{0, 0}, FilmPoint{-15, 8}}) {
    const auto crossing = [&](const Camera& camera) {
      const Ray<double> one = camera.sample({place, 0.1, 0.9}).ray, other = camera.sample({place, 0.6, 0.9}).ray;
      const Vec3<double> apart = in_plane(one, 0) - in_plane(other, 0);
      const Vec3<double> by = one.direction / one.direction.z - other.direction / other.direction.z;
      return glm::dot(by, by) / glm::dot(apart, by);
    };
    EXPECT_NEAR(crossing(closed) / crossing(plain), 1, 1e-6);
  }
}

TEST(LocalFocus, PinholeIgnoresTheSurface) {
  const Lens lens = double_gauss();
  const Camera plain(lens, wide, {.model = ModelKind::pinhole}),
      bent(lens, wide,
           {.model = ModelKind::pinhole, .focal_surface = surface_of(lens, wide, true), .expressive = aberrations()});
  for (const FilmPoint place : {FilmPoint{0, 0}, FilmPoint{-15, 8}}) {
    EXPECT_EQ(plain.sample({place, 0.3, 0.7}).ray.direction, bent.sample({place, 0.3, 0.7}).ray.direction);
  }
}

}  // namespace local_focus_test
}  // namespace petzval
