// SPDX-License-Identifier: Apache-2.0
#include "renderer/lens_connections.hpp"

#include <algorithm>

namespace renderer {

void LensConnections::add(const PathColours& colours, const Emitted& start, float u, float v) {
  const Lanes emitted = colours.from_rgb * start.from.radiance / static_cast<float>(start.from.pdf);
  vertices_.push_back(
      {&colours, start.from.surface, start.from.travel, {}, emitted, {.connected = 1 / start.from.pdf}, u, v});
}

void LensConnections::add(const PathColours& colours, const SurfacePoint& at, const Bsdf& bsdf, const Lanes& power,
                          const OtherWays& others, float u, float v) {
  vertices_.push_back({&colours, at, {}, bsdf, power, others, u, v});
}

std::vector<SeenRay> LensConnections::connect(double& lens_seconds) const {
  const Stopwatch watch(lens_seconds);
  std::vector<LensCamera::Request> requests;
  std::vector<std::size_t> surfaces;
  std::vector<float> nm;
  const bool one = vertices_.empty() || vertices_.front().colours->one_wavelength;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Vertex& vertex = vertices_[i];
    if (!vertex.surface) continue;
    surfaces.push_back(i);
    requests.push_back({vertex.surface->position, vertex.u, vertex.v});
    if (!one) nm.push_back(vertex.colours->nm[static_cast<std::size_t>(vertex.colours->hero)]);
  }
  const auto found = lens_.connect(requests, nm);
  std::vector<SeenRay> seen(vertices_.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Vertex& vertex = vertices_[surfaces[s]];
    seen[surfaces[s]] =
        LensView(lens_, *vertex.colours, lens_seconds).at_all_lanes(found[s], &vertex.surface->position);
  }
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Vertex& vertex = vertices_[i];
    if (vertex.surface) continue;
    const LensView view(lens_, *vertex.colours, lens_seconds);
    seen[i] = view.at_all_lanes(lens_.connect_distant(vertex.travel, vertex.u, vertex.v, view.hero()), nullptr);
  }
  return seen;
}

void LensConnections::splat(const Vertex& vertex, const SeenRay& seen, Splats& splats) const {
  if (!seen) return;
  Lanes f(1);
  double facing = 1, back = 0;
  if (vertex.surface) {
    const glm::vec3& normal = vertex.surface->normal;
    facing = cosine(normal, seen.direction);
    if (vertex.bsdf) {
      f = vertex.bsdf->times_cosine(seen.direction, Carries::power);
      if (f == Lanes(0)) return;
      back = vertex.bsdf->pdf_reverse(seen.direction) * vertex.bsdf->goes_on();
    } else {
      if (!(glm::dot(normal, seen.direction) > 0)) return;
      f = Lanes(static_cast<float>(facing));
    }
    if (!scene_.sees(*vertex.surface, seen.on_front)) return;
  } else if (!scene_.sees_sky(seen.on_front, -seen.direction)) {
    return;
  }
  const double film = seen.by_film * facing / seen.by_connection;
  const auto weight = static_cast<float>(1 / (weigh_ ? 1 + film * vertex.others.with(back) : 1));
  splats.add(*vertex.colours, seen.pixels,
             vertex.power * f * seen.we * (weight / static_cast<float>(seen.by_connection)));
}

void LensConnections::finish(Splats& splats, double& lens_seconds) {
  const std::vector<SeenRay> seen = connect(lens_seconds);
  for (std::size_t i = 0; i < vertices_.size(); ++i) splat(vertices_[i], seen[i], splats);
  vertices_.clear();
}

}  // namespace renderer
