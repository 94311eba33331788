// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/psf_image.hpp"

#include <string>
#include <vector>

#include "petzval/core/error.hpp"

namespace petzval::inline v0 {

RgbImage render(const Psf& psf, std::span<const std::array<double, 3>> weights) {
  if (weights.size() != psf.wavelengths_nm.size()) {
    throw Error("render: " + std::to_string(weights.size()) + " weights, wanted one for each of " +
                std::to_string(psf.wavelengths_nm.size()) + " wavelengths");
  }
  RgbImage image(psf.pixels, psf.pixels);
  std::vector<double> sums(image.pixels.size(), 0.0);
  const std::size_t plane = sums.size() / 3;
  for (std::size_t w = 0; w < weights.size(); ++w) {
    const double per_count = psf.ray_weight(w) / (psf.pixel_mm * psf.pixel_mm);
    for (std::size_t i = 0; i < plane; ++i) {
      const double irradiance = per_count * static_cast<double>(psf.counts[w * plane + plane - 1 - i]);  // turned
      for (std::size_t k = 0; k < 3; ++k) sums[3 * i + k] += weights[w][k] * irradiance;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) image.pixels[i] = static_cast<float>(sums[i]);
  return image;
}

}  // namespace petzval::inline v0
