// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/lens_connections.hpp"
#include "renderer/lens_view.hpp"
#include "renderer/random.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// Paths scatter so often at most between lamp and lens, by every integrator.
inline constexpr int most_scatterings = 10;

/// Three ways to the same picture.
enum class Integrator : std::uint8_t {
  path,           ///< from the film, with connections to lamps
  light,          ///< from lamps, with connections to the lens: what only mirrors and smooth glass show is missing
  bidirectional,  ///< from both, connected at all places; multiple importance sampling weighs all of them
};
std::optional<Integrator> integrator_named(std::string_view name) noexcept;

/// One path each, or one from either end. Their sums over all film samples, one path for each sample, over the samples
/// of a pixel estimate the irradiance of the pixel in the camera's normalisation. What connections with the lens add
/// comes with LensConnections::finish(); colours have to live until then.
void trace_path(const Scene& scene, const LensView& lens, const FilmSample& sample, Random& random, Splats& splats);
void trace_light(const Scene& scene, const PathColours& colours, Random& random, LensConnections& connections);
void trace_both(const Scene& scene, const LensView& lens, const FilmSample& sample, Random& random,
                LensConnections& connections, Splats& splats);

}  // namespace renderer
