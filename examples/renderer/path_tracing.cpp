// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf.hpp"
#include "renderer/integrators.hpp"
#include "renderer/light_paths.hpp"

namespace renderer {

void trace_path(const Scene& scene, const LensView& lens, const FilmSample& sample, Random& random, Splats& splats) {
  if (!sample) return;
  const PathColours& colours = lens.colours();
  Lanes radiance(0), throughput(1);
  WorldRay ray = sample.ray;
  double pdf = 0;        // density of the ray's direction
  bool specular = true;  // true if no connection could have found the lamp that the ray meets
  for (int scatterings = 0;; ++scatterings) {
    const auto met = scene.meet(ray.origin, ray.direction);
    // Weight of a lamp hit by chance if a connection has the density p: balance heuristic.
    const auto by_chance = [&](double p) { return specular ? 1.0f : static_cast<float>(pdf / (pdf + p)); };
    if (!met) {
      radiance +=
          throughput * (colours.from_rgb * scene.sky(-ray.direction)) * by_chance(scene.pdf_sky(-ray.direction));
      break;
    }
    if (const Rgb emitted = Scene::emission(*met, -ray.direction); emitted != Rgb(0)) {
      const double p =
          scene.pdf_light(*met) * distance2(ray.origin, met->position) / cosine(met->normal, ray.direction);
      radiance += throughput * (colours.from_rgb * emitted) * by_chance(p);
    }
    if (scatterings == max_scatterings) break;
    const Bsdf bsdf(*met, -ray.direction, colours);
    if (!bsdf.specular()) {
      if (const auto light = illumination(scene, *met, random)) {
        const Lanes f = bsdf.times_cosine(light->direction, Carries::radiance);
        if (f != Lanes(0) && sees(scene, *met, *light)) {
          const double meets = bsdf.pdf(light->direction) * bsdf.goes_on();
          radiance += throughput * f * (colours.from_rgb * light->radiance) / static_cast<float>(light->pdf + meets);
        }
      }
    }
    if (random() >= bsdf.goes_on()) break;
    const float choice = random(), u = random(), v = random();
    const auto next = bsdf.sample(choice, u, v, Carries::radiance);
    if (!next) break;
    throughput *= next->weight / static_cast<float>(bsdf.goes_on());
    pdf = next->pdf * bsdf.goes_on();
    specular = next->specular;
    ray = {Scene::leave(*met, next->wi), next->wi};
  }
  splats.add(colours, sample.pixels, sample.weight * radiance);
}

}  // namespace renderer
