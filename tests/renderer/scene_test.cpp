// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

#include "petzval/core/error.hpp"
#include "renderer/frame.hpp"
#include "renderer/light_paths.hpp"
#include "renderer/sky_light.hpp"

namespace renderer {
namespace {

using std::numbers::pi;

SceneDescription lamps() {
  SceneDescription d;
  d.objects.push_back({"ball", Sphere{{0, 0, -1000}, 50}, Diffuse{}, Rgb(3)});
  d.objects.push_back({"panel", Quad{{-100, 400, -900}, {0, 0, -200}, {200, 0, 0}}, Diffuse{}, Rgb(1, 2, 0)});
  Mesh mesh{{{-300, 0, -800}, {-200, 0, -800}, {-300, 100, -800}, {-200, 100, -850}}, {{0, 1, 2}, {1, 3, 2}}};
  d.objects.push_back({"mesh", mesh, Diffuse{}, Rgb(0, 0, 5)});
  d.objects.push_back({"floor", Quad{{-500, -200, -500}, {1000, 0, 0}, {0, 0, -1000}}, Diffuse{}});
  d.sky.colour = {0.01f, 0.02f, 0.03f};
  return d;
}

TEST(Scene, SamplesLampsWithTheirDensity) {
  const Scene scene(lamps());
  Random random(1, 2, 3);
  constexpr int count = 200'000;
  double area = 0, sky = 0;
  for (int i = 0; i < count; ++i) {
    const float pick = random(), u = random(), v = random();
    const LightPoint light = scene.sample_light(pick, u, v);
    ASSERT_TRUE(light);
    if (light.surface) {
      EXPECT_NEAR(light.pdf, scene.pdf_light(*light.surface), 1e-12);
      area += 1 / light.pdf / count;
    } else {
      EXPECT_NEAR(light.pdf, scene.pdf_sky(light.travel), 1e-9);
      sky += 1 / light.pdf / count;
    }
  }
  const double ball = 4 * pi * 2500, panel = 200 * 200, mesh = 100 * 100 / 2.0 + std::hypot(100, 50) * 100 / 2;
  EXPECT_NEAR(area / (ball + panel + mesh), 1, 0.02);
  EXPECT_NEAR(sky / (4 * pi), 1, 0.02);
}

TEST(Scene, PathsEqualConnections) {
  // Irradiance of a small panel by emitted light and by sampling the lamps.
  SceneDescription d = lamps();
  const Quad target{{-150, -100, -950}, {100, 0, 0}, {0, 0, -100}};
  d.objects.push_back({"target", target, Diffuse{}});
  const Scene scene(std::move(d));
  const Object* const panel = &scene.description().objects.back();
  Random random(4, 5, 6);
  constexpr int count = 400'000;
  double sent = 0, looked = 0;
  for (int i = 0; i < count; ++i) {
    if (const auto start = emit(scene, random)) {
      const auto met = scene.meet(start->origin, start->direction);
      if (met && met->object == panel && glm::dot(met->normal, start->direction) < 0) {
        sent += static_cast<double>(start->from.radiance.g) * start->cosine / start->pdf_emission / count;
      }
    }
    SurfacePoint at{target.corner + random() * target.edge_u + random() * target.edge_v, {0, 1, 0}, {0, 1, 0}};
    at.object = panel;
    at.reach = 1e-2f;
    if (const auto light = illumination(scene, at, random);
        light && light->direction.y > 0 && sees(scene, at, *light)) {
      looked += static_cast<double>(light->radiance.g * light->direction.y) / light->pdf * 100 * 100 / count;
    }
  }
  EXPECT_NEAR(sent / looked, 1, 0.05);
  EXPECT_GT(looked, 0);
}

TEST(Scene, MeetsSpheresFromInsideAndOutside) {
  SceneDescription d;
  d.objects.push_back({"ball", Sphere{{1000, 2000, -3000}, 7}, Glass{}});
  const Scene scene(std::move(d));
  const auto outside = scene.meet({1000, 2000, 0}, {0, 0, -1});
  ASSERT_TRUE(outside);
  EXPECT_NEAR(outside->position.z, -2993, 1e-3);
  EXPECT_EQ(outside->normal, glm::vec3(0, 0, 1));
  const auto inside = scene.meet(Scene::leave(*outside, {0, 0, -1}), {0, 0, -1});
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->position.z, -3007, 1e-3);
  EXPECT_FALSE(scene.meet(Scene::leave(*inside, {0, 0, -1}), {0, 0, -1}));
  EXPECT_EQ(scene.around({1000, 2000, -3000}), nullptr);  // glass is not a wall
}

TEST(Scene, FindsTheSolidAroundAPoint) {
  SceneDescription d;
  d.objects.push_back({"stone", Sphere{{0, 0, 0}, 100}, Diffuse{}});
  const Scene scene(std::move(d));
  ASSERT_NE(scene.around({0, 0, 10}), nullptr);
  EXPECT_EQ(scene.around({0, 0, 10})->name, "stone");
  EXPECT_EQ(scene.around({0, 0, 110}), nullptr);
}

TEST(SkyLight, SamplesAnImageByItsRadiance) {
  auto image = std::make_shared<petzval::RgbImage>(8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) image->pixel(x, y)[1] = static_cast<float>((x * 5 + y * 3) % 7);
  const SkyLight sky({Rgb(2), image});
  Random random(7, 7, 7);
  constexpr int count = 100'000;
  double total = 0, solid_angle = 0;
  for (int i = 0; i < count; ++i) {
    const float u = random(), v = random();
    const glm::vec3 travel = sky.sample(u, v);
    EXPECT_NEAR(glm::length(travel), 1, 1e-5);
    EXPECT_GT(sky.pdf(travel), 0);
    const glm::vec3 any = on_sphere(random(), random());
    solid_angle += sky.pdf(any) * 4 * pi / count;
    total += static_cast<double>(0.7152f * sky.radiance(any).g) * 4 * pi / count;
  }
  EXPECT_NEAR(solid_angle, 1, 0.02);
  EXPECT_NEAR(total / sky.total(), 1, 0.02);
  // The centre of the image is ahead, along -z, and its right half is on the right.
  EXPECT_EQ(sky.radiance({0, 1e-3f, 1}), 2.0f * Rgb(0, image->pixel(4, 2)[1], 0));
  EXPECT_EQ(sky.radiance(glm::normalize(glm::vec3(-1, -0.9f, 0.1f))), 2.0f * Rgb(0, image->pixel(5, 1)[1], 0));
  image->pixel(3, 2)[0] = -1;
  EXPECT_THROW(SkyLight({Rgb(1), image}), petzval::Error);
}

TEST(Frame, HasUnitAxesAboutAnyDirection) {
  for (int i = 0; i < 500; ++i) {
    const Frame f(on_sphere(static_cast<float>(i) / 499, std::fmod(0.618f * static_cast<float>(i), 1.0f)));
    EXPECT_NEAR(glm::length(glm::cross(f.x, f.y) - f.z), 0, 1e-5);
    EXPECT_NEAR(glm::dot(f.x, f.y), 0, 1e-5);
  }
}

}  // namespace
}  // namespace renderer
