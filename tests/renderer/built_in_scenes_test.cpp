// SPDX-License-Identifier: Apache-2.0
#include "renderer/built_in_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <variant>
#include <vector>

namespace {

using namespace renderer;

bool emits(const Object& object) { return object.emission != Rgb(0, 0, 0); }

/// Tangents of the direction to a point from the camera, and its depth.
struct Seen {
  double right, up, depth;
};
Seen seen(const SceneDescription& scene, const glm::vec3& place) {
  const glm::dvec3 forward = glm::normalize(scene.pose.look_at - scene.pose.position);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, scene.pose.up)), up = glm::cross(right, forward);
  const glm::dvec3 way = glm::dvec3(place) - scene.pose.position;
  const double depth = glm::dot(way, forward);
  return {glm::dot(way, right) / depth, glm::dot(way, up) / depth, depth};
}
/// True if a point is in the image of a lens of 100 mm on a film of 36 x 24 mm, for any focus.
bool in_picture(const Seen& at) { return at.depth > 0 && std::abs(at.right) < 0.18 && std::abs(at.up) < 0.12; }

TEST(BuiltInScenes, HaveTheNamesInTheHelp) {
  std::string names;
  for (const char* name : {"balls", "chess", "statues", "street", "table"}) {
    const auto scene = built_in_scene(name);
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->name, name);
    names += (names.empty() ? "" : ", ") + scene->name;
  }
  EXPECT_EQ(names, built_in_scene_names);
  EXPECT_FALSE(built_in_scene("ball"));
}

TEST(BallsScene, IsARowAtOneDistanceToTheEdgeOfTheImage) {
  const SceneDescription scene = balls_scene();
  int balls = 0;
  double last = 0;
  for (const Object& object : scene.objects) {
    const auto* const sphere = std::get_if<Sphere>(&object.shape);
    if (!sphere) continue;
    const Seen at = seen(scene, sphere->centre);
    if (emits(object)) {
      EXPECT_FALSE(in_picture(at));
      continue;
    }
    ++balls;
    EXPECT_FLOAT_EQ(sphere->centre.z, -1050 - sphere->radius / 2);
    EXPECT_EQ(sphere->centre.y, 0);
    EXPECT_TRUE(in_picture(at));
    last = std::max(last, at.right);
  }
  EXPECT_EQ(balls, 13);
  EXPECT_GT(last, 0.14);
}

TEST(ChessScene, PiecesStandOnTheBoardAtManyDepths) {
  const SceneDescription scene = chess_scene();
  int pieces = 0, lamps = 0;
  double nearest = 1e9, farthest = 0;
  for (const Object& object : scene.objects) {
    if (const auto* const lamp = std::get_if<Sphere>(&object.shape)) {
      EXPECT_TRUE(emits(object));
      const Seen at = seen(scene, lamp->centre);
      EXPECT_TRUE(in_picture(at));
      EXPECT_GT(at.depth, 2000);
      ++lamps;
    }
    if (object.name.rfind("piece", 0) != 0) continue;
    ++pieces;
    glm::vec3 foot{0, 0, 0};
    int of_foot = 0;
    for (const glm::vec3& p : std::get<Mesh>(object.shape).positions)
      if (p.y == 0) foot += p, ++of_foot;
    foot /= static_cast<float>(of_foot);
    // Centres of squares; the lines are at odd multiples of 20.
    EXPECT_NEAR(std::remainder(foot.x, 40.0f), 0, 1e-3) << object.name;
    EXPECT_NEAR(std::remainder(foot.z, 40.0f), 0, 1e-3) << object.name;
    const double depth = seen(scene, foot).depth;
    nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
  }
  EXPECT_EQ(pieces, 22);
  EXPECT_EQ(lamps, 9);
  EXPECT_NEAR(nearest, 790, 5);
  EXPECT_NEAR(farthest, 1110, 5);
}

TEST(StatuesScene, HasANearAndAFarAngelAndFiguresBetween) {
  const SceneDescription scene = statues_scene();
  struct Statue {
    double nearest = 1e9, farthest = 0, left = 1e9, right = -1e9, low = 1e9, high = -1e9;
  };
  std::vector<Statue> statues;
  for (const Object& object : scene.objects) {
    if (object.name != "statue") continue;
    Statue& s = statues.emplace_back();
    for (const glm::vec3& p : std::get<Mesh>(object.shape).positions) {
      const Seen at = seen(scene, p);
      s.nearest = std::min(s.nearest, at.depth), s.farthest = std::max(s.farthest, at.depth);
      s.left = std::min(s.left, at.right), s.right = std::max(s.right, at.right);
      s.low = std::min(s.low, at.up), s.high = std::max(s.high, at.up);
    }
  }
  int lanterns = 0;
  for (const Object& object : scene.objects) {
    if (object.name != "lantern") continue;
    ++lanterns;
    EXPECT_TRUE(emits(object));
    EXPECT_LT(std::abs(seen(scene, std::get<Sphere>(object.shape).centre).right), 0.36);
  }
  EXPECT_EQ(lanterns, 20);
  ASSERT_EQ(statues.size(), 6u);
  // In the image of a lens of 50 mm the near angel is left and the far angel right of the centre, and each fills at
  // least half of the height.
  const Statue &near = statues[0], &far = statues[1];
  EXPECT_LT(near.right, 0);
  EXPECT_GT(far.left, 0);
  for (const Statue& s : {near, far}) {
    EXPECT_TRUE(s.left > -0.36 && s.right < 0.36 && s.high < 0.24 && s.low > -0.24);
    EXPECT_GT(s.high - s.low, 0.24);
  }
  EXPECT_TRUE(near.nearest > 1300 && near.farthest < 1700);
  EXPECT_TRUE(far.nearest > 5400 && far.farthest < 6600);
  for (std::size_t i = 2; i < statues.size(); ++i) {
    EXPECT_TRUE(statues[i].farthest < near.nearest || statues[i].nearest > near.farthest) << i;
  }
}

TEST(StreetScene, LightsAreInTheImageAndWindowsFaceTheStreet) {
  const SceneDescription scene = street_scene();
  int lights = 0, windows = 0;
  double nearest = 1e9, farthest = 0;
  for (const Object& object : scene.objects) {
    if (const auto* const light = std::get_if<Sphere>(&object.shape)) {
      const Seen at = seen(scene, light->centre);
      lights += in_picture(at);
      nearest = std::min(nearest, at.depth), farthest = std::max(farthest, at.depth);
    }
    if (object.name == "window") {
      const auto& quad = std::get<Quad>(object.shape);
      EXPECT_LT(glm::cross(quad.edge_u, quad.edge_v).x * quad.corner.x, 0);  // towards the centre
      ++windows;
    }
  }
  EXPECT_GT(lights, 60);
  EXPECT_GT(windows, 20);
  EXPECT_LT(nearest, 6000);
  EXPECT_GT(farthest, 180000);
}

TEST(TableScene, LampsAreFarBehindTheTableNearAllCorners) {
  const SceneDescription scene = table_scene();
  std::array<int, 4> corners{};
  for (const Object& object : scene.objects) {
    if (!emits(object)) continue;
    const Seen at = seen(scene, std::get<Sphere>(object.shape).centre);
    if (!in_picture(at)) continue;
    EXPECT_GT(at.depth, 2000);
    if (std::abs(at.right) > 0.13 && std::abs(at.up) > 0.08) {
      ++corners[static_cast<std::size_t>((at.right > 0 ? 1 : 0) + (at.up > 0 ? 2 : 0))];
    }
  }
  for (const int lamps : corners) EXPECT_EQ(lamps, 1);
}

}  // namespace
