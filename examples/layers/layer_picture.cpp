// SPDX-License-Identifier: Apache-2.0
#include "layers/layer_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

namespace lens_blur {

using petzval::RgbImage;

petzval::PeelPlan plan_of(const LayerInput& input, const petzval::LensRays& rays, double nearest_mm) {
  petzval::PeelPlan plan = petzval::plan_peel(rays, least_depth(nearest_mm), std::numeric_limits<double>::infinity());
  if (!input.scene()) plan.camera.overscan = 0;
  return plan;
}

double threshold_of(const petzval::LayerSet& layers, bool of_file) {
  double sum = 0;
  float brightest = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; layers.count() > 0 && i < layers.inverse_depth(0).size(); ++i) {
    if (layers.inverse_depth(0)[i] < 0) continue;
    const auto rgba = layers.rgba(0, i);
    const float most = std::max({rgba[0], rgba[1], rgba[2], 0.0f});
    brightest = std::max(brightest, most);
    sum += static_cast<double>(std::min(most, 1.0f)), ++count;
  }
  const double white = of_file && brightest <= 1 ? 0.75 : 1;
  return count > 0 ? std::max(1e-3, std::min(white, 6 * sum / static_cast<double>(count))) : white;
}

RgbImage colours_of(const petzval::BlurredImage& picture) {
  RgbImage image(picture.columns, picture.rows);
  for (std::size_t i = 0; i < picture.missed.size(); ++i) std::copy_n(&picture.rgba[4 * i], 3, &image.pixels[3 * i]);
  return image;
}

RgbImage averaged(const RgbImage& image, int side) {
  if (side == 1) return image;
  RgbImage result(image.width / side, image.height / side);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c)
        result.pixel(x / side, y / side)[c] += image.pixel(x, y)[c] / static_cast<float>(side * side);
    }
  }
  return result;
}

RgbImage sharp_of(const petzval::LayerSet& layers, const petzval::LayerCamera& camera) {
  RgbImage image(camera.columns, camera.rows);
  const int overscan = (layers.columns() - camera.columns) / 2;
  for (int y = 0; y < camera.rows; ++y) {
    for (int x = 0; x < camera.columns; ++x) {
      const auto pixel = static_cast<std::size_t>((y + overscan) * layers.columns() + x + overscan);
      float through = 1;
      for (int layer = 0; layer < layers.count() && through > 0; ++layer) {
        if (layers.inverse_depth(layer)[pixel] < 0) break;
        const auto rgba = layers.rgba(layer, pixel);
        for (std::size_t c = 0; c < 3; ++c) image.pixel(x, y)[c] += through * rgba[c];
        through *= 1 - rgba[3];
      }
    }
  }
  return image;
}

std::vector<BrightPart> bright_parts(const petzval::LayerSet& layers, const petzval::LayerCamera& camera, double above,
                                     std::size_t most) {
  constexpr int side = 24;
  const RgbImage image = sharp_of(layers, camera);
  const int overscan = (layers.columns() - camera.columns) / 2;
  std::vector<BrightPart> parts(side * side);
  std::vector<double> sums(parts.size());
  for (int y = 0; y < camera.rows; ++y) {
    for (int x = 0; x < camera.columns; ++x) {
      const float* const rgb = image.pixel(x, y);
      const double sum = std::max(rgb[0], 0.0f) + std::max(rgb[1], 0.0f) + std::max(rgb[2], 0.0f);
      if (!(std::max({rgb[0], rgb[1], rgb[2]}) > above) || std::isinf(sum)) continue;
      const auto k = static_cast<std::size_t>(y * side / camera.rows * side + x * side / camera.columns);
      const auto pixel = static_cast<std::size_t>((y + overscan) * layers.columns() + x + overscan);
      sums[k] += sum;
      parts[k].raster += petzval::Vec2<double>(x + 0.5, y + 0.5) * sum;
      parts[k].inverse_depth += static_cast<double>(layers.inverse_depth(0)[pixel]) * sum;
      for (std::size_t c = 0; c < 3; ++c) parts[k].light[c] += static_cast<double>(std::max(rgb[c], 0.0f));
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (sums[k] > 0) order.push_back(k), parts[k].raster /= sums[k], parts[k].inverse_depth /= sums[k];
  }
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t k) { return sums[k]; });
  std::vector<BrightPart> result;
  for (std::size_t k = 0; k < std::min(most, order.size()); ++k) result.push_back(parts[order[k]]);
  return result;
}

}  // namespace lens_blur
