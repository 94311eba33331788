// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "petzval/core/error.hpp"
#include "renderer/luminance.hpp"

namespace renderer {
namespace {

/// The mean, and its standard error from the scatter of the residuals of the rounds.
Estimate estimate(const std::array<FixedSum, PictureSums::rounds>& sums,
                  const std::array<double, PictureSums::rounds>& samples) {
  FixedSum sum;
  double all = 0, used = 0;
  for (std::size_t r = 0; r < sums.size(); ++r) {
    sum += sums[r];
    all += samples[r];
    used += samples[r] > 0;
  }
  if (!(all > 0)) return {0, std::numeric_limits<double>::quiet_NaN()};
  const double mean = sum.value() / all;
  // Without contributions the error is unknown.
  if (used < 2 || sum == FixedSum()) return {mean, std::numeric_limits<double>::quiet_NaN()};
  double squares = 0;
  for (std::size_t r = 0; r < sums.size(); ++r) {
    if (!(samples[r] > 0)) continue;
    const double residual = sums[r].value() - mean * samples[r];
    squares += residual * residual;
  }
  return {mean, std::sqrt(squares * used / (used - 1)) / all};
}

}  // namespace

PictureSums::PictureSums(int width, int height)
    : width_(width),
      height_(height),
      tile_columns_(static_cast<std::size_t>((width + tile_pixels - 1) / tile_pixels)),
      tile_rows_(static_cast<std::size_t>((height + tile_pixels - 1) / tile_pixels)),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      tiles_(tile_columns_ * tile_rows_) {}

PixelBlock PictureSums::block(std::size_t tile) const noexcept {
  const int x = static_cast<int>(tile % tile_columns_) * tile_pixels;
  const int y = static_cast<int>(tile / tile_columns_) * tile_pixels;
  return {x, y, std::min(tile_pixels, width_ - x), std::min(tile_pixels, height_ - y)};
}

std::uint64_t PictureSums::samples(std::size_t tile) const noexcept {
  const auto& own = tiles_[tile].samples;
  return std::accumulate(own.begin(), own.end(), std::uint64_t{0});
}

void PictureSums::add(std::size_t tile, std::size_t round, std::uint32_t samples,
                      std::span<const Contribution> contributions) {
  tiles_[tile].samples[round] += samples;
  const auto width = static_cast<std::size_t>(width_);
  for (const auto& [pixel, rgb] : contributions) {
    if (!std::all_of(rgb.begin(), rgb.end(), [](float x) { return std::abs(x) < 0x1p40f; })) {
      ++rejected_;
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const FixedSum value(static_cast<double>(rgb[c]));
      pixels_[pixel][c] += value;
      totals_[round][c] += value;
    }
    const std::size_t column = pixel % width / tile_pixels, row = pixel / width / tile_pixels;
    tiles_[row * tile_columns_ + column].luminance[round] +=
        FixedSum(static_cast<double>(renderer::luminance({rgb[0], rgb[1], rgb[2]})));
  }
}

void PictureSums::add(const PictureSums& part) {
  if (part.width_ != width_ || part.height_ != height_) {
    throw petzval::Error("part: size = " + std::to_string(part.width_) + " x " + std::to_string(part.height_) +
                         " pixels; must be " + std::to_string(width_) + " x " + std::to_string(height_));
  }
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    if (samples(t) > 0 && part.samples(t) > 0) {
      throw petzval::Error("tile " + std::to_string(t) + " is in both pictures; must be in only one of them");
    }
  }
  for (std::size_t p = 0; p < pixels_.size(); ++p) {
    for (std::size_t c = 0; c < 3; ++c) pixels_[p][c] += part.pixels_[p][c];
  }
  for (const auto& [name, values] : part.guides_) {
    std::vector<float>& own = guides_.try_emplace(name, values.size()).first->second;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      if (part.samples(t) > 0) copy(part.block(t), values, own);
    }
  }
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    for (std::size_t r = 0; r < rounds; ++r) {
      tiles_[t].samples[r] += part.tiles_[t].samples[r];
      tiles_[t].luminance[r] += part.tiles_[t].luminance[r];
    }
  }
  for (std::size_t r = 0; r < rounds; ++r) {
    for (std::size_t c = 0; c < 3; ++c) totals_[r][c] += part.totals_[r][c];
  }
  rejected_ += part.rejected_;
}

void PictureSums::copy(const PixelBlock& block, const std::vector<float>& from, std::vector<float>& to) const {
  for (int y = block.y; y < block.y + block.height; ++y) {
    const auto first = static_cast<std::ptrdiff_t>(y) * width_ + block.x;
    std::copy_n(from.begin() + first, block.width, to.begin() + first);
  }
}

petzval::RgbImage PictureSums::picture() const {
  petzval::RgbImage image(width_, height_);
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const auto own = static_cast<double>(samples(t));
    if (own == 0) continue;
    const PixelBlock b = block(t);
    for (int y = b.y; y < b.y + b.height; ++y) {
      for (int x = b.x; x < b.x + b.width; ++x) {
        const Rgb3& sum =
            pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
        for (std::size_t c = 0; c < 3; ++c) image.pixel(x, y)[c] = static_cast<float>(sum[c].value() / own);
      }
    }
  }
  return image;
}

std::array<Estimate, 3> PictureSums::mean() const {
  std::array<double, rounds> samples{};
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const PixelBlock b = block(t);
    for (std::size_t r = 0; r < rounds; ++r) {
      samples[r] += static_cast<double>(tiles_[t].samples[r]) * b.width * b.height;
    }
  }
  std::array<Estimate, 3> result;
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<FixedSum, rounds> sums;
    for (std::size_t r = 0; r < rounds; ++r) sums[r] = totals_[r][c];
    result[c] = estimate(sums, samples);
  }
  return result;
}

Estimate PictureSums::luminance(std::size_t tile) const {
  const PixelBlock b = block(tile);
  std::array<double, rounds> samples{};
  for (std::size_t r = 0; r < rounds; ++r) {
    samples[r] = static_cast<double>(tiles_[tile].samples[r]) * b.width * b.height;
  }
  return estimate(tiles_[tile].luminance, samples);
}

}  // namespace renderer
