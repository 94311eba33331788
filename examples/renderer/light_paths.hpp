// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <glm/geometric.hpp>

#include "renderer/random.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// Light that leaves a lamp, or the sky, in a random direction.
struct Emitted {
  LightPoint from;
  glm::vec3 origin{0, 0, 0}, direction{0, 0, 1};
  double cosine = 1;        ///< at the lamp; of the sky 1
  double pdf_emission = 0;  ///< of place and direction, 1/(mm^2 sr)
};
std::optional<Emitted> emit(const Scene& scene, Random& random);

/// A lamp seen from a surface, or the sky.
struct Illumination {
  LightPoint from;
  glm::vec3 direction{0, 0, 1};  ///< towards it
  Rgb radiance{0, 0, 0};
  double pdf = 0;           ///< of the direction, 1/sr
  double cosine = 1;        ///< at the lamp; of the sky 1
  double pdf_emission = 0;  ///< of emit() for this place and direction
};
std::optional<Illumination> illumination(const Scene& scene, const SurfacePoint& at, Random& random);
bool sees(const Scene& scene, const SurfacePoint& at, const Illumination& light);

/// The densities of emit() for a lamp's point and a cosine there, and for a direction of travel from the sky.
double pdf_emission(const Scene& scene, const SurfacePoint& lamp, double cosine);
double pdf_sky_emission(const Scene& scene, const glm::vec3& travel);

/// The square of the distance, and the cosine between a normal and a direction without its sign.
inline double distance2(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 way = b - a;
  return glm::dot(way, way);
}
inline double cosine(const glm::vec3& normal, const glm::vec3& direction) {
  return std::abs(glm::dot(normal, direction));
}

}  // namespace renderer
