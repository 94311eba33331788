// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf.hpp"
#include "renderer/integrators.hpp"
#include "renderer/light_paths.hpp"

namespace renderer {

void trace_light(const Scene& scene, const PathColours& colours, Random& random, LensConnections& connections) {
  const auto start = emit(scene, random);
  if (!start) return;
  // The lamp itself, then the surfaces that it illuminates.
  const float lamp_u = random(), lamp_v = random();
  connections.add(colours, *start, lamp_u, lamp_v);
  Lanes power = colours.from_rgb * start->from.radiance * static_cast<float>(start->cosine / start->pdf_emission);
  WorldRay ray{start->origin, start->direction};
  for (int scatterings = 1; scatterings <= max_scatterings; ++scatterings) {
    const auto met = scene.meet(ray.origin, ray.direction);
    if (!met) return;
    const Bsdf bsdf(*met, -ray.direction, colours);
    if (!bsdf.specular()) {
      const float u = random(), v = random();
      connections.add(colours, *met, bsdf, power, {}, u, v);
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
