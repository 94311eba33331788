// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "petzval/blur/gather.hpp"

namespace petzval::testing {

/// The picture by the shortest code that could be right, in double: each ray of a pixel, step after step through all
/// depths, layer after layer. Without highlights.
inline Blurred reference_gather(const LayerSet& layers, const LensRays& rays, double tolerance = 0.1) {
  const LayerCamera& camera = rays.camera();
  const int overscan = (layers.columns() - camera.columns) / 2;
  Blurred picture;
  picture.columns = camera.columns, picture.rows = camera.rows;
  float most = 0;
  float least = std::numeric_limits<float>::max();
  for (int layer = 0; layer < layers.count(); ++layer) {
    for (const float w : layers.inverse_depth(layer)) {
      most = std::max(most, w);
      if (w >= 0) least = std::min(least, w);
    }
  }

  std::vector<LayerRay> found(rays.count());
  for (int row = 0; row < camera.rows; ++row) {
    for (int column = 0; column < camera.columns; ++column) {
      double colour[3] = {}, alpha = 0, missed = 0;
      for (int channel = 0; channel < 3; ++channel) {
        rays.at(std::min(channel, rays.channels() - 1), column, row, found);
        double total = 0, known = 0, lost = 0, sum = 0, covered = 0;
        for (const LayerRay& ray : found) {
          total += ray.weight;
          const double steepest =
              std::max({std::abs(ray.slope.x), std::abs(ray.slope.y), 1e-6 / std::max(most, 1e-30f)});
          double through = 1;
          double guess = std::numeric_limits<double>::quiet_NaN(), guess_alpha = 0;
          bool met = false;
          const auto pixel_at = [&](double w) {
            const Vec2<double> at = ray.at + ray.slope * w;
            const auto floor_of = [](double place) {
              return static_cast<int>(std::floor(std::round(256 * place) / 256));
            };
            const int x = std::clamp(floor_of(at.x) + overscan, 0, layers.columns() - 1),
                      y = std::clamp(floor_of(at.y) + overscan, 0, layers.rows() - 1);
            return static_cast<std::size_t>(y * layers.columns() + x);
          };
          const bool empty = layers.inverse_depth(0)[pixel_at(least)] < 0;
          double below = 1e30;
          for (int k = static_cast<int>(most * steepest + tolerance); k >= 0; --k) {
            const double low = std::max((k - tolerance) / steepest, 0.0), high = (k + 1 + tolerance) / steepest;
            const std::size_t pixel = pixel_at(std::clamp<double>((k + 0.5) / steepest, least, most));
            bool before = false, met_here = false;
            for (int layer = 0; layer < layers.count() && through > 1e-3; ++layer) {
              const double w = layers.inverse_depth(layer)[pixel], a = layers.channel(layer, 3)[pixel];
              if (w >= 0 && w < low && !before) {
                guess = layers.channel(layer, channel)[pixel], guess_alpha = a, before = true;
              }
              if (w < low || w > high || w >= below) continue;
              sum += through * ray.weight * layers.channel(layer, channel)[pixel];
              covered += through * ray.weight * a;
              through *= 1 - a;
              met = met_here = true;
            }
            if (met_here) below = low;
            if (through <= 1e-3) break;
          }
          if (met || empty) {
            known += ray.weight;
          } else {
            lost += ray.weight;
            if (!std::isnan(guess)) {
              known += ray.weight, sum += ray.weight * guess, covered += ray.weight * guess_alpha;
            }
          }
        }
        if (total > 0) missed += lost / total / 3;
        if (known > 0) {
          colour[channel] = sum / known * total / static_cast<double>(found.size());
          alpha += covered / known / 3;
          continue;
        }
        // Of rays that met what nothing is known of, the first layer is the nearest thing.
        const auto below = static_cast<std::size_t>((row + overscan) * layers.columns() + column + overscan);
        if (layers.inverse_depth(0)[below] < 0) continue;
        colour[channel] = layers.channel(0, channel)[below] * total / static_cast<double>(found.size());
        alpha += layers.channel(0, 3)[below] / 3;
      }
      for (const double c : colour) picture.rgba.push_back(static_cast<float>(c));
      picture.rgba.push_back(static_cast<float>(alpha));
      picture.missed.push_back(static_cast<float>(missed));
    }
  }
  return picture;
}

}  // namespace petzval::testing
