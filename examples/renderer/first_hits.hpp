// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "renderer/lens_camera.hpp"
#include "renderer/picture_sums.hpp"
#include "renderer/scene.hpp"

namespace renderer {

class UnitTracer;

/// Weighted sums over the first surfaces that the rays of a pixel meet.
struct FirstHit {
  glm::dvec3 albedo{0}, normal{0};
  double depth = 0, met = 0, all = 0;  ///< met, all: weights of the rays that meet a surface, and of all rays

  void add(const std::optional<SurfacePoint>& point, const glm::vec3& direction, float weight,
           const LensCamera& lens) noexcept;
};

/// Channels that help to denoise a picture: means over rays through the lens, weighted like the picture.
///
/// - albedo.R, .G, .B: fraction of light that the surface scatters: albedo or reflectance of its material, 1 for glass
/// - normal.X, .Y, .Z: shading normal in the world, turned towards the lens; its length is below 1 in blurred pixels
/// - depth.Z: distance from the front vertex along the axis (mm), mean over the rays that meet a surface
///
/// Sky counts as albedo 0 and normal 0; a pixel without surface has an infinite depth. The channels depend on the seed
/// and not on the number of samples: each pixel has 32 rays of its own.
/// @param tiles  tiles of the picture to be traced; other tiles are 0
PictureSums::Channels first_hits(const UnitTracer& tracer, const PictureSums& sums,
                                 const std::vector<std::size_t>& tiles, int threads);

}  // namespace renderer
