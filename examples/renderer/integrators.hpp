// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/lens_connections.hpp"
#include "renderer/lens_view.hpp"
#include "renderer/random.hpp"
#include "renderer/scene.hpp"

namespace renderer {

/// Largest number of scatterings between lamp and lens, for all integrators.
inline constexpr int max_scatterings = 10;

/// Integrators. All converge to the same picture, except that `light` misses some paths.
enum class Integrator : std::uint8_t {
  path,           ///< from the film, with connections to lamps
  light,          ///< from lamps, with connections to the lens; misses views through mirrors and smooth glass
  bidirectional,  ///< from both, connected at all vertices, weighted by multiple importance sampling
};
std::optional<Integrator> integrator_named(std::string_view name) noexcept;

/// Trace one path from the film, from a lamp, or from both. The sum over all film samples, with one path per sample,
/// divided by the samples of a pixel, estimates the irradiance of the pixel in the camera's normalisation. Connections
/// with the lens are added by LensConnections::finish(); colours must live until then.
void trace_path(const Scene& scene, const LensView& lens, const FilmSample& sample, Random& random, Splats& splats);
void trace_light(const Scene& scene, const PathColours& colours, Random& random, LensConnections& connections);
/// Either end may be left out, by a null sample or null connections; the numbers of the path stay the same.
void trace_both(const Scene& scene, const LensView& lens, const FilmSample* sample, Random& random,
                LensConnections* connections, Splats& splats);

}  // namespace renderer
