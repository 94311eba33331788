// SPDX-License-Identifier: Apache-2.0
#include "renderer/angel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "renderer/solids.hpp"

namespace renderer {
namespace {

// Lengths in thousandths of the height.

constexpr float pi = std::numbers::pi_v<float>;

Mesh ball(const glm::vec3& centre, float radius, float stretch = 1) {
  const float half_height = radius * stretch;
  // Three arcs approximate an ellipse well enough for a curl.
  const std::array profile{ProfilePoint{0, -half_height, 0.2f}, ProfilePoint{0.87f * radius, -half_height / 2, 0.25f},
                           ProfilePoint{0.87f * radius, half_height / 2, 0.2f}, ProfilePoint{0, half_height}};
  return placed(lathe(profile, 16), centre);
}

/// An elliptic cross section of an upright body: half axes at a height.
struct Section {
  float y, half_x, half_z;
};

template <std::size_t n>
Mesh upright(const std::array<Section, n>& sections, const glm::vec3& by = {0, 0, 0}) {
  std::array<TubeStation, n> stations;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& [y, half_x, half_z] = sections[i];
    stations[i] = {{-half_x, y}, {half_x, y}, half_z};
  }
  return placed(tube(stations, 48), by);
}

/// A rounded limb between two points, with a radius at each end.
Mesh limb(const glm::vec3& from, const glm::vec3& to, float first, float last) {
  const glm::vec3 axis = to - from;
  const float across = std::hypot(axis.x, axis.z);
  const glm::vec2 along = glm::normalize(glm::vec2{across, axis.y}), left{-along.y, along.x};
  const float length = glm::length(axis);
  const auto station = [&](float s, float radius) {
    return TubeStation{s * along + radius * left, s * along - radius * left, radius};
  };
  // At most slightly farther apart than the stations of the round ends, because the curve would loop between distant
  // stations.
  const int parts = std::max(1, static_cast<int>(std::ceil(length / (1.4f * std::min(first, last)))));
  std::vector<TubeStation> stations{station(-0.75f * first, 0.55f * first), station(-0.3f * first, 0.9f * first)};
  for (int i = 0; i <= parts; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(parts);
    stations.push_back(station(t * length, first + t * (last - first)));
  }
  stations.push_back(station(length + 0.3f * last, 0.9f * last));
  stations.push_back(station(length + 0.75f * last, 0.55f * last));
  return placed(tube(stations, 20), from, std::atan2(-axis.z, axis.x) * 180 / pi);
}

constexpr std::array robe{Section{0, 152, 132}, Section{30, 150, 130}, Section{200, 126, 108}, Section{400, 102, 86},
                          Section{520, 94, 78}, Section{610, 70, 58},  Section{690, 90, 70},   Section{760, 106, 60},
                          Section{798, 84, 46}, Section{822, 40, 36},  Section{850, 31, 31},   Section{890, 30, 30}};

/// Adds folds from the girdle to the hem, deeper and wider towards the hem, of varying depth.
void add_folds(Mesh& mesh) {
  constexpr int count = 26;
  for (int k = 0; k < count; ++k) {
    const float angle = 2 * pi * (static_cast<float>(k) + 0.3f * std::sin(5.0f * static_cast<float>(k))) / count;
    const float strength = 1 + 0.35f * std::sin(3.0f * static_cast<float>(k) + 1);
    std::array<TubeStation, 6> stations;
    for (std::size_t i = 1; i < stations.size(); ++i) {
      const auto& [y, half_x, half_z] = robe[6 - i];  // from the girdle down
      const float away = 1 / std::hypot(std::cos(angle) / half_x, std::sin(angle) / half_z);
      const float radius = strength * (2.5f + 3.2f * static_cast<float>(i - 1));
      // Going downwards, left is +x.
      stations[i] = {{away + 0.8f * radius, y}, {away - 1.2f * radius, y}, radius};
    }
    // The upper end is hidden in the body.
    const TubeStation& girdle = stations[1];
    stations[0] = {girdle.left + glm::vec2{-3, 30}, girdle.right + glm::vec2{-1, 30}, girdle.half_z - 1};
    append(mesh, placed(tube(stations, 12), {0, 0, 0}, -angle * 180 / pi));
  }
  for (int k = 0; k < 40; ++k) {  // the girdle's beads
    const float angle = 2 * pi * static_cast<float>(k) / 40;
    append(mesh, ball({73 * std::cos(angle), 610, 61 * std::sin(angle)}, 6.5f));
  }
}

void add_head(Mesh& body) {
  Mesh mesh;
  constexpr std::array skull{Section{868, 22, 26}, Section{882, 33, 38}, Section{905, 41, 47},
                             Section{935, 45, 53}, Section{962, 42, 50}, Section{982, 27, 33}};
  constexpr float forward = 9;
  append(mesh, upright(skull, {0, 0, forward}));
  append(mesh, limb({0, 938, forward + 51}, {0, 916, forward + 56}, 3.5f, 6));  // nose
  append(mesh, limb({-9, 897, forward + 44}, {9, 897, forward + 44}, 3, 3));    // mouth
  append(mesh, ball({0, 881, forward + 37}, 9));                                // chin
  for (const float side : {-1.0f, 1.0f}) {
    append(mesh, limb({side * 9, 942, forward + 50}, {side * 29, 940, forward + 41}, 4, 3));  // brow
    append(mesh, ball({side * 17, 929, forward + 43}, 6.5f));                                 // eye
  }
  // Curls on spirals from the crown, except over the face.
  constexpr int count = 190;
  for (int k = 0; k < count; ++k) {
    const float height = 1 - 1.55f * (static_cast<float>(k) + 0.5f) / count;  // on a unit sphere
    const float angle = static_cast<float>(k) * pi * (3 - std::sqrt(5.0f));
    const float ring = std::sqrt(1 - height * height);
    const glm::vec3 out{ring * std::cos(angle), height, ring * std::sin(angle)};
    if (out.z > 0.35f && out.y < 0.55f) continue;
    append(mesh, ball(glm::vec3{0, 935, forward - 2} + out * glm::vec3{47, 53, 54}, 10.5f));
  }
  // A seventh of the body height, the proportion of a young person.
  for (glm::vec3& position : mesh.positions)
    position = {1.1f * position.x, 1.1f * (position.y - 909), 1.1f * position.z};
  append(body, placed(std::move(mesh), {0, 901.8f, 0}));
}

/// A feather in the plane of a wing.
Mesh feather(const glm::vec2& root, const glm::vec2& tip, float half_width, float z) {
  const glm::vec2 axis = tip - root, along = glm::normalize(axis), left{-along.y, along.x};
  const auto station = [&](float s, float across_fraction, float thickness) {
    const glm::vec2 middle = root + s * axis;
    return TubeStation{middle + across_fraction * half_width * left, middle - across_fraction * half_width * left,
                       thickness};
  };
  const std::array stations{station(0, 0.4f, 4),     station(0.12f, 0.8f, 6), station(0.5f, 1, 6),
                            station(0.85f, 0.9f, 4), station(0.96f, 0.6f, 3), station(1, 0.2f, 2)};
  return placed(tube(stations, 12), {0, 0, z});
}

/// Adds a wing. side: 1 for the wing at +x, -1 for the other.
void add_wing(Mesh& mesh, float side) {
  Mesh wing;
  // Upper edge of the wing, from the shoulder.
  const auto edge = [&](float t) {
    return (1 - t) * (1 - t) * glm::vec2{side * 20, 700} + 2 * t * (1 - t) * glm::vec2{side * 95, 1095} +
           t * t * glm::vec2{side * 262, 925};
  };
  // Rows from the longest feathers (at the back) to the shortest: number, and ends of the first and the last feather.
  struct Row {
    int count;
    glm::vec2 first_tip, last_tip;
    float half_width, z;
  };
  const Row rows[] = {{13, {side * 95, 250}, {side * 400, 600}, 19, 0},
                      {11, {side * 75, 430}, {side * 360, 715}, 17, 7},
                      {10, {side * 60, 560}, {side * 322, 795}, 15, 13},
                      {9, {side * 50, 650}, {side * 296, 860}, 13, 18}};
  for (const auto& [count, first_tip, last_tip, half_width, z] : rows) {
    const glm::vec2 away{side * (last_tip.y - first_tip.y), -std::abs(last_tip.x - first_tip.x)};
    for (int k = 0; k < count; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(count - 1);
      const glm::vec2 tip = first_tip + t * (last_tip - first_tip) + 0.55f * t * (1 - t) * away;
      append(wing, feather(edge(0.1f + 0.88f * t), tip, half_width, z + 1.6f * static_cast<float>(k % 2)));
    }
  }
  std::array<TubeStation, 9> arm;
  for (std::size_t i = 0; i < arm.size(); ++i) {
    const float t = static_cast<float>(i) / (arm.size() - 1), radius = i + 1 < arm.size() ? 27 - 12 * t : 7;
    const glm::vec2 along = glm::normalize(edge(t + 0.01f) - edge(t - 0.01f)), left{-along.y, along.x};
    arm[i] = {edge(t) + radius * left, edge(t) - radius * left, radius};
  }
  append(wing, placed(tube(arm, 20), {0, 0, 12}));
  append(mesh, placed(std::move(wing), {0, 0, -62}, side * 20));
}

/// A wide sleeve, a forearm and a hand.
void add_arm(Mesh& mesh, const glm::vec3& shoulder, const glm::vec3& elbow, const glm::vec3& hand) {
  append(mesh, limb(shoulder, elbow, 33, 31));
  const glm::vec3 cuff = elbow + 0.62f * (hand - elbow), wrist = elbow + 0.9f * (hand - elbow);
  append(mesh, limb(elbow, cuff, 30, 37));
  append(mesh, limb(cuff, wrist, 17, 14));
  append(mesh, limb(wrist, hand, 14, 11));
}

}  // namespace

Mesh angel(AngelPose pose, float height) {
  Mesh mesh = upright(robe);
  add_folds(mesh);
  add_head(mesh);
  for (const float side : {-1.0f, 1.0f}) add_wing(mesh, side);
  for (const float side : {-1.0f, 1.0f}) {
    const glm::vec3 shoulder{side * 92, 760, 0};
    if (pose == AngelPose::praying) {
      add_arm(mesh, shoulder, {side * 124, 615, 45}, {side * 11, 735, 112});
    } else if (side > 0) {
      add_arm(mesh, shoulder, {190, 815, 60}, {225, 990, 105});
    } else {
      add_arm(mesh, shoulder, {-128, 625, 50}, {-8, 715, 92});
    }
  }
  constexpr std::array<ProfilePoint, 6> collar{
      {{0, 792}, {52, 792, 0.6f}, {56, 806, 0.6f}, {40, 820}, {20, 822}, {0, 822}}};
  append(mesh, lathe(collar));
  for (glm::vec3& position : mesh.positions) position *= height / 1000;
  return mesh;
}

}  // namespace renderer
