// SPDX-License-Identifier: Apache-2.0
#include "layers/blur_scenes.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <utility>

#include "renderer/angel.hpp"
#include "renderer/built_in_scenes.hpp"
#include "renderer/solids.hpp"

namespace lens_blur {
namespace {

using renderer::Albedo;
using renderer::Diffuse;
using renderer::Mesh;
using renderer::ProfilePoint;
using renderer::Rgb;
using renderer::SceneDescription;

constexpr float pi = std::numbers::pi_v<float>;
const renderer::Sky daylight{.colour = {0.55f, 0.68f, 0.90f}};

/// Random numbers from 0 to 1, equal on all platforms; std::uniform_real_distribution does not guarantee that.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : engine_(seed) {}
  float next() { return static_cast<float>(engine_() >> 8) / 16777216.0f; }
  float next(float least, float most) { return least + (most - least) * next(); }

 private:
  std::mt19937 engine_;
};

Diffuse matt(const Rgb& colour) { return {{.colour = colour}}; }

void add(SceneDescription& scene, const char* name, Mesh mesh, const Rgb& colour) {
  if (!mesh.triangles.empty()) scene.objects.push_back({name, std::move(mesh), matt(colour)});
}

/// A roof over a rectangle, with its ridge along z.
Mesh gable(const glm::vec3& least, const glm::vec3& most, float height) {
  const float middle = 0.5f * (least.x + most.x), over = 0.06f * (most.x - least.x);
  const glm::vec3 a{least.x - over, most.y, least.z}, b{most.x + over, most.y, least.z},
      c{most.x + over, most.y, most.z}, d{least.x - over, most.y, most.z}, e{middle, most.y + height, least.z},
      f{middle, most.y + height, most.z};
  return {{a, b, c, d, e, f}, {{0, 5, 4}, {0, 3, 5}, {1, 5, 2}, {1, 4, 5}, {0, 4, 1}, {3, 2, 5}}};
}

void house(SceneDescription& scene, Chance& chance, const glm::vec3& least, const glm::vec3& most) {
  const std::array<Rgb, 5> plasters{{{0.78f, 0.66f, 0.48f},
                                     {0.70f, 0.45f, 0.34f},
                                     {0.62f, 0.63f, 0.58f},
                                     {0.80f, 0.74f, 0.62f},
                                     {0.45f, 0.52f, 0.60f}}};
  add(scene, "house", renderer::box(least, most), plasters[static_cast<std::size_t>(5 * chance.next())]);
  add(scene, "roof", gable(least, most, 0.45f * (most.x - least.x)), {0.40f, 0.17f, 0.11f});
  Mesh glass, frames;
  const float storey = 520, step = 420;
  for (float y = least.y + 190; y + 300 < most.y; y += storey) {
    const auto window = [&](const glm::vec3& centre, const glm::vec3& along) {
      const glm::vec3 out = 14.0f * glm::vec3{along.z != 0, 0, along.x != 0}, up{0, 150, 0}, half = 95.0f * along;
      append(glass, renderer::box(centre - half - up - out, centre + half + up + out));
      const glm::vec3 more = 1.9f * out;
      const glm::vec3 bar = 12.0f * along;
      append(frames, renderer::box(centre - bar - up - more, centre + bar + up + more));
      append(frames,
             renderer::box(centre - half - glm::vec3{0, 10, 0} - more, centre + half + glm::vec3{0, 10, 0} + more));
      append(frames, renderer::box(centre - 1.25f * half - up - glm::vec3{0, 22, 0} - 2.5f * out,
                                   centre + 1.25f * half - up + 2.5f * out));
    };
    for (float x = least.x + 210; x + 180 < most.x; x += step) window({x, y + 150, most.z}, {1, 0, 0});
    for (float z = least.z + 210; z + 180 < most.z; z += step) {
      window({least.x, y + 150, z}, {0, 0, 1});
      window({most.x, y + 150, z}, {0, 0, 1});
    }
  }
  add(scene, "window", std::move(glass), {0.08f, 0.11f, 0.15f});
  add(scene, "frame", std::move(frames), {0.85f, 0.83f, 0.78f});
}

void tree(SceneDescription& scene, Chance& chance, const glm::vec3& foot, float height) {
  const std::array trunk{ProfilePoint{0, 0}, ProfilePoint{0.035f * height, 0},
                         ProfilePoint{0.02f * height, 0.6f * height}, ProfilePoint{0, 0.6f * height}};
  scene.objects.push_back({"trunk", placed(renderer::lathe(trunk, 12), foot), matt({0.16f, 0.10f, 0.06f})});
  Mesh leaves;
  for (int i = 0; i < 700; ++i) {
    const float z = chance.next(-1, 1), turn = chance.next(0, 2 * pi), flat = std::sqrt(1 - z * z);
    const float reach = height * 0.34f * std::cbrt(chance.next(0.2f, 1));
    const glm::vec3 centre =
        foot + glm::vec3{0, 0.68f * height, 0} + reach * glm::vec3{flat * std::cos(turn), z, flat * std::sin(turn)};
    const glm::vec3 u = 0.035f * height * glm::vec3{chance.next(-1, 1), chance.next(-1, 1), chance.next(-1, 1)},
                    v = 0.035f * height * glm::vec3{chance.next(-1, 1), chance.next(-1, 1), chance.next(-1, 1)};
    append(leaves, Mesh{{centre - u, centre + v, centre + u, centre - v}, {{0, 1, 2}, {0, 2, 3}}});
  }
  add(scene, "leaves", std::move(leaves), {0.12f + 0.1f * chance.next(), 0.30f, 0.07f});
}

void lamp_post(SceneDescription& scene, const glm::vec3& foot, float height) {
  const float r = 0.012f * height;
  const std::array post{ProfilePoint{0, 0},
                        ProfilePoint{2.5f * r, 0},
                        ProfilePoint{2.5f * r, 0.06f * height},
                        ProfilePoint{r, 0.09f * height},
                        ProfilePoint{0.8f * r, 0.9f * height},
                        ProfilePoint{3 * r, 0.91f * height, 0.4f},
                        ProfilePoint{0, height}};
  scene.objects.push_back({"lamp post", placed(renderer::lathe(post, 24), foot), matt({0.06f, 0.07f, 0.07f})});
}

/// Centre line of the knot at a fraction of its length, mm.
glm::vec3 knot_line(float part) {
  const float t = 2 * pi * part, ring = 2 + 0.75f * std::cos(3 * t);
  return 470.0f * glm::vec3{ring * std::cos(2 * t), 1.05f * std::sin(3 * t), ring * std::sin(2 * t)};
}

}  // namespace

SceneDescription town_scene() {
  SceneDescription scene{.name = "town", .sky = daylight, .pose = {}};
  Chance chance(5);
  constexpr float ground = -700;
  scene.objects.push_back(
      {"square", renderer::Quad{{-40000, ground, 1000}, {80000, 0, 0}, {0, 0, -90000}},
       Diffuse{{.colour = {0.42f, 0.40f, 0.37f}, .checker = Albedo::Checker{{0.30f, 0.29f, 0.28f}, 160}}}});
  // Rows of houses on both sides of a street, and across its end.
  for (const float side : {-1.0f, 1.0f}) {
    for (float z = -4200; z > -30000;) {
      const float length = chance.next(1700, 2900), height = chance.next(1500, 3000),
                  front = 950 + chance.next(0, 300) + 0.03f * -z;
      const float a = side * front, b = side * (front + chance.next(1400, 2000));
      house(scene, chance, {std::min(a, b), ground, z - length}, {std::max(a, b), ground + height, z});
      z -= length + (chance.next() < 0.3f ? 900.0f : 60.0f);
    }
  }
  for (float x = -5200; x < 5000; x += 2600)
    house(scene, chance, {x, ground, -36000}, {x + 2400, ground + chance.next(2600, 4500), -33000});
  house(scene, chance, {-300, ground, -32000}, {800, ground + 6500, -30500});
  for (int i = 0; i < 9; ++i) {
    const float z = -3600 - 2700 * static_cast<float>(i);
    tree(scene, chance, {(i % 2 == 0 ? -640.0f : 660.0f) + chance.next(-60, 60), ground, z}, chance.next(800, 1150));
    lamp_post(scene, {i % 2 == 0 ? 560.0f : -580.0f, ground, z + 900}, 1300);
  }
  // In front of the focus: a lamp post, a railing and a stall.
  lamp_post(scene, {-420, ground, -2300}, 1500);
  Mesh railing;
  for (int i = 0; i < 14; ++i) {
    const float x = 60 + 55 * static_cast<float>(i);
    append(railing, renderer::box({x - 7, ground, -2507}, {x + 7, ground + 520, -2493}));
  }
  append(railing, renderer::box({40, ground + 500, -2512}, {800, ground + 520, -2488}));
  add(scene, "railing", std::move(railing), {0.10f, 0.22f, 0.18f});
  const glm::vec3 stall{-60, ground, -5000};
  scene.objects.push_back(
      {"awning", renderer::Quad{stall + glm::vec3{-350, 760, 120}, {700, 0, 0}, {0, 190, -420}},
       Diffuse{{.colour = {0.75f, 0.10f, 0.08f}, .checker = Albedo::Checker{{0.85f, 0.83f, 0.8f}, 100}}}});
  for (const float x : {-330.0f, 330.0f}) {
    add(scene, "stall post", renderer::box(stall + glm::vec3{x - 9, 0, 91}, stall + glm::vec3{x + 9, 760, 109}),
        {0.35f, 0.24f, 0.14f});
  }
  add(scene, "table", renderer::box(stall + glm::vec3{-340, 250, -300}, stall + glm::vec3{340, 330, 60}),
      {0.5f, 0.35f, 0.2f});
  for (int i = 0; i < 60; ++i) {
    const Rgb fruits[] = {{0.80f, 0.35f, 0.05f}, {0.65f, 0.08f, 0.05f}, {0.35f, 0.55f, 0.08f}, {0.80f, 0.68f, 0.10f}};
    const glm::vec3 centre =
        stall + glm::vec3{-310 + 42 * static_cast<float>(i % 16), 350, 30 - 70 * static_cast<float>(i / 16)};
    scene.objects.push_back({"fruit", renderer::Sphere{centre, 21}, matt(fruits[i % 16 / 4])});
  }
  return scene;
}

SceneDescription miniature_scene() {
  SceneDescription scene = town_scene();
  scene.name = "miniature";
  scene.pose = {.position = {-2600, 5600, 1500}, .look_at = {100, -500, -11000}};
  // Strong colours, like paint.
  for (renderer::Object& object : scene.objects) {
    Albedo& albedo = std::get<Diffuse>(object.material).albedo;
    const auto paint = [](Rgb& colour) {
      const float grey = (colour.x + colour.y + colour.z) / 3;
      colour = glm::clamp(grey + 1.6f * (colour - grey), Rgb(0.02f), Rgb(0.95f));
    };
    paint(albedo.colour);
    if (albedo.checker) paint(albedo.checker->other);
  }
  return scene;
}

SceneDescription lights_scene() {
  SceneDescription scene{.name = "lights", .sky = {.colour = {0.012f, 0.018f, 0.040f}}, .pose = {}};
  Chance chance(3);
  // Small lights at directions on a grid over the picture, corners included.
  constexpr int columns = 11, rows = 8;
  const std::array<Rgb, 5> colours{
      {{1, 0.95f, 0.85f}, {1, 0.62f, 0.25f}, {1, 0.95f, 0.85f}, {0.35f, 1, 0.55f}, {1, 0.16f, 0.10f}}};
  for (int i = 0; i < columns * rows; ++i) {
    const float away = chance.next(14000, 40000), x = static_cast<float>(i % columns) + chance.next(0.2f, 0.8f),
                y = static_cast<float>(i / columns) + chance.next(0.2f, 0.8f);
    const glm::vec3 centre = away * glm::vec3{0.62f * (x / columns - 0.5f), 0.48f * (y / rows - 0.5f), -1};
    scene.objects.push_back({"light", renderer::Sphere{centre, 0.0008f * away}, matt({0, 0, 0}),
                             90.0f * colours[static_cast<std::size_t>(5 * chance.next())]});
  }
  // The subject in focus.
  scene.objects.push_back({"angel", placed(renderer::angel(renderer::AngelPose::praying, 900), {-60, -520, -3000}, 12),
                           matt({6.0f, 5.6f, 5.0f})});
  return scene;
}

SceneDescription knot_scene() {
  SceneDescription scene{.name = "knot", .sky = daylight, .pose = {}};
  const glm::vec3 centre{0, 60, -3600};
  constexpr int rings = 2400, around = 180;
  Mesh tube;
  for (int i = 0; i < rings; ++i) {
    const float part = static_cast<float>(i) / rings;
    const glm::vec3 p = knot_line(part), ahead = glm::normalize(knot_line(part + 1e-3f) - knot_line(part - 1e-3f));
    const glm::vec3 across = glm::normalize(glm::cross(ahead, p + glm::vec3{1, 2, 3})),
                    other = glm::cross(ahead, across);
    for (int k = 0; k < around; ++k) {
      const float turn = 2 * pi * static_cast<float>(k) / around;
      // Knobs in spirals, and rings.
      const float bump = 12 * std::sin(9 * turn + 2 * pi * 70 * part) * std::sin(2 * pi * 210 * part) +
                         16 * std::max(0.0f, std::sin(2 * pi * 36 * part) - 0.8f) * 5;
      tube.positions.push_back(centre + p + (150 + bump) * (std::cos(turn) * across + std::sin(turn) * other));
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t next = (i + 1) % rings, side = (k + 1) % around;
      const std::uint32_t a = i * around + k, b = i * around + side, c = next * around + side, d = next * around + k;
      tube.triangles.push_back({a, b, c}), tube.triangles.push_back({a, c, d});
    }
  }
  tube.normals.assign(tube.positions.size(), glm::vec3{0, 0, 0});
  for (const auto& t : tube.triangles) {
    const glm::vec3 n =
        glm::cross(tube.positions[t[1]] - tube.positions[t[0]], tube.positions[t[2]] - tube.positions[t[0]]);
    for (const std::uint32_t corner : t) tube.normals[corner] += n;
  }
  for (glm::vec3& n : tube.normals) n = glm::normalize(n);
  scene.objects.push_back({"knot", std::move(tube), matt({0.55f, 0.30f, 0.16f})});
  scene.objects.push_back(
      {"floor", renderer::Quad{{-9000, -760, 500}, {18000, 0, 0}, {0, 0, -8500}},
       Diffuse{{.colour = {0.55f, 0.55f, 0.52f}, .checker = Albedo::Checker{{0.16f, 0.18f, 0.22f}, 220}}}});
  scene.objects.push_back(
      {"wall", renderer::Quad{{-9000, -760, -8000}, {18000, 0, 0}, {0, 9000, 0}},
       Diffuse{{.colour = {0.62f, 0.58f, 0.50f}, .checker = Albedo::Checker{{0.40f, 0.34f, 0.28f}, 350}}}});
  return scene;
}

SceneDescription leaves_scene() {
  SceneDescription scene{.name = "leaves", .sky = daylight, .pose = {}};
  Chance chance(11);
  constexpr int kinds = 6;
  std::array<Mesh, kinds> leaves;
  // Boughs are balls whose radius grows with depth, so that gaps between them are visible at any depth.
  std::array<glm::vec3, 150> boughs;
  for (glm::vec3& bough : boughs) {
    const float away = chance.next(1900, 10000), wide = 0.40f * away;
    bough = {chance.next(-wide, wide), chance.next(-0.8f * wide, 0.8f * wide), -away};
  }
  for (std::size_t i = 0; i < 120000; ++i) {
    const glm::vec3 bough = boughs[i % boughs.size()];
    const float z = chance.next(-1, 1), turn = chance.next(0, 2 * pi), flat = std::sqrt(1 - z * z);
    const glm::vec3 centre = bough - 0.055f * bough.z * std::cbrt(chance.next()) *
                                         glm::vec3{flat * std::cos(turn), flat * std::sin(turn), z};
    glm::vec3 u{chance.next(-1, 1), chance.next(-1, 1), chance.next(-1, 1)},
        v{chance.next(-1, 1), chance.next(-1, 1), chance.next(-1, 1)};
    const float size = chance.next(16, 45);
    u *= size, v *= 0.6f * size;
    append(leaves[static_cast<std::size_t>(kinds * chance.next())],
           Mesh{{centre - u - v, centre + u - v, centre + u + v, centre - u + v}, {{0, 1, 2}, {0, 2, 3}}});
  }
  const std::array<Rgb, kinds> colours{{{0.10f, 0.28f, 0.05f},
                                        {0.22f, 0.40f, 0.08f},
                                        {0.45f, 0.45f, 0.08f},
                                        {0.55f, 0.25f, 0.06f},
                                        {0.06f, 0.18f, 0.06f},
                                        {0.60f, 0.12f, 0.05f}}};
  for (std::size_t i = 0; i < kinds; ++i) add(scene, "leaves", std::move(leaves[i]), colours[i]);
  scene.objects.push_back(
      {"ground", renderer::Quad{{-30000, -2600, 1000}, {60000, 0, 0}, {0, 0, -60000}}, matt({0.22f, 0.17f, 0.11f})});
  return scene;
}

std::optional<SceneDescription> blur_scene(std::string_view name) {
  if (name == "town") return town_scene();
  if (name == "miniature") return miniature_scene();
  if (name == "lights") return lights_scene();
  if (name == "knot") return knot_scene();
  if (name == "leaves") return leaves_scene();
  if (name == "statues") return renderer::statues_scene();
  if (name == "street") {
    SceneDescription scene = renderer::street_scene();
    // LitScene has no light from the shop window.
    for (renderer::Object& object : scene.objects) {
      if (object.name == "post") object.material = matt({2, 2, 2});
      if (object.name != "sign") continue;
      Albedo& albedo = std::get<renderer::Varnish>(object.material).albedo;
      albedo.colour *= 12.0f, albedo.checker->other *= 12.0f;
    }
    return scene;
  }
  return {};
}

}  // namespace lens_blur
