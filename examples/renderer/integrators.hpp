// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "renderer/lens_view.hpp"
#include "renderer/picture_sums.hpp"
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

/// What paths add to a picture.
class Splats {
 public:
  void add(const PathColours& colours, const LanePixels& pixels, const Lanes& value);
  const std::vector<Contribution>& all() const noexcept { return all_; }

 private:
  std::vector<Contribution> all_;
};

/// One path each, or one from either end. Their sums over all film samples, one path for each sample, over the samples
/// of a pixel estimate the irradiance of the pixel in the camera's normalisation.
void trace_path(const Scene& scene, const LensView& lens, const FilmSample& sample, Random& random, Splats& splats);
void trace_light(const Scene& scene, const LensView& lens, Random& random, Splats& splats);
void trace_both(const Scene& scene, const LensView& lens, const FilmSample& sample, Random& random, Splats& splats);

}  // namespace renderer
