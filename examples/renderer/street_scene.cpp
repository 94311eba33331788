// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>

#include "renderer/built_in_scenes.hpp"
#include "renderer/solids.hpp"

namespace renderer {
namespace {

constexpr float eye_height = 1400, kerb = 3500, walls = 4600, sign_distance = 3000;
constexpr Rgb sodium{1, 0.55f, 0.16f}, white{1, 0.95f, 0.85f}, red{1, 0.07f, 0.04f}, green{0.1f, 1, 0.45f},
    warm{1, 0.72f, 0.40f};
const Diffuse black{{.colour = {0, 0, 0}}};

/// Random numbers from 0 to 1, equal on all platforms; std::uniform_real_distribution does not guarantee that.
class Chance {
 public:
  float next() { return static_cast<float>(engine_() >> 8) / 16777216.0f; }

 private:
  std::mt19937 engine_{7};
};

/// The radiance of a small light whose blur disc has the radiance `disc` in a picture by a lens of 100 mm, f/2, focused
/// at the sign: `disc` times the ratio of the areas of blur disc and sharp image.
float radiance(float disc, float radius, float away) {
  constexpr float pupil = 50, focal_length = 100, image_distance = 1 / (1 / focal_length - 1 / sign_distance);
  const float blur = pupil * std::abs(away - sign_distance) / away * focal_length / (sign_distance - focal_length);
  const float sharp = 2 * radius * image_distance / away;
  return disc * std::max(1.0f, blur * blur / (sharp * sharp));
}

void light(SceneDescription& scene, const std::string& name, const glm::vec3& centre, float radius, const Rgb& colour,
           float disc) {
  scene.objects.push_back({name, Sphere{centre, radius}, black, colour * radiance(disc, radius, -centre.z)});
}

/// A row of houses along one side of the street (-1: left), with some windows lit.
void houses(SceneDescription& scene, float side, Chance& chance) {
  const auto x = [&](float from_middle) { return side * from_middle; };
  float near_z = -12000;
  while (near_z > -185000) {
    const float length = 12000 + 8000 * chance.next(), far_z = near_z - length;
    const int floors = 2 + static_cast<int>(3 * chance.next());
    const float height = 3300 * static_cast<float>(floors) + 1200, grey = 0.05f + 0.08f * chance.next();
    const float a = x(walls), b = x(walls + 9000);
    scene.objects.push_back({"house", box({std::min(a, b), 0, far_z}, {std::max(a, b), height, near_z}),
                             Diffuse{{.colour = {grey, 0.9f * grey, 0.8f * grey}}}});
    for (int level = 0; level < floors; ++level) {
      for (float z = near_z - 2000; z > far_z + 2000; z -= 2800) {
        const float lit = chance.next(), tint = chance.next();
        if (lit > 0.2f) continue;
        // In front of the wall, facing the street.
        const glm::vec3 corner{x(walls - 20), 1000 + 3300 * static_cast<float>(level), z};
        const glm::vec3 along{0, 0, side * 1100}, up{0, 1500, 0};
        const Rgb colour = tint < 0.75f ? warm : Rgb{0.75f, 0.85f, 1};
        scene.objects.push_back({"window", Quad{corner + 0.5f * (glm::vec3{0, 0, -1100} - along), along, up}, black,
                                 colour * (0.4f + 4 * lit)});
      }
    }
    near_z = far_z - (chance.next() < 0.3f ? 5000.0f : 0.0f);
  }
}

/// Adds the object in focus: a checkered plate on a post at the left.
void sign(SceneDescription& scene) {
  const glm::vec3 foot{-275, 0, -sign_distance};
  constexpr ProfilePoint post[] = {{0, 0}, {30, 0}, {30, 1640}, {38, 1645, 1}, {0, 1690}};
  scene.objects.push_back({"post", placed(lathe(post), foot - glm::vec3{0, 0, 45}), Rough{{0.5f, 0.5f, 0.5f}, 0.25f}});
  const Varnish paint{{.colour = {0.8f, 0.78f, 0.72f}, .checker = Albedo::Checker{{0.5f, 0.03f, 0.03f}, 50}}, 0.1f};
  scene.objects.push_back({"sign", box(foot + glm::vec3{-150, 1275, -14}, foot + glm::vec3{150, 1525, 0}), paint});
  // The shop window that lights the sign is outside the picture.
  scene.objects.push_back(
      {"shop window", Quad{{-1500, 600, -100}, {-900, 0, -900}, {0, 1800, 0}}, black, {6, 5, 3.6f}});
}

}  // namespace

SceneDescription street_scene() {
  SceneDescription scene{.name = "street", .sky = {.colour = {0.008f, 0.010f, 0.018f}}};
  scene.pose = {.position = {0, eye_height, 0}, .look_at = {0, eye_height, -1000}};
  Chance chance;

  // Wet asphalt.
  scene.objects.push_back({"road", Quad{{-20000, 0, 1000}, {40000, 0, 0}, {0, 0, -240000}},
                           Varnish{{.colour = {0.03f, 0.03f, 0.033f}}, 0.12f}});
  for (const float side : {-1.0f, 1.0f}) houses(scene, side, chance);
  sign(scene);

  // Street lamps, alternately over the left and the right kerb.
  int count = 0;
  for (float away = 36000; away < 200000; away += 11000, ++count) {
    const float x = count % 2 == 0 ? -kerb : kerb;
    light(scene, "street lamp", {x, 5200, -away}, 40, sodium, 1.1f);
    const glm::vec3 post{x + (x < 0 ? -300.0f : 300.0f), 0, -away};
    scene.objects.push_back({"lamp post", box(post - glm::vec3{50, 0, 50}, post + glm::vec3{50, 5300, 50}),
                             Diffuse{{.colour = {0.05f, 0.05f, 0.05f}}}});
  }

  // Cars: headlights approach on the left half of the road, tail lights recede on the right.
  for (const float away : {19000.0f, 31000.0f, 47000.0f, 68000.0f, 98000.0f, 140000.0f}) {
    for (const float apart : {-650.0f, 650.0f}) {
      light(scene, "headlight", {-1700 + apart, 650, -away * 1.12f}, 35, white, 0.9f);
      light(scene, "tail light", {1700 + apart, 750, -away}, 30, red, 0.9f);
    }
  }

  // Traffic lights.
  for (const float away : {24000.0f, 75000.0f}) {
    light(scene, "traffic light", {kerb - 300, 3000, -away}, 40, green, 1.0f);
    light(scene, "traffic light", {-kerb + 300, 3000, -away - 9000}, 40, red, 1.0f);
  }

  // Strings of bulbs across the street, from 5 m. Bulbs do not hide each other: light of a hidden bulb would be visible
  // around the nearer bulb.
  for (const auto& [away, shift] : {std::pair{5200.0f, 0.0f}, std::pair{9500.0f, 0.33f}, std::pair{15500.0f, -0.33f}}) {
    constexpr int bulbs = 9;
    for (int i = 0; i < bulbs; ++i) {
      const float across = 2 * (static_cast<float>(i) + shift + 0.5f) / bulbs - 1;  // -1 to 1
      const float half_width = std::min(0.2f * away, walls);
      const float y = eye_height + 0.055f * away + 0.04f * away * across * across;
      const Rgb colours[] = {warm, warm, red, warm, green, warm};
      light(scene, "bulb", {across * half_width, y, -away}, 12, colours[i % 6], 0.8f);
    }
  }

  // The end of the street, and lights of the town behind.
  for (int i = 0; i < 16; ++i) {
    const float away = 150000 + 50000 * chance.next(), across = 2 * chance.next() - 1;
    const Rgb colours[] = {sodium, white, warm};
    light(scene, "distant light", {across * 3800, 1500 + 11000 * chance.next(), -away}, 40, colours[i % 3],
          0.3f + 0.6f * chance.next());
  }
  return scene;
}

}  // namespace renderer
