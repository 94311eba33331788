// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <glm/geometric.hpp>

#include "renderer/random.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// Light that leaves a lamp or the sky in a random direction.
struct Emitted {
  LightPoint from;
  glm::vec3 origin{0, 0, 0}, direction{0, 0, 1};
  double cosine = 1;        ///< at the lamp; 1 for the sky
  double pdf_emission = 0;  ///< density of position and direction, 1/(mm^2 sr)
};
std::optional<Emitted> emit(const Scene& scene, Random& random);

/// Light from a lamp or the sky at a surface.
struct Illumination {
  LightPoint from;
  glm::vec3 direction{0, 0, 1};  ///< towards the light
  Rgb radiance{0, 0, 0};
  double pdf = 0;           ///< density of the direction, 1/sr
  double cosine = 1;        ///< at the lamp; 1 for the sky
  double pdf_emission = 0;  ///< density of emit() for this position and direction
};
std::optional<Illumination> illumination(const Scene& scene, const SurfacePoint& at, Random& random);
bool sees(const Scene& scene, const SurfacePoint& at, const Illumination& light);

/// Densities of emit() for a lamp point with its cosine, and for a direction of travel from the sky.
double pdf_emission(const Scene& scene, const SurfacePoint& lamp, double cosine);
double pdf_sky_emission(const Scene& scene, const glm::vec3& travel);

/// The squared distance of two points, and the absolute cosine between a normal and a direction.
inline double distance2(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 offset = b - a;
  return glm::dot(offset, offset);
}
inline double cosine(const glm::vec3& normal, const glm::vec3& direction) {
  return std::abs(glm::dot(normal, direction));
}

}  // namespace renderer
