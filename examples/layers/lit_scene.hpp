// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/image/image.hpp"
#include "renderer/scene_description.hpp"

/// Scenes for the lens blur: what a real-time renderer shows of them, as layers and as a reference.
namespace lens_blur {

/// A scene whose surfaces look alike from all sides, as those of layers do: albedo with a little noise, times the light
/// of the sky and of a low sun without shadows, and what lamps emit. Mirrors and glass have a plain colour.
///
/// Its space is that of a LayerCamera in the scene's pose. Embree traces packets of 16 rays.
class LitScene {
 public:
  /// Throws petzval::Error for an object without area, and a pose without directions.
  explicit LitScene(const renderer::SceneDescription& description);
  ~LitScene();
  LitScene(const LitScene&) = delete;
  LitScene& operator=(const LitScene&) = delete;

  /// Moves the camera from its pose: to the right, up and ahead, mm.
  void move_to(const glm::vec3& place) noexcept { eye_ = place; }

  /// Depth of the nearest thing that a camera sees through the centres of its pixels, mm; infinity for sky alone.
  double nearest_mm(const petzval::LayerCamera& camera, int threads) const;

  /// The layers of a camera, for LayerSet::peel: a ray through the centre of each pixel, from the last surface on.
  petzval::LayerSet::Peel peel(const petzval::LayerCamera& camera, int threads) const;

  /// The picture of rays through the scene itself: all of each pixel, traced through its triangles.
  petzval::RgbImage reference(const petzval::LensRays& rays, int threads) const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
  glm::vec3 eye_{0, 0, 0};
};

}  // namespace lens_blur
