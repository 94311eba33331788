// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "renderer/lens_view.hpp"
#include "renderer/light_paths.hpp"
#include "renderer/other_ways.hpp"
#include "renderer/splats.hpp"

namespace renderer {

/// Places where the lens may see light: they are gathered, and connected in one call, in which the exact lens traces
/// its rays side by side.
class LensConnections {
 public:
  /// weigh: film samples find the same paths, and multiple importance sampling weighs both.
  LensConnections(const Scene& scene, const LensCamera& lens, bool weigh) : scene_(scene), lens_(lens), weigh_(weigh) {}

  /// The lamp where a light path begins, or the sky.
  void add(const PathColours& colours, const Emitted& start, float u, float v);
  /// A surface that light of a power reaches.
  void add(const PathColours& colours, const SurfacePoint& at, const Bsdf& bsdf, const Lanes& power,
           const OtherWays& others, float u, float v);

  void finish(Splats& splats, double& lens_seconds);

 private:
  struct Place {
    const PathColours* colours;
    std::optional<SurfacePoint> surface;  ///< nothing: the sky
    glm::vec3 travel;                     ///< of its light
    std::optional<Bsdf> bsdf;             ///< nothing: a lamp
    Lanes power;
    OtherWays others;
    float u, v;
  };
  std::vector<SeenRay> connect(double& lens_seconds) const;
  void splat(const Place& place, const SeenRay& seen, Splats& splats) const;

  const Scene& scene_;
  const LensCamera& lens_;
  bool weigh_;
  std::vector<Place> places_;
};

}  // namespace renderer
