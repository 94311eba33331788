// SPDX-License-Identifier: Apache-2.0
#include "renderer/light_paths.hpp"

#include <cmath>
#include <numbers>

#include "renderer/frame.hpp"

namespace renderer {

using std::numbers::pi;

double pdf_emission(const Scene& scene, const SurfacePoint& lamp, double cosine) {
  return scene.pdf_light(lamp) * cosine / pi;
}

double pdf_sky_emission(const Scene& scene, const glm::vec3& travel) {
  return scene.pdf_sky(travel) / scene.sky_entry_area();
}

std::optional<Emitted> emit(const Scene& scene, Random& random) {
  const float pick = random(), u = random(), v = random(), a = random(), b = random();
  Emitted result{.from = scene.sample_light(pick, u, v)};
  if (!result.from) return {};
  if (const auto& lamp = result.from.surface) {
    const glm::vec3 about = by_cosine(a, b);
    result.direction = glm::normalize(Frame(lamp->normal).to_world(about));
    result.cosine = glm::dot(result.direction, lamp->normal);
    if (!(result.cosine > 0)) return {};
    result.origin = Scene::leave(*lamp, result.direction);
    result.pdf_emission = pdf_emission(scene, *lamp, result.cosine);
  } else {
    result.direction = result.from.travel;
    result.origin = scene.sky_entry(result.direction, a, b);
    result.pdf_emission = result.from.pdf / scene.sky_entry_area();
  }
  return result;
}

std::optional<Illumination> illumination(const Scene& scene, const SurfacePoint& at, Random& random) {
  const float pick = random(), u = random(), v = random();
  Illumination result{.from = scene.sample_light(pick, u, v)};
  if (!result.from) return {};
  result.radiance = result.from.radiance;
  if (const auto& lamp = result.from.surface) {
    const double d2 = distance2(at.position, lamp->position);
    if (!(d2 > 0)) return {};
    result.direction = (lamp->position - at.position) / static_cast<float>(std::sqrt(d2));
    result.cosine = -glm::dot(result.direction, lamp->normal);
    if (!(result.cosine > 0)) return {};
    result.pdf = result.from.pdf * d2 / result.cosine;
    result.pdf_emission = pdf_emission(scene, *lamp, result.cosine);
  } else {
    result.direction = -result.from.travel;
    result.pdf = result.from.pdf;
    result.pdf_emission = pdf_sky_emission(scene, result.from.travel);
  }
  return result;
}

bool sees(const Scene& scene, const SurfacePoint& at, const Illumination& light) {
  if (light.from.surface) return scene.sees(at, *light.from.surface);
  return scene.sees_sky(Scene::leave(at, light.direction), light.direction);
}

}  // namespace renderer
