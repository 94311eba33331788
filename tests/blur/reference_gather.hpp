// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "petzval/blur/lens_rays.hpp"

namespace petzval::testing {

/// The image by the simplest correct code, in double: each ray of a pixel steps through all pixels on its path and all
/// layers. Without highlights.
inline BlurredImage reference_gather(const LayerSet& layers, const LensRays& rays) {
  const LayerCamera& camera = rays.camera();
  const int overscan = (layers.columns() - camera.columns) / 2;
  BlurredImage picture;
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
          double through = 1;
          double guess = std::numeric_limits<double>::quiet_NaN(), guess_alpha = 0;
          bool met = false;
          const auto floor_of = [](double place) { return std::floor(std::round(256 * place) / 256); };
          const auto index_of = [&](double x, double y) {
            const double inside_x = std::clamp(x + overscan, 0.0, layers.columns() - 1.0),
                         inside_y = std::clamp(y + overscan, 0.0, layers.rows() - 1.0);
            return static_cast<std::size_t>(inside_y * layers.columns() + inside_x);
          };
          const Vec2<double> end = ray.position + ray.slope * static_cast<double>(least);
          const bool empty = layers.inverse_depth(0)[index_of(floor_of(end.x), floor_of(end.y))] < 0;
          // Steps along the main direction: m and s are position and slope of the ray along it, o and t across.
          const bool along_x = std::abs(ray.slope.x) >= std::abs(ray.slope.y);
          const double m = along_x ? ray.position.x : ray.position.y, o = along_x ? ray.position.y : ray.position.x,
                       t = along_x ? ray.slope.y : ray.slope.x, hardly = 1e-6 / std::max(most, 1e-30f);
          double s = along_x ? ray.slope.x : ray.slope.y;
          if (std::abs(s) < hardly) s = hardly;
          const double towards = s > 0 ? -1 : 1, before_first = 1.0 / 64,
                       first = floor_of(m + s * most - towards * before_first),
                       last = floor_of(m + s * least + towards * before_first);
          const double gap = rays.largest_slope() > 0 ? 1 / rays.largest_slope() : 0;
          // Layers that the ray passed in front of in the previous pixel.
          double below = 1e30, front = -1e30, front_colour = 0, front_alpha = 0;
          for (double k = first; towards * k <= towards * last && through > 1e-3; k += towards) {
            // Inverse depths at which the ray enters and leaves the pixel.
            const double low = std::max((k + (s > 0 ? 0 : 1) - m) / s, 0.0), high = (k + (s > 0 ? 1 : 0) - m) / s,
                         w_middle = std::clamp<double>((k + 0.5 - m) / s, least, most),
                         across = floor_of(o + t * w_middle);
            const std::size_t pixel = along_x ? index_of(k, across) : index_of(across, k);
            bool met_here = false;
            double front_here = -1e30, colour_here = 0, alpha_here = 0;
            const auto meet = [&](double surface_colour, double a) {
              sum += through * ray.weight * surface_colour;
              covered += through * ray.weight * a;
              through *= 1 - a;
              met = met_here = true;
            };
            for (int layer = 0; layer < layers.count() && through > 1e-3; ++layer) {
              const auto rgba = layers.rgba(layer, pixel);
              const double w = layers.inverse_depth(layer)[pixel], a = rgba[3], c = rgba[channel];
              if (w >= 0 && w < low && front_here < 0) {
                guess = c, guess_alpha = a, front_here = w, colour_here = c, alpha_here = a;
              }
              if (w < low || w >= below) continue;
              if (w <= high) {
                meet(c, a);
              } else if (w <= front + gap && !met_here) {
                meet(front_colour, front_alpha);
              }
            }
            if (met_here) below = low;
            front = front_here, front_colour = colour_here, front_alpha = alpha_here;
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
        // Rays without a known surface take the first layer.
        const auto below = static_cast<std::size_t>((row + overscan) * layers.columns() + column + overscan);
        if (layers.inverse_depth(0)[below] < 0) continue;
        colour[channel] = layers.rgba(0, below)[channel] * total / static_cast<double>(found.size());
        alpha += layers.rgba(0, below)[3] / 3;
      }
      for (const double c : colour) picture.rgba.push_back(static_cast<float>(c));
      picture.rgba.push_back(static_cast<float>(alpha));
      picture.missed.push_back(static_cast<float>(missed));
    }
  }
  return picture;
}

}  // namespace petzval::testing
