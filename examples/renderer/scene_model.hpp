// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/lens/lens.hpp"
#include "renderer/integrators.hpp"
#include "renderer/path_colours.hpp"

namespace renderer {

/// A model of the lens, and why it is this one.
struct ModelForScene {
  petzval::ModelKind model = petzval::ModelKind::exact_float;
  std::vector<std::string> why;
};

/// The fastest model whose rays are nowhere more than so many pixels off, at the depths of a scene, with 1 % of the
/// exposure and 2 % of the pupil's shape: petzval::choose_model(). Tilted films take the exact lens.
ModelForScene model_within(const Scene& scene, const LensCamera& exact, double budget_px, int threads);

/// The fastest model whose bias is below a tenth of the noise of a picture with so many samples of each pixel, both as
/// root mean squares over the picture, of values up to white.
///
/// A small picture through the exact lens gives the noise of a sample, and how steep and how rich in contrast the
/// picture is: products of two halves, in which noise has no share. A model's errors (petzval::choose_model()) then
/// mean a bias: rays that are e pixels off change a pixel by e times the slope over sqrt 2, a pupil whose area is wrong
/// in a share s of it by s times the contrast, and an exposure by its error times the brightness. Edges that the small
/// picture does not resolve are as many along a line as those that it does.
ModelForScene model_below_noise(const Scene& scene, const LensCamera& exact, const PathColourSource& colours,
                                Integrator integrator, std::uint32_t samples, int threads);

}  // namespace renderer
