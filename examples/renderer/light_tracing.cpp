// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf.hpp"
#include "renderer/integrators.hpp"
#include "renderer/light_paths.hpp"

namespace renderer {

void trace_light(const Scene& scene, const LensView& lens, Random& random, Splats& splats) {
  const auto start = emit(scene, random);
  if (!start) return;
  const PathColours& colours = lens.colours();
  const Lanes emitted = colours.from_rgb * start->from.radiance;
  // The lamp itself, then what it lights.
  {
    const float u = random(), v = random();
    const auto& lamp = start->from.surface;
    const SeenRay seen = lamp ? lens.connect(*lamp, u, v) : lens.connect_sky(start->direction, u, v);
    const double facing = lamp ? glm::dot(lamp->normal, seen.direction) : 1;
    if (seen && facing > 0 &&
        (lamp ? scene.sees(*lamp, seen.on_front) : scene.sees_sky(seen.on_front, -seen.direction))) {
      const double density = start->from.pdf * seen.by_connection;
      splats.add(colours, seen.pixels, emitted * seen.we * static_cast<float>(facing / density));
    }
  }
  Lanes power = emitted * static_cast<float>(start->cosine / start->pdf_emission);
  WorldRay ray{start->origin, start->direction};
  for (int scatterings = 1; scatterings <= most_scatterings; ++scatterings) {
    const auto met = scene.meet(ray.origin, ray.direction);
    if (!met) return;
    const Bsdf bsdf(*met, -ray.direction, colours);
    if (!bsdf.specular()) {
      const float u = random(), v = random();
      const SeenRay seen = lens.connect(*met, u, v);
      if (seen) {
        const Lanes f = bsdf.times_cosine(seen.direction, Carries::power);
        if (f != Lanes(0) && scene.sees(*met, seen.on_front)) {
          splats.add(colours, seen.pixels, power * f * seen.we / static_cast<float>(seen.by_connection));
        }
      }
    }
    if (random() >= bsdf.goes_on()) return;
    const float choice = random(), u = random(), v = random();
    const auto next = bsdf.sample(choice, u, v, Carries::power);
    if (!next) return;
    power *= next->weight / static_cast<float>(bsdf.goes_on());
    ray = {Scene::leave(*met, next->wi), next->wi};
  }
}

}  // namespace renderer
