// SPDX-License-Identifier: Apache-2.0
#include "single_image_blur.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/parallel.hpp"

namespace {

using std::numbers::pi;

/// A point of a disc of radius 1.
struct Offset {
  float x, y, distance;
};

/// Light and its fraction of a pixel.
struct Sum {
  float colour[3] = {}, share = 0;

  void add(const float* c, float weight) {
    for (int i = 0; i < 3; ++i) colour[i] += weight * c[i];
    share += weight;
  }
};

class SingleImage {
 public:
  SingleImage(const petzval::LayerSet& layers, const petzval::LayerCamera& camera, const CircleOfConfusion& circle,
              int taps)
      : width_(layers.columns()),
        height_(layers.rows()),
        left_((layers.columns() - camera.columns) / 2),
        top_((layers.rows() - camera.rows) / 2) {
    const auto w = layers.inverse_depth(0);
    off_focus_.resize(w.size());
    pixels_.resize(3 * w.size());
    for (std::size_t i = 0; i < w.size(); ++i) {
      off_focus_[i] =
          static_cast<float>(circle.px_mm * (std::max(static_cast<double>(w[i]), 0.0) - circle.inverse_focus));
      for (std::size_t c = 0; c < 3; ++c) pixels_[3 * i + c] = layers.rgba(0, i)[c];
    }
    for (const petzval::PupilPoint& p : petzval::vogel_points(taps)) {
      const double radius = std::sqrt(p.v), angle = 2 * pi * p.u;
      spiral_.push_back({static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)),
                         static_cast<float>(radius)});
    }
    find_reach();
  }

  void blur(int x, int y, float* to) const {
    const int column = x + left_, row = y + top_;
    const std::size_t middle = at(column, row);
    const float own = std::max(std::abs(off_focus_[middle]), least_radius);
    const float near = reach_[static_cast<std::size_t>(row / tile) * tiles_ + static_cast<std::size_t>(column / tile)];
    const bool once = near <= own;

    Sum behind, before;
    // The pixel itself, so that the sum is never empty.
    behind.add(&pixels_[3 * middle], 1 / own / own);
    gather(column, row, own, [&](std::size_t i, float distance) {
      // Fractions of discs; the area of a tap is the area of the disc divided by the number of taps.
      if (is_before(i, middle)) {
        if (once) before.add(&pixels_[3 * i], disc(i, distance));
      } else if (is_before(middle, i)) {
        behind.add(&pixels_[3 * i], 1 / own / own);
      } else {
        behind.add(&pixels_[3 * i], disc(i, distance));
      }
    });
    if (!once) {
      gather(column, row, near, [&](std::size_t i, float distance) {
        if (is_before(i, middle)) before.add(&pixels_[3 * i], disc(i, distance));
      });
    }
    const float tap_area = std::max(own, near) * std::max(own, near) / static_cast<float>(spiral_.size()),
                covered = before.share * tap_area, cover = std::min(covered, 1.0f);
    for (int c = 0; c < 3; ++c) {
      to[c] = (1 - cover) * behind.colour[c] / behind.share +
              (covered > 0 ? cover * before.colour[c] / before.share : 0.0f);
    }
  }

 private:
  static constexpr int tile = 16;
  static constexpr float least_radius = 0.5f;  // radius of a pixel in focus

  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(std::clamp(row, 0, height_ - 1)) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(std::clamp(column, 0, width_ - 1));
  }

  template <class Tap>
  void gather(int column, int row, float radius, const Tap& tap) const {
    constexpr int far = 1 << 15;  // keeps numbers positive, so that truncation rounds down
    for (const Offset& o : spiral_) {
      tap(at(column + static_cast<int>(radius * o.x + (far + 0.5f)) - far,
             row + static_cast<int>(radius * o.y + (far + 0.5f)) - far),
          radius * o.distance);
    }
  }

  /// True if a surface is so far in front of another surface that their discs differ.
  bool is_before(std::size_t i, std::size_t other) const { return off_focus_[i] > off_focus_[other] + 1; }

  /// Intensity of the disc of a pixel at a distance; the edge of the disc is one pixel wide.
  float disc(std::size_t i, float distance) const {
    const float radius = std::max(std::abs(off_focus_[i]), least_radius);
    return std::clamp(radius + 0.5f - distance, 0.0f, 1.0f) / (radius * radius);
  }

  /// For each tile, the radius of the largest disc of near surfaces that may reach the tile.
  void find_reach() {
    tiles_ = static_cast<std::size_t>((width_ + tile - 1) / tile);
    const int across = static_cast<int>(tiles_), down = (height_ + tile - 1) / tile;
    std::vector<float> largest(tiles_ * static_cast<std::size_t>(down));
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        float& of_tile = largest[static_cast<std::size_t>(y / tile) * tiles_ + static_cast<std::size_t>(x / tile)];
        of_tile = std::max(of_tile, off_focus_[at(x, y)]);
      }
    }
    reach_.assign(largest.size(), 0);
    for (int y = 0; y < down; ++y) {
      for (int x = 0; x < across; ++x) {
        const float radius = largest[static_cast<std::size_t>(y * across + x)];
        const int tiles = static_cast<int>(std::ceil(radius / tile));
        for (int v = std::max(0, y - tiles); v <= std::min(down - 1, y + tiles); ++v) {
          for (int u = std::max(0, x - tiles); u <= std::min(across - 1, x + tiles); ++u) {
            float& reach = reach_[static_cast<std::size_t>(v * across + u)];
            reach = std::max(reach, radius);
          }
        }
      }
    }
  }

  int width_, height_, left_, top_;
  std::vector<float> off_focus_;  ///< radius of the disc, px: above 0 in front of the focus, below 0 behind
  std::vector<float> pixels_;
  std::vector<Offset> spiral_;
  std::size_t tiles_ = 0;
  std::vector<float> reach_;
};

}  // namespace

petzval::RgbImage single_image_blur(const petzval::LayerSet& layers, const petzval::LayerCamera& camera,
                                    const CircleOfConfusion& circle, int taps, int threads) {
  const SingleImage image(layers, camera, circle, taps);
  petzval::RgbImage picture(camera.columns, camera.rows);
  petzval::parallel_for(static_cast<std::size_t>(camera.rows), 4, threads, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < camera.columns; ++x) image.blur(x, y, picture.pixel(x, y));
    }
  });
  return picture;
}
