// SPDX-License-Identifier: Apache-2.0
#include "renderer/solids.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <string>

#include "petzval/core/error.hpp"

namespace renderer {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

struct Turn {
  float cos, sin;
};
/// Direction k of `sides` around the axis. k = sides equals k = 0 to the bit, so that bodies have no seam.
Turn turn(int k, int sides) {
  const float angle = 2 * pi * static_cast<float>(k % sides) / static_cast<float>(sides);
  return {std::cos(angle), std::sin(angle)};
}

/// Connects the last two rings of a mesh, `sides` vertices each, the upper ring last, counter-clockwise seen from
/// above. A ring may be a point.
void join_rings(Mesh& mesh, int sides, bool lower_is_point, bool upper_is_point) {
  const auto count = static_cast<std::uint32_t>(sides);
  const auto upper = static_cast<std::uint32_t>(mesh.positions.size()) - count, lower = upper - count;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t next = (k + 1) % count;
    if (!lower_is_point) mesh.triangles.push_back({lower + k, lower + next, upper + next});
    if (!upper_is_point) mesh.triangles.push_back({lower + k, upper + next, upper + k});
  }
}

/// Sets vertex normals, weighted by the areas of adjacent triangles.
void smooth(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), glm::vec3{0, 0, 0});
  for (const auto& [a, b, c] : mesh.triangles) {
    const glm::vec3& p = mesh.positions[a];
    const glm::vec3 area = glm::cross(mesh.positions[b] - p, mesh.positions[c] - p);
    for (const std::uint32_t i : {a, b, c}) mesh.normals[i] += area;
  }
  for (glm::vec3& normal : mesh.normals) normal = glm::normalize(normal);
}

}  // namespace

Mesh lathe(std::span<const ProfilePoint> profile, int sides) {
  const auto on_axis = [](const ProfilePoint& p) { return p.radius == 0; };
  const auto beyond = [](const ProfilePoint& p) { return !(p.radius >= 0); };
  if (profile.size() < 3 || !on_axis(profile.front()) || !on_axis(profile.back()) ||
      std::any_of(profile.begin(), profile.end(), beyond)) {
    throw petzval::Error("lathe: profile of " + std::to_string(profile.size()) +
                         " points; must have at least 3, with radii of 0 or more, and 0 at both ends");
  }
  Mesh mesh;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const glm::vec2 from{profile[i].radius, profile[i].height}, to{profile[i + 1].radius, profile[i + 1].height};
    const glm::vec2 half = (to - from) * 0.5f, middle = from + half, out{half.y, -half.x};
    // On the arc, at angle a from its midpoint: middle + half sin(a) / sin(end) + out (cos(a) - cos(end)) / sin(end).
    const float end = 2 * std::atan(profile[i].bulge);
    const int chords = std::max(1, static_cast<int>(std::ceil(std::abs(end) * 36 / pi)));
    for (int chord = 0; chord <= chords; ++chord) {
      const float angle = end * (2 * static_cast<float>(chord) / static_cast<float>(chords) - 1);
      glm::vec2 profile_point = chord == 0 ? from : to;
      if (chord > 0 && chord < chords) {
        profile_point = middle + (half * std::sin(angle) + out * (std::cos(angle) - std::cos(end))) / std::sin(end);
      }
      const glm::vec2 normal = glm::normalize(out * std::cos(angle) + half * std::sin(angle));
      for (int k = 0; k < sides; ++k) {
        const auto [c, s] = turn(k, sides);
        mesh.positions.emplace_back(profile_point.x * c, profile_point.y, -profile_point.x * s);
        mesh.normals.emplace_back(normal.x * c, normal.y, -normal.x * s);
      }
      if (chord == 0) continue;
      join_rings(mesh, sides, chord == 1 && from.x == 0, chord == chords && to.x == 0);
    }
  }
  return mesh;
}

Mesh tube(std::span<const TubeStation> stations, int sides) {
  if (stations.size() < 2) throw petzval::Error("tube: must have at least 2 stations");
  constexpr int steps = 6;
  Mesh mesh;
  const auto ring = [&](const glm::vec2& left, const glm::vec2& right, float half_z) {
    const glm::vec2 centre = (left + right) * 0.5f, half = (right - left) * 0.5f;
    for (int k = 0; k < sides; ++k) {
      const auto [c, s] = turn(k, sides);
      mesh.positions.emplace_back(centre + half * c, -half_z * s);
    }
  };
  const auto end = [&](const TubeStation& s) { ring((s.left + s.right) * 0.5f, (s.left + s.right) * 0.5f, 0); };
  end(stations.front());
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    const TubeStation &a = stations[i == 0 ? 0 : i - 1], &b = stations[i], &c = stations[i + 1],
                      &d = stations[std::min(i + 2, stations.size() - 1)];
    const bool last = i + 2 == stations.size();
    for (int step = 0; step < steps + (last ? 1 : 0); ++step) {
      const float t = static_cast<float>(step) / steps;
      const auto curve = [&](auto member) {  // Catmull-Rom spline
        const auto slope = (c.*member - a.*member) * 0.5f, next_slope = (d.*member - b.*member) * 0.5f;
        const auto rise = c.*member - b.*member;
        return b.*member +
               t * (slope + t * ((3.0f * rise - 2.0f * slope - next_slope) + t * (slope + next_slope - 2.0f * rise)));
      };
      ring(curve(&TubeStation::left), curve(&TubeStation::right), curve(&TubeStation::half_z));
      join_rings(mesh, sides, i == 0 && step == 0, false);
    }
  }
  end(stations.back());
  join_rings(mesh, sides, false, true);
  smooth(mesh);
  return mesh;
}

Mesh box(const glm::vec3& least, const glm::vec3& most) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool upper : {false, true}) {
      glm::vec3 corner = upper ? most : least, normal{0, 0, 0};
      normal[axis] = upper ? 1.0f : -1.0f;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [at_u, at_v] : {std::pair{false, false}, {true, false}, {true, true}, {false, true}}) {
        corner[u] = at_u ? most[u] : least[u];
        corner[v] = at_v ? most[v] : least[v];
        mesh.positions.push_back(corner);
        mesh.normals.push_back(normal);
      }
      const std::uint32_t second = upper ? 1 : 3, last = upper ? 3 : 1;
      mesh.triangles.push_back({first, first + second, first + 2});
      mesh.triangles.push_back({first, first + 2, first + last});
    }
  }
  return mesh;
}

Mesh placed(Mesh mesh, const glm::vec3& by, float turn_deg) {
  const float angle = turn_deg * pi / 180, c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](const glm::vec3& v) { return glm::vec3{c * v.x + s * v.z, v.y, c * v.z - s * v.x}; };
  for (glm::vec3& position : mesh.positions) position = turned(position) + by;
  for (glm::vec3& normal : mesh.normals) normal = turned(normal);
  return mesh;
}

void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  mesh.uvs.clear();
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

}  // namespace renderer
