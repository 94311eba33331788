// SPDX-License-Identifier: Apache-2.0
// The front: the surface on which rays start and shadow rays end.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "../data_lenses.hpp"
#include "../declared_radius.hpp"
#include "../low_discrepancy.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"

namespace petzval {
namespace front_test {

struct Case {
  const char* id;
  double vertex_z, curvature;  ///< of the front
  std::vector<ModelKind> models;
};

const std::vector<ModelKind> all(models().begin(), models().end()), exact{ModelKind::exact_float,
                                                                          ModelKind::exact_double};

/// Fronts derived by hand: the first surface if it is a sphere or plane, the sphere through the rim of an asphere, a
/// plane in front of a secondary mirror or of the rim of a concave cylinder.
std::vector<Case> cases() {
  const double paraboloid = 12.5 * 12.5 / 800, hollow = 101.3 - std::sqrt(101.3 * 101.3 - 30.0 * 30.0);
  return {{"telephoto_200mm_f1.8", 0, 1 / 123.12, all},
          {"double_gauss_100mm_f2.0", 0, 1 / 58.95, all},
          {"retrofocus_100mm_f2", 0, 1 / 346.939, all},
          {"fisheye_6.3mm_f2.8", 0, 1 / 143.47, all},
          {"fisheye_16mm_f2.8", 0, 1 / 121.3312, all},
          {"cine_100mm_t1.3", 0, -1 / 1883.6, all},
          {"phone_5.6mm_f3.5", std::nan(""), 0, all},
          {"mirror_newton_200mm_f8", 0, -2 * paraboloid / (12.5 * 12.5 + paraboloid * paraboloid), all},
          {"catadioptric_mangin_1000mm_f7.5", 0, 1 / 3852.629, all},
          {"mirror_ritchey_chretien_57.6m_f24", std::nan(""), 0, all},
          {"anamorphic_60mm_2x", -1.02 * hollow, 0, exact}};
}

/// Distance of a point from the front c |p|^2 = 2 p_z, to first order.
double off_front(const Case& c, const Vec3<double>& point) {
  const Vec3<double> p = point - Vec3<double>{0, 0, c.vertex_z};
  return (c.curvature * glm::dot(p, p) - 2 * p.z) / (2 * glm::length(c.curvature * p - Vec3<double>{0, 0, 1}));
}

Film film_of(const Lens& lens, const char* id) {
  const double side = std::sqrt(2) * testing::declared_radius(testing::data_prescription(id), lens);
  return {.width_mm = side, .height_mm = side};
}

TEST(Front, RaysOfEveryModelStartOnIt) {
  for (Case c : cases()) {
    const Lens lens = testing::data_lens(c.id);
    if (std::isnan(c.vertex_z)) c.vertex_z = Camera(lens, film_of(lens, c.id)).sample({}).ray.origin.z;
    const double size = std::abs(lens.film_z()) + lens.surfaces().front().semi_diameter;
    for (const ModelKind model : c.models) {
      SCOPED_TRACE(std::string(c.id) + ' ' + std::string(name(model)));
      Film film = film_of(lens, c.id);
      if (model < ModelKind::polynomial(3)) film.tilt_rad = 0.02;
      const Camera camera(lens, film, {.model = model});
      auto samples = testing::random_samples(film, 200);
      samples.run(camera);
      int on_front = 0, beside = 0;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples.fates[i] != RayFate::transmitted) continue;
        const double single = model == ModelKind::exact_float ? 1e-5 : 1e-9;
        const Ray<double> one = camera.sample(samples.one(i)).ray;
        EXPECT_NEAR(glm::distance(one.origin, samples.ray(i).origin), 0, single * size);
        // A first-order ray of a wide lens may miss the sphere; it starts in the tangent plane at the vertex.
        const bool at_plane = model < ModelKind::polynomial(3) && std::abs(one.origin.z - c.vertex_z) < 1e-9 * size;
        beside += at_plane;
        if (!at_plane) {
          EXPECT_NEAR(off_front(c, one.origin), 0, single * size) << one.origin.x << ' ' << one.origin.y;
        }
        const Vec3<double> outwards =
            c.curvature * (one.origin - Vec3<double>{0, 0, c.vertex_z}) - Vec3<double>{0, 0, 1};
        EXPECT_GT(glm::dot(outwards, one.direction), 0);
        ++on_front;
      }
      EXPECT_GT(on_front, 50);
      EXPECT_TRUE(c.curvature <= 0 || beside < on_front / 2) << beside;
    }
  }
}

// Rays of fields beyond 90 degrees start behind the plane of the vertex, next to the glass.
TEST(Front, FisheyeRaysStartNearTheGlass) {
  const Lens lens = testing::data_lens("fisheye_6.3mm_f2.8");
  const Camera camera(lens, {.width_mm = 24, .height_mm = 24}, {.model = ModelKind::polynomial(11)});
  auto samples = testing::random_samples(camera.film(), 20000);
  samples.run(camera);
  int beyond = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.fates[i] != RayFate::transmitted) continue;
    EXPECT_LT(std::hypot(samples.x[i], samples.y[i]), 1.02 * lens.surfaces().front().semi_diameter);
    beyond += samples.dz[i] > 0;
  }
  EXPECT_GT(beyond, 50);
}

TEST(Front, ShadowRaysEndOnIt) {
  for (const Case& c : cases()) {
    if (std::isnan(c.vertex_z)) continue;
    const Lens lens = testing::data_lens(c.id);
    const Film film = film_of(lens, c.id);
    const double size = std::abs(lens.film_z()) + lens.surfaces().front().semi_diameter;
    for (const ModelKind model : c.models) {
      SCOPED_TRACE(std::string(c.id) + ' ' + std::string(name(model)));
      const Camera camera(lens, film, {.model = model});
      const testing::Kronecker<4> random(3);
      int connected = 0;
      for (std::uint32_t i = 0; i < 400; ++i) {
        const auto [a, b, u, v] = random(i);
        const CameraRay seen = camera.sample({film.point(a * film.columns, b * film.rows), u, v});
        if (!seen) continue;
        const double away = size * std::pow(10, 3 * a);
        const Vec3<double> point = seen.ray.origin + seen.ray.direction * away;
        const ImportanceSample s = camera.sample_importance(point, b, a);
        if (!s) continue;
        ++connected;
        EXPECT_NEAR(glm::distance(point + s.direction * s.distance, s.on_front), 0, 1e-12 * (away + size));
        const bool at_plane =
            model < ModelKind::polynomial(3) && std::abs(s.on_front.z - c.vertex_z) < 1e-9 * (away + size);
        if (!at_plane) {
          EXPECT_NEAR(off_front(c, s.on_front), 0, 1e-9 * (away + size));
        }
        EXPECT_GT(s.distance, 0);
        EXPECT_LT(s.distance, 1.5 * away + size);
      }
      EXPECT_GT(connected, 20);
    }
  }
}

}  // namespace front_test
}  // namespace petzval
