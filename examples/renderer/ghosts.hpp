// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/lens_camera.hpp"
#include "renderer/path_colours.hpp"
#include "renderer/picture_sums.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// A light whose ghosts stand for the ghosts of an equal part of the light of all ghosts.
struct GhostLight {
  petzval::ScenePoint point;  ///< lens frame
  Rgb irradiance{0, 0, 0};    ///< at the front vertex, across the beam
};

/// Samples the lamps and the sky by the light of their ghosts, from 64 candidates for each light. The part of the beam
/// that objects stop does not count. Lights behind the first surface are left out.
std::vector<GhostLight> ghost_lights(const Scene& scene, const LensCamera& lens, std::uint32_t count,
                                     std::uint32_t seed, int threads);

/// The ghosts of lights as irradiance times `scale`: channels ghosts.R, .G and .B. Light of all wavelengths counts at
/// the nearest compiled wavelength.
/// @throws petzval::Error as petzval::add_ghosts()
PictureSums::Channels ghosts(const petzval::Camera& camera, const std::vector<GhostLight>& lights,
                             const PathColourSource& colours, double scale, int threads);

}  // namespace renderer
