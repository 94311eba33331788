// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/image/image.hpp"
#include "renderer/scene_description.hpp"

/// Scenes for the lens blur, as layers and as a reference, with the shading of a real-time renderer.
namespace lens_blur {

/// A scene whose surfaces look the same from all directions, like surfaces of layers: albedo with a little noise, times
/// the light of the sky and of a low sun without shadows, plus the emission of lamps. Mirrors and glass have a plain
/// colour.
///
/// The scene is in the space of a LayerCamera in the scene's pose. Embree traces packets of 16 rays.
class LitScene {
 public:
  /// @throws petzval::Error if an object has no area or the pose has parallel directions
  explicit LitScene(const renderer::SceneDescription& description);
  ~LitScene();
  LitScene(const LitScene&) = delete;
  LitScene& operator=(const LitScene&) = delete;

  /// Moves the camera from its pose by x to the right, y up and z ahead, mm.
  void move_to(const glm::vec3& eye) noexcept { eye_ = eye; }

  /// Depth of the nearest surface seen through the pixel centres of a camera, mm; infinite if only sky is seen.
  double nearest_mm(const petzval::LayerCamera& camera, int threads) const;

  /// A point of a surface: its position in the scene (mm) and on its triangle.
  struct Hit {
    petzval::Vec3<double> position{0, 0, 0};
    petzval::TrianglePoint triangle{};
  };
  /// The first surface on a ray of the scene; nullopt: the sky.
  std::optional<Hit> first_hit(const petzval::Ray<double>& ray) const;
  /// Position of a vertex of TrianglePoint::vertices (mm).
  petzval::Vec3<double> vertex(std::size_t index) const;

  /// The layers of a camera, for LayerSet::peel: a ray through the centre of each pixel, starting at the last surface.
  /// Lamps (spheres that emit light) cover fractions of pixels: their light is integrated over each pixel.
  ///
  /// @param bias as in PeelPlan (1/mm): lamps behind a surface by less belong to the layer of the surface
  petzval::LayerSet::Peel peel(const petzval::LayerCamera& camera, int threads, double bias = 0) const;

  /// The reference picture: all rays of each pixel, traced through the triangles of the scene. As in the layers, the
  /// light of a lamp is integrated over a pixel around each ray.
  petzval::RgbImage reference(const petzval::LensRays& rays, int threads) const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
  glm::vec3 eye_{0, 0, 0};
};

}  // namespace lens_blur
