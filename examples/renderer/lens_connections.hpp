// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "renderer/lens_view.hpp"
#include "renderer/light_paths.hpp"
#include "renderer/other_ways.hpp"
#include "renderer/splats.hpp"

namespace renderer {

/// Collects vertices that may connect with the lens, and connects them in one call, so that the exact lens traces rays
/// in SIMD lanes.
class LensConnections {
 public:
  /// weigh: true if film samples find the same paths; then multiple importance sampling weighs both.
  LensConnections(const Scene& scene, const LensCamera& lens, bool weigh) : scene_(scene), lens_(lens), weigh_(weigh) {}

  /// Adds the lamp or the sky where a light path begins.
  void add(const PathColours& colours, const Emitted& start, float u, float v);
  /// Adds a surface reached by light of a given power.
  void add(const PathColours& colours, const SurfacePoint& at, const Bsdf& bsdf, const Lanes& power,
           const OtherWays& others, float u, float v);

  void finish(Splats& splats, double& lens_seconds);

 private:
  struct Vertex {
    const PathColours* colours;
    std::optional<SurfacePoint> surface;  ///< nullopt: the sky
    glm::vec3 travel;                     ///< direction of the light
    std::optional<Bsdf> bsdf;             ///< nullopt: a lamp
    Lanes power;
    OtherWays others;
    float u, v;
  };
  std::vector<SeenRay> connect(double& lens_seconds) const;
  void splat(const Vertex& vertex, const SeenRay& seen, Splats& splats) const;

  const Scene& scene_;
  const LensCamera& lens_;
  bool weigh_;
  std::vector<Vertex> vertices_;
};

}  // namespace renderer
