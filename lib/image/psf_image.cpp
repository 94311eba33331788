// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/psf.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

/// Irradiance of a wavelength in each pixel, per mm^2, rotated by 180 degrees.
std::vector<double> irradiance(const Psf& psf, std::size_t wavelength) {
  const std::size_t plane = static_cast<std::size_t>(psf.pixels) * static_cast<std::size_t>(psf.pixels);
  const double per_count = psf.ray_weight(wavelength) / (psf.pixel_mm * psf.pixel_mm);
  std::vector<double> values(plane);
  for (std::size_t i = 0; i < plane; ++i) {
    values[i] = per_count * static_cast<double>(psf.counts[wavelength * plane + plane - 1 - i]);
  }
  return values;
}

/// The same of an image with diffraction.
std::vector<double> irradiance(const DiffractionPsf& psf, std::size_t wavelength) {
  const auto plane = static_cast<std::ptrdiff_t>(psf.pixels) * psf.pixels;
  const auto begin = psf.irradiance.begin() + static_cast<std::ptrdiff_t>(wavelength) * plane;
  std::vector<double> values(begin, begin + plane);
  std::ranges::reverse(values);
  return values;
}

/// @param count  number of values of the image
template <class Image>
RgbImage weighted(const Image& psf, std::size_t count, std::span<const std::array<double, 3>> weights) {
  if (weights.size() != psf.wavelengths_nm.size()) {
    throw Error("render: " + std::to_string(weights.size()) + " weights; must be one for each of " +
                std::to_string(psf.wavelengths_nm.size()) + " wavelengths");
  }
  RgbImage image(psf.pixels, psf.pixels);
  if (const std::size_t expected_size = weights.size() * image.pixels.size() / 3; count != expected_size) {
    throw Error("render: counts = " + std::to_string(count) + "; must be " + std::to_string(expected_size) +
                ", one for each pixel and wavelength");
  }
  std::vector<double> sums(image.pixels.size(), 0.0);
  for (std::size_t w = 0; w < weights.size(); ++w) {
    const auto light = irradiance(psf, w);
    for (std::size_t i = 0; i < light.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sums[3 * i + k] += weights[w][k] * light[i];
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) image.pixels[i] = static_cast<float>(sums[i]);
  return image;
}

}  // namespace

RgbImage render(const Psf& psf, std::span<const std::array<double, 3>> weights) {
  return weighted(psf, psf.counts.size(), weights);
}

RgbImage render(const DiffractionPsf& psf, std::span<const std::array<double, 3>> weights) {
  return weighted(psf, psf.irradiance.size(), weights);
}

ExrPart spectral_image(const Psf& psf, std::span<const std::array<double, 3>> weights) {
  const RgbImage rgb = render(psf, weights);
  ExrPart part{.width = psf.pixels,
               .height = psf.pixels,
               .texts = {{"spectralLayoutVersion", "1.0"}, {"emissiveUnits", "mm^-2"}}};
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float>& values = part.channels[std::string(1, "RGB"[k])];
    for (std::size_t i = k; i < rgb.pixels.size(); i += 3) values.push_back(rgb.pixels[i]);
  }
  for (std::size_t w = 0; w < psf.wavelengths_nm.size(); ++w) {
    std::string nm = to_text(psf.wavelengths_nm[w]);
    std::replace(nm.begin(), nm.end(), '.', ',');
    const auto light = irradiance(psf, w);
    part.channels["S0." + nm + "nm"].assign(light.begin(), light.end());
  }
  return part;
}

}  // namespace petzval
