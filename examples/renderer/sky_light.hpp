// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/scene_description.hpp"

namespace renderer {

/// The sky as a light source: directions are sampled by radiance.
class SkyLight {
 public:
  /// @throws petzval::Error if the image has no pixels, or a radiance is negative or not finite
  explicit SkyLight(const Sky& sky);

  /// Radiance by direction of travel, from the sky.
  Rgb radiance(const glm::vec3& travel) const noexcept;
  /// Samples a direction of travel.
  glm::vec3 sample(float u, float v) const noexcept;
  double pdf(const glm::vec3& travel) const noexcept;  ///< 1/sr
  /// Integral of the luminance over the sphere of directions.
  double total() const noexcept { return total_; }

 private:
  std::size_t pixel_of(const glm::vec3& travel) const noexcept;
  double sine_above(std::size_t row) const noexcept;

  Sky sky_;
  std::size_t columns_ = 1, rows_ = 1;  ///< size of the image; 1 x 1 for a plain sky
  std::vector<double> ends_;            ///< cumulative fractions of the light, by pixel and row
  double total_ = 0;
};

}  // namespace renderer
