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

/// A model of the lens with the reasons for its choice.
struct ModelForScene {
  petzval::ModelKind model = petzval::ModelKind::exact_float;
  std::vector<std::string> why;
};

/// The fastest model whose rays are within `budget_px` pixels at all depths of the scene, with errors of at most 1 % in
/// exposure and 2 % in the pupil shape: petzval::choose_model(). For tilted films it is the exact lens.
ModelForScene model_within(const Scene& scene, const LensCamera& exact, double budget_px, int threads);

/// The fastest model whose bias is below a tenth of the noise of a picture with `samples` samples per pixel. Both are
/// root mean squares over the picture, of values up to white.
///
/// A pilot picture through the exact lens gives the noise of a sample, and the RMS slope and contrast. Slope and
/// contrast are products of two independent halves of the samples, so that noise does not bias them. The errors of a
/// model (petzval::choose_model()) give its bias of a pixel:
/// - an error of e pixels of rays: e times the slope, divided by sqrt 2
/// - a fraction s of wrong area of the pupil: s times the contrast
/// - an exposure error: the error times the brightness
///
/// Below the resolution of the pilot picture the number of edges per length is assumed to be the same.
ModelForScene model_below_noise(const Scene& scene, const LensCamera& exact, const PathColourSource& colours,
                                Integrator integrator, std::uint32_t samples, int threads);

}  // namespace renderer
