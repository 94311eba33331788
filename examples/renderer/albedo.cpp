// SPDX-License-Identifier: Apache-2.0
#include "renderer/albedo.hpp"

#include <cmath>
#include <glm/common.hpp>

namespace renderer {
namespace {

/// Parity of the checker cube along one axis. Cubes are centred at the origin: their faces do not lie in a plane
/// through the origin, such as a floor, where rounding would choose the colour.
bool odd(float x, float size) { return std::fmod(std::floor(x / size + 0.5f), 2.0f) != 0; }

int wrapped(int i, int count) {
  const int rest = i % count;
  return rest < 0 ? rest + count : rest;
}

Rgb interpolated(const petzval::RgbImage& image, const glm::vec2& uv) {
  const float x = (uv.x - std::floor(uv.x)) * static_cast<float>(image.width) - 0.5f;
  const float y = (1 - (uv.y - std::floor(uv.y))) * static_cast<float>(image.height) - 0.5f;
  const int left = static_cast<int>(std::floor(x)), upper = static_cast<int>(std::floor(y));
  const float right_weight = x - static_cast<float>(left), lower_weight = y - static_cast<float>(upper);
  const auto pixel = [&](int column, int row) {
    const float* const p = image.pixel(wrapped(column, image.width), wrapped(row, image.height));
    return Rgb{p[0], p[1], p[2]};
  };
  const Rgb above = glm::mix(pixel(left, upper), pixel(left + 1, upper), right_weight);
  const Rgb below = glm::mix(pixel(left, upper + 1), pixel(left + 1, upper + 1), right_weight);
  return glm::clamp(glm::mix(above, below, lower_weight), 0.0f, 1.0f);
}

}  // namespace

Rgb at(const Albedo& albedo, const glm::vec3& point_world, const glm::vec2& uv) {
  if (albedo.image) return interpolated(*albedo.image, uv);
  if (!albedo.checker) return albedo.colour;
  const float size = albedo.checker->size_mm;
  const bool other = odd(point_world.x, size) != odd(point_world.y, size);
  return other != odd(point_world.z, size) ? albedo.checker->other : albedo.colour;
}

Rgb reflectance(const Material& material, const glm::vec3& point_world, const glm::vec2& uv) {
  return std::visit(
      [&](const auto& own) {
        if constexpr (requires { own.albedo; }) {
          return at(own.albedo, point_world, uv);
        } else if constexpr (requires { own.reflectance; }) {
          return own.reflectance;
        } else {
          return Rgb(1);
        }
      },
      material);
}

}  // namespace renderer
