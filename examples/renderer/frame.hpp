// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

namespace renderer {

/// Orthonormal axes whose z is a given unit vector.
/// Source: Duff et al., Building an orthonormal basis, revisited, 2017.
struct Frame {
  glm::vec3 x, y, z;

  explicit Frame(const glm::vec3& n) : z(n) {
    const float sign = std::copysign(1.0f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    x = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    y = {b, sign + n.y * n.y * a, -n.y};
  }
  glm::vec3 to_world(const glm::vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  glm::vec3 to_local(const glm::vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
};

/// Maps the unit square to the unit disc, uniform by area; neighbours stay neighbours.
/// Source: Shirley, Chiu, A low distortion map between disk and square, 1997.
inline glm::vec2 on_disc(float u, float v) {
  constexpr auto pi = std::numbers::pi_v<float>;
  const float a = 2 * u - 1, b = 2 * v - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool along = std::abs(a) > std::abs(b);
  const float radius = along ? a : b, angle = along ? pi / 4 * (b / a) : pi / 2 - pi / 4 * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Maps the unit square to directions, uniform over the sphere.
inline glm::vec3 on_sphere(float u, float v) {
  const float z = 1 - 2 * u, radius = std::sqrt(std::max(0.0f, 1 - z * z));
  const float angle = 2 * std::numbers::pi_v<float> * v;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Maps the unit square to directions about +z with the density cos / pi.
inline glm::vec3 by_cosine(float u, float v) {
  const glm::vec2 d = on_disc(u, v);
  return {d, std::sqrt(std::max(0.0f, 1 - glm::dot(d, d)))};
}

}  // namespace renderer
