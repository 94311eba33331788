// SPDX-License-Identifier: Apache-2.0
#include "renderer/ghosts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

#include "../data_lenses.hpp"
#include "renderer/path_colours.hpp"

namespace renderer {
namespace {

using std::numbers::pi;

/// A triplet that looks along -z; its entrance pupil is at the origin.
LensCamera lens_camera() {
  const petzval::Lens lens = petzval::testing::data_lens("cooke_triplet_50mm_f5");
  return {petzval::Camera(lens, {.columns = 30, .rows = 20}, {.model = petzval::ModelKind::thin}), {}};
}

/// A sphere of radiance 1, 2, 3 and more objects under a black sky.
SceneDescription lamp(const glm::vec3& centre, float radius, std::vector<Object> more = {}) {
  SceneDescription scene;
  scene.sky.colour = Rgb(0);
  scene.objects = std::move(more);
  scene.objects.push_back({"lamp", Sphere{centre, radius}, {}, {1, 2, 3}});
  return scene;
}

std::vector<GhostLight> lights_of(const SceneDescription& description, std::uint32_t count = 16) {
  return ghost_lights(Scene(description), lens_camera(), count, 0, 1);
}
Rgb irradiance(const SceneDescription& description) {
  Rgb sum(0);
  for (const GhostLight& light : lights_of(description)) sum += light.irradiance;
  return sum;
}

TEST(GhostLights, HaveTheIrradianceOfTheLamp) {
  const LensCamera lens = lens_camera();
  const glm::vec3 centre{300, -200, -2000};
  const SceneDescription scene = lamp(centre, 60);
  const glm::vec3 to = centre - lens.front();
  const float expected = static_cast<float>(pi) * 60 * 60 / glm::dot(to, to);
  const Rgb found = irradiance(scene);
  EXPECT_NEAR(found.r, expected, 0.01 * expected);
  EXPECT_NEAR(found.b, 3 * expected, 0.03 * expected);
  for (const GhostLight& light : lights_of(scene)) {
    EXPECT_FALSE(light.point.at_infinity);
    EXPECT_NEAR(glm::distance(glm::dvec3(lens.to_world(light.point.position)), glm::dvec3(centre)), 60, 1e-2);
  }
}

TEST(GhostLights, ObjectsStopThePartOfTheBeamThatTheyCover) {
  const Rgb all = irradiance(lamp({0, 0, -20'000}, 100));
  const auto wall = [](float left) {
    return Object{"wall", Quad{{left, -1000, -100}, {2000, 0, 0}, {0, 2000, 0}}, {}, {}};
  };
  EXPECT_NEAR(irradiance(lamp({0, 0, -20'000}, 100, {wall(0)})).g / all.g, 0.5, 0.07);
  EXPECT_TRUE(lights_of(lamp({0, 0, -20'000}, 100, {wall(-1000)})).empty());
}

TEST(GhostLights, LightsBehindTheLensAreLeftOut) { EXPECT_TRUE(lights_of(lamp({0, 0, 500}, 60)).empty()); }

TEST(GhostLights, LightsWithManyGhostsAreFrequent) {
  // A lamp in the field, and a lamp 75 degrees off the axis that has four times its irradiance and few ghosts.
  const Object beside{"beside", Sphere{{1930, 0, -520}, 120}, {}, {1, 2, 3}};
  const auto lights = lights_of(lamp({0, 0, -2000}, 60, {beside}));
  const auto ahead =
      std::ranges::count_if(lights, [](const auto& light) { return std::abs(light.point.position.x) < 100; });
  EXPECT_GE(ahead, 12);
}

TEST(GhostLights, SkyShinesFromTheHalfInFront) {
  SceneDescription scene = lamp({0, 0, 500}, 1e-3f);
  scene.sky.colour = Rgb(2);
  double across = 0;
  for (const GhostLight& light : lights_of(scene, 1024)) {
    EXPECT_TRUE(light.point.at_infinity);
    across += double{light.irradiance.g} * std::max(-light.point.position.z, 0.0);  // the rim also sees lights behind
  }
  EXPECT_NEAR(across, 2 * pi, 0.08 * 2 * pi);
}

TEST(Ghosts, HaveTheColourOfTheLight) {
  const petzval::ScenePoint point{.position = {0.1, 0.2, -1}, .at_infinity = true};
  const auto light = [&](const PathColourSource& colours, const Rgb& irradiance) {
    const petzval::Lens lens = petzval::compile(petzval::testing::data_prescription("cooke_triplet_50mm_f5"),
                                                colours.compiled_nm(), {.missing_glass = petzval::MissingGlass::abbe});
    const petzval::Camera camera(lens, {.columns = 30, .rows = 20}, {.model = petzval::ModelKind::thin});
    glm::dvec3 sum(0);
    for (auto& [name, plane] : ghosts(camera, {{point, irradiance}}, colours, 2, 1)) {
      for (const float value : plane) sum[static_cast<int>(std::string("RGB").find(name.back()))] += double{value};
    }
    return sum;
  };
  const double reference = light(PathColourSource(ColourMode::d), Rgb(0.5f)).r;
  for (const PathColourSource& colours :
       {PathColourSource(ColourMode::rgb), PathColourSource(ColourMode::hero), PathColourSource(500)}) {
    for (const Rgb& rgb : {Rgb(1, 1, 1), Rgb(1, 0, 0.5f)}) {
      const glm::dvec3 found = light(colours, rgb);
      for (int c = 0; c < 3; ++c) {
        const double expected = 2 * reference * double{rgb[c]};
        EXPECT_NEAR(found[c], expected, 0.08 * expected + 0.05 * reference);  // indices are higher in the blue
      }
    }
  }
}

}  // namespace
}  // namespace renderer
