// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "renderer/angel.hpp"
#include "renderer/built_in_scenes.hpp"
#include "renderer/solids.hpp"

namespace renderer {
namespace {

constexpr float ground = -1100;
constexpr Rgb marble{0.78f, 0.74f, 0.67f}, slate{0.16f, 0.17f, 0.19f}, sandstone{0.58f, 0.49f, 0.37f},
    bronze{0.20f, 0.27f, 0.23f}, leaves{0.045f, 0.085f, 0.030f};
const Diffuse black{{.colour = {0, 0, 0}}};

Diffuse matt(const Rgb& colour) { return {{.colour = colour}}; }

/// An evening sky after sunset: the glow is on the right in front of the camera; a bright cloud on the left behind the
/// camera models the statues. Both are wide, so that few samples give little noise.
Sky evening() {
  constexpr int columns = 512, rows = 256;
  constexpr float pi = std::numbers::pi_v<float>;
  auto image = std::make_shared<petzval::RgbImage>(columns, rows);
  const glm::vec3 cloud = glm::normalize(glm::vec3{-0.75f, 0.55f, 0.55f}),
                  glow = glm::normalize(glm::vec3{0.35f, 0.0f, -1});
  for (int row = 0; row < rows; ++row) {
    const float up = pi * (0.5f - (static_cast<float>(row) + 0.5f) / rows);
    for (int column = 0; column < columns; ++column) {
      const float turn = 2 * pi * ((static_cast<float>(column) + 0.5f) / columns - 0.5f);
      const glm::vec3 direction{std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn)};
      const auto lobe = [&](const glm::vec3& towards, float width) {
        return std::exp((glm::dot(direction, towards) - 1) / (width * width));
      };
      const float haze = std::exp(-std::abs(up) / 0.16f);
      Rgb radiance = Rgb{0.16f, 0.22f, 0.38f} + haze * Rgb{0.30f, 0.22f, 0.16f};
      radiance += lobe(glow, 0.45f) * haze * Rgb{1.0f, 0.52f, 0.20f};
      radiance += lobe(cloud, 0.38f) * Rgb{5.2f, 4.5f, 3.7f};
      if (up < 0) radiance *= 0.3f;
      float* const pixel = image->pixel(column, row);
      for (int c = 0; c < 3; ++c) pixel[c] = radiance[c];
    }
  }
  return {.colour = {1, 1, 1}, .image = std::move(image)};
}

/// A square pedestal with its top at a point: a moulded plate, a shaft with a checkered band, a foot on the ground.
void pedestal(SceneDescription& scene, const glm::vec3& top, float width, const Rgb& colour) {
  const auto slab = [&](float half, float from, float to) {
    return box({top.x - half, from, top.z - half}, {top.x + half, to, top.z + half});
  };
  const float half = width / 2, thick = 0.10f * width;
  Mesh stone = slab(half, top.y - thick, top.y);
  append(stone, slab(0.93f * half, top.y - 1.5f * thick, top.y - thick));
  append(stone, slab(0.86f * half, ground, top.y - 3.5f * thick));
  append(stone, slab(half, ground, ground + 2 * thick));
  scene.objects.push_back({"pedestal", std::move(stone), matt(colour)});
  scene.objects.push_back({"band", slab(0.86f * half, top.y - 3.5f * thick, top.y - 1.5f * thick),
                           Diffuse{{.colour = marble, .checker = Albedo::Checker{{0.28f, 0.06f, 0.04f}, thick}}}});
}

void statue(SceneDescription& scene, AngelPose pose, const glm::vec3& foot, float height, float turn_deg,
            const Rgb& colour) {
  const float step = 0.03f * height;
  Mesh mesh = placed(angel(pose, height - step), foot + glm::vec3{0, step, 0}, turn_deg);
  const std::array drum{ProfilePoint{0, 0}, ProfilePoint{0.19f * height, 0, 0.5f},
                        ProfilePoint{0.19f * height, 0.7f * step}, ProfilePoint{0.175f * height, step},
                        ProfilePoint{0, step}};
  append(mesh, placed(lathe(drum), foot));
  scene.objects.push_back({"statue", std::move(mesh), matt(colour)});
  pedestal(scene, foot, 0.46f * height, sandstone);
}

void column(SceneDescription& scene, const glm::vec3& foot) {
  constexpr std::array<ProfilePoint, 13> profile{{{0, 0},
                                                  {290, 0},
                                                  {290, 90},
                                                  {270, 92, 0.9f},
                                                  {270, 180},
                                                  {225, 190},
                                                  {230, 1500},
                                                  {190, 3050},
                                                  {225, 3070, 1},
                                                  {225, 3120},
                                                  {190, 3140, -0.3f},
                                                  {300, 3300},
                                                  {0, 3300}}};
  Mesh mesh = lathe(profile, 48);
  append(mesh, box({-310, 3300, -310}, {310, 3400, 310}));
  scene.objects.push_back({"column", placed(std::move(mesh), foot), matt(marble)});
}

/// An urn of a given height, with a stone ball.
void urn(SceneDescription& scene, const glm::vec3& foot, float height, const Rgb& colour) {
  std::array<ProfilePoint, 12> profile{{{0, 0},
                                        {0.20f, 0},
                                        {0.20f, 0.05f},
                                        {0.07f, 0.13f, -0.3f},
                                        {0.06f, 0.20f},
                                        {0.10f, 0.24f, 0.3f},
                                        {0.30f, 0.52f, 0.1f},
                                        {0.29f, 0.66f},
                                        {0.34f, 0.70f, 0.8f},
                                        {0.34f, 0.74f},
                                        {0.26f, 0.76f, 0.5f},
                                        {0, 1.0f}}};
  for (ProfilePoint& p : profile) p.radius *= height, p.height *= height;
  scene.objects.push_back({"urn", placed(lathe(profile), foot), matt(colour)});
}

/// A park lamp: a bright globe on a post. Globes are large, for path tracing: see built_in_scenes.hpp.
void lamp(SceneDescription& scene, const glm::vec3& foot, float height, float radius, const Rgb& emission) {
  const float neck = height - radius;
  const std::array post{ProfilePoint{0, 0},    ProfilePoint{90, 0},         ProfilePoint{90, 250},
                        ProfilePoint{35, 330}, ProfilePoint{28, neck - 60}, ProfilePoint{60, neck},
                        ProfilePoint{0, neck}};
  scene.objects.push_back({"post", placed(lathe(post, 24), foot), matt({0.03f, 0.035f, 0.035f})});
  scene.objects.push_back({"lamp", Sphere{foot + glm::vec3{0, height, 0}, radius}, black, emission});
}

/// A clipped tree: a trunk, and a cone or two balls.
void tree(SceneDescription& scene, const glm::vec3& foot, bool cone) {
  Mesh green;
  if (cone) {
    constexpr std::array<ProfilePoint, 4> profile{{{0, 250}, {420, 250, 0.6f}, {430, 420, 0.08f}, {0, 2100}}};
    green = lathe(profile, 40);
  } else {
    constexpr std::array<ProfilePoint, 7> profile{
        {{0, 350}, {60, 350, 0.95f}, {60, 1250}, {60, 1350, 0.95f}, {60, 1950}, {30, 1960}, {0, 1960}}};
    green = lathe(profile, 40);
  }
  scene.objects.push_back({"tree", placed(std::move(green), foot), matt(leaves)});
  scene.objects.push_back(
      {"trunk", box(foot + glm::vec3{-45, 0, -45}, foot + glm::vec3{45, 450, 45}), matt({0.10f, 0.07f, 0.05f})});
}

}  // namespace

SceneDescription statues_scene() {
  SceneDescription scene{.name = "statues", .sky = evening(), .pose = {}};

  scene.objects.push_back({"floor", Quad{{-1800, ground, 1000}, {3600, 0, 0}, {0, 0, -31000}},
                           Diffuse{{.colour = marble, .checker = Albedo::Checker{slate, 600}}}});
  scene.objects.push_back(
      {"lawn", Quad{{-60000, ground - 5, 1000}, {120000, 0, 0}, {0, 0, -160000}}, matt(0.8f * leaves)});

  statue(scene, AngelPose::praying, {-235, -235, -1500}, 500, 24, marble);
  statue(scene, AngelPose::calling, {930, -640, -6000}, 1840, -22, marble);

  // The colonnade on both sides of the path.
  for (const float side : {-1.0f, 1.0f}) {
    for (int i = 0; i < 8; ++i) column(scene, {side * 2150, ground, -4200 - 2900 * static_cast<float>(i)});
    scene.objects.push_back({"beam",
                             box({side * 2150 - 260, ground + 3400, -25000}, {side * 2150 + 260, ground + 3900, -3900}),
                             matt(marble)});
    scene.objects.push_back(
        {"hedge", box({side * 3600 - 400, ground, -30000}, {side * 3600 + 400, ground + 1300, -3000}), matt(leaves)});
    for (int i = 0; i < 6; ++i) tree(scene, {side * 1450, ground, -8300 - 2900 * static_cast<float>(i)}, i % 2 == 0);
  }

  // Small figures from near to far.
  statue(scene, AngelPose::praying, {322, -205, -1080}, 150, -35, bronze);
  urn(scene, {20, -520, -2400}, 330, sandstone);
  pedestal(scene, {20, -520, -2400}, 260, sandstone);
  urn(scene, {620, -760, -3300}, 420, sandstone);
  pedestal(scene, {620, -760, -3300}, 330, sandstone);
  statue(scene, AngelPose::calling, {-560, -520, -4300}, 620, 30, bronze);
  statue(scene, AngelPose::praying, {-900, -400, -9500}, 1500, 25, marble);
  statue(scene, AngelPose::praying, {160, -300, -15500}, 2300, 0, marble);

  // Lamps along the path, and lamps of the town far behind.
  constexpr Rgb warm{7.5f, 4.6f, 2.1f}, white{6.5f, 5.6f, 4.4f}, red{6, 1.1f, 0.7f}, cold{3.2f, 4.6f, 6.4f};
  for (const float side : {-1.0f, 1.0f}) {
    for (int i = 0; i < 5; ++i)
      lamp(scene, {side * 1000, ground, -11000 - 4200 * static_cast<float>(i)}, 2500, 120, warm);
  }
  // Garlands of lanterns between the columns.
  for (const float z : {-7100.0f, -12900.0f}) {
    constexpr int count = 10;
    const std::array colours{warm, red, white, warm, cold};
    for (int i = 0; i < count; ++i) {
      const float across = 2 * (static_cast<float>(i) + 0.5f) / count - 1;  // -1 to 1
      const glm::vec3 centre{1850 * across, 0.22f * -z - 350 + 500 * across * across, z};
      scene.objects.push_back({"lantern", Sphere{centre, 0.0042f * -z}, black, colours[i % 5]});
    }
  }
  struct Distant {
    float right, up, away;  ///< tangents, and mm
    Rgb emission;
  };
  const std::array town{Distant{-0.30f, 0.028f, 52000, warm}, Distant{-0.235f, 0.045f, 60000, white},
                        Distant{-0.19f, 0.02f, 56000, red},   Distant{-0.02f, 0.035f, 64000, white},
                        Distant{0.03f, 0.06f, 58000, warm},   Distant{0.075f, 0.022f, 62000, cold},
                        Distant{0.10f, 0.05f, 55000, warm},   Distant{0.215f, 0.03f, 60000, red},
                        Distant{0.25f, 0.055f, 54000, warm},  Distant{0.31f, 0.035f, 57000, white}};
  for (const auto& [right, up, away, emission] : town) {
    scene.objects.push_back({"lamp", Sphere{away * glm::vec3{right, up, -1}, 0.0055f * away}, black, emission});
  }
  // The wood in front of the town.
  for (int i = 0; i < 60; ++i) {
    const float x = -32000 + 64000 * (static_cast<float>(i) + 0.5f) / 60;
    const float radius = 1500 + 900 * std::sin(7.0f * static_cast<float>(i)) * std::sin(3.3f * static_cast<float>(i));
    scene.objects.push_back({"wood", Sphere{{x, ground + 0.4f * radius, -66000}, radius}, matt(0.6f * leaves)});
  }
  return scene;
}

}  // namespace renderer
