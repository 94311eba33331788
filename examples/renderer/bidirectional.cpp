// SPDX-License-Identifier: Apache-2.0
#include "renderer/bsdf.hpp"
#include "renderer/integrators.hpp"
#include "renderer/light_paths.hpp"

namespace renderer {
namespace {

struct LightVertex {
  SurfacePoint point;
  Bsdf bsdf;
  Lanes power;
  OtherWays others;
  int scatterings;  ///< number of scatterings up to and including this vertex
};

/// One path from both ends. It reaches the lens by film samples and by connections from the light side.
class Path {
 public:
  Path(const Scene& scene, const LensView& lens, Random& random, LensConnections* connections, Splats& splats)
      : scene_(scene),
        lens_(lens),
        colours_(lens.colours()),
        random_(random),
        connections_(connections),
        splats_(splats) {
    vertices_.reserve(max_scatterings);
  }

  void from_light() {
    const auto start = emit(scene_, random_);
    if (!start) return;
    const float lamp_u = random_(), lamp_v = random_();
    if (connections_) connections_->add(colours_, *start, lamp_u, lamp_v);
    OtherWays others{start->from.pdf / start->pdf_emission, start->cosine / start->pdf_emission};
    Lanes power = colours_.from_rgb * start->from.radiance * static_cast<float>(start->cosine / start->pdf_emission);
    WorldRay ray{start->origin, start->direction};
    const bool near = start->from.surface.has_value();
    for (int k = 1; k <= max_scatterings; ++k) {
      const auto met = scene_.meet(ray.origin, ray.direction);
      if (!met) return;
      // Light from the sky starts on an area with one direction, so distance does not matter.
      others.arrive(k > 1 || near ? distance2(ray.origin, met->position) : 1, cosine(met->normal, ray.direction));
      const Bsdf bsdf(*met, -ray.direction, colours_);
      if (!bsdf.specular()) {
        vertices_.push_back({*met, bsdf, power, others, k});
        const float u = random_(), v = random_();
        if (connections_) connections_->add(colours_, *met, bsdf, power, others, u, v);
      }
      if (!scatter(*met, bsdf, Carries::power, power, others, ray)) return;
    }
  }

  void from_film(const FilmSample& sample) {
    if (!sample) return;
    Lanes radiance(0), throughput(1);
    WorldRay ray = sample.ray;
    OtherWays others;
    for (int k = 0;; ++k) {
      const auto met = scene_.meet(ray.origin, ray.direction);
      if (k == 0) {
        const auto seen = lens_.densities(sample, met ? &*met : nullptr);
        others.connected = seen.by_film > 0 ? seen.by_connection / seen.by_film : 0;
        if (met) others.arrive(1, cosine(met->normal, ray.direction));
      } else if (met) {
        others.arrive(distance2(ray.origin, met->position), cosine(met->normal, ray.direction));
      }
      if (!met) {
        const double p = scene_.pdf_sky(-ray.direction), emission = pdf_sky_emission(scene_, -ray.direction);
        radiance += throughput * (colours_.from_rgb * scene_.sky(-ray.direction)) *
                    weight(p * others.connected + emission * others.through);
        break;
      }
      if (const Rgb emitted = Scene::emission(*met, -ray.direction); emitted != Rgb(0)) {
        const double emission = pdf_emission(scene_, *met, cosine(met->normal, ray.direction));
        radiance += throughput * (colours_.from_rgb * emitted) *
                    weight(scene_.pdf_light(*met) * others.connected + emission * others.through);
      }
      if (k == max_scatterings) break;
      const Bsdf bsdf(*met, -ray.direction, colours_);
      if (!bsdf.specular()) {
        radiance += throughput * (lit(*met, bsdf, others) + connected(*met, bsdf, others, max_scatterings - k - 1));
      }
      if (!scatter(*met, bsdf, Carries::radiance, throughput, others, ray)) break;
    }
    splats_.add(colours_, sample.pixels, sample.weight * radiance);
  }

 private:
  static float weight(double other_ways) { return static_cast<float>(1 / (1 + other_ways)); }

  bool scatter(const SurfacePoint& at, const Bsdf& bsdf, Carries carries, Lanes& throughput, OtherWays& others,
               WorldRay& ray) {
    if (random_() >= bsdf.goes_on()) return false;
    const float choice = random_(), u = random_(), v = random_();
    const auto next = bsdf.sample(choice, u, v, carries);
    if (!next) return false;
    throughput *= next->weight / static_cast<float>(bsdf.goes_on());
    others.scatter(*next, bsdf.goes_on(), cosine(at.normal, next->wi));
    ray = {Scene::leave(at, next->wi), next->wi};
    return true;
  }

  /// Light directly from a lamp.
  Lanes lit(const SurfacePoint& at, const Bsdf& bsdf, const OtherWays& others) {
    const auto light = illumination(scene_, at, random_);
    if (!light) return Lanes(0);
    const Lanes f = bsdf.times_cosine(light->direction, Carries::radiance);
    if (f == Lanes(0) || !sees(scene_, at, *light)) return Lanes(0);
    const double meets = bsdf.pdf(light->direction) * bsdf.goes_on() / light->pdf;
    const double back = bsdf.pdf_reverse(light->direction) * bsdf.goes_on();
    const double emitted = light->pdf_emission * cosine(at.normal, light->direction) / (light->pdf * light->cosine);
    return f * (colours_.from_rgb * light->radiance) / static_cast<float>(light->pdf) *
           weight(meets + emitted * others.with(back));
  }

  /// Light from all vertices of the light path that have at most `most` scatterings.
  Lanes connected(const SurfacePoint& at, const Bsdf& bsdf, const OtherWays& others, int most) {
    Lanes sum(0);
    for (const LightVertex& vertex : vertices_) {
      if (vertex.scatterings > most) break;
      const double d2 = distance2(at.position, vertex.point.position);
      if (!(d2 > 0)) continue;
      const glm::vec3 connection = (vertex.point.position - at.position) / static_cast<float>(std::sqrt(d2));
      const Lanes here = bsdf.times_cosine(connection, Carries::radiance);
      if (here == Lanes(0)) continue;
      // times_cosine() includes the cosine of its argument wi, which for power is the direction -way.
      const Lanes there = vertex.bsdf.times_cosine(-connection, Carries::power);
      if (there == Lanes(0) || !scene_.sees(at, vertex.point)) continue;
      const double here_cosine = cosine(at.normal, connection), there_cosine = cosine(vertex.point.normal, connection);
      const double to_there = bsdf.pdf(connection) * bsdf.goes_on() * there_cosine / d2;
      const double to_here = vertex.bsdf.pdf(-connection) * vertex.bsdf.goes_on() * here_cosine / d2;
      const double back = bsdf.pdf_reverse(connection) * bsdf.goes_on();
      const double back_there = vertex.bsdf.pdf_reverse(-connection) * vertex.bsdf.goes_on();
      sum += here * there * vertex.power / static_cast<float>(d2) *
             weight(to_there * vertex.others.with(back_there) + to_here * others.with(back));
    }
    return sum;
  }

  const Scene& scene_;
  const LensView& lens_;
  const PathColours& colours_;
  Random& random_;
  LensConnections* connections_;
  Splats& splats_;
  std::vector<LightVertex> vertices_;
};

}  // namespace

void trace_both(const Scene& scene, const LensView& lens, const FilmSample* sample, Random& random,
                LensConnections* connections, Splats& splats) {
  Path path(scene, lens, random, connections, splats);
  path.from_light();
  if (sample) path.from_film(*sample);
}

}  // namespace renderer
