// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderer/scene_description.hpp"

namespace renderer {

/// The sky as a light: directions are drawn by radiance.
class SkyLight {
 public:
  /// Throws petzval::Error for an image without pixels, or with radiances that are negative or not finite.
  explicit SkyLight(const Sky& sky);

  /// In a direction of travel, from the sky.
  Rgb radiance(const glm::vec3& travel) const noexcept;
  /// A direction of travel.
  glm::vec3 sample(float u, float v) const noexcept;
  double pdf(const glm::vec3& travel) const noexcept;  ///< 1/sr
  /// Luminance over the sphere of directions.
  double total() const noexcept { return total_; }

 private:
  std::size_t pixel_of(const glm::vec3& travel) const noexcept;
  double sine_above(std::size_t row) const noexcept;

  Sky sky_;
  std::size_t columns_ = 1, rows_ = 1;  ///< of the image; a plain sky is one pixel
  std::vector<double> ends_;            ///< of the pixels, row by row: their share of the light and that before it
  double total_ = 0;
};

}  // namespace renderer
