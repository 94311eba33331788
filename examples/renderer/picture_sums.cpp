// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "petzval/core/error.hpp"

namespace renderer {
namespace {

/// The standard error from the contributions of the rounds.
double error_of(const std::array<double, PictureSums::rounds>& deviations, std::size_t used) {
  double squares = 0;
  for (const double own : deviations) squares += own * own;
  const auto count = static_cast<double>(used);
  return used < 2 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(squares * count / (count - 1));
}

constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};

}  // namespace

PictureSums::PictureSums(int width, int height)
    : width_(width),
      height_(height),
      tile_columns_(static_cast<std::size_t>((width + tile_pixels - 1) / tile_pixels)),
      tile_rows_(static_cast<std::size_t>((height + tile_pixels - 1) / tile_pixels)),
      tiles_(tile_columns_ * tile_rows_) {
  for (auto& own : pixels_) own.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

PixelBlock PictureSums::block(std::size_t tile) const noexcept {
  const int x = static_cast<int>(tile % tile_columns_) * tile_pixels;
  const int y = static_cast<int>(tile / tile_columns_) * tile_pixels;
  return {x, y, std::min(tile_pixels, width_ - x), std::min(tile_pixels, height_ - y)};
}

double PictureSums::area(std::size_t tile) const noexcept {
  const PixelBlock b = block(tile);
  return static_cast<double>(b.width) * b.height;
}

std::uint64_t PictureSums::samples(std::size_t tile, Of of) const noexcept {
  const auto& own = part(tile, of).samples;
  return std::accumulate(own.begin(), own.end(), std::uint64_t{0});
}

std::array<double, PictureSums::rounds> PictureSums::light_paths_by_round() const noexcept {
  std::array<double, rounds> paths{};
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    for (std::size_t r = 0; r < rounds; ++r) paths[r] += samples(t, r, Of::light) * area(t);
  }
  for (double& own : paths) own /= static_cast<double>(width_) * height_;
  return paths;
}

double PictureSums::light_paths() const noexcept {
  const auto by_round = light_paths_by_round();
  return std::accumulate(by_round.begin(), by_round.end(), 0.0);
}

void PictureSums::add(std::size_t tile, std::size_t round, std::uint32_t samples,
                      std::span<const Contribution> contributions, Of of) {
  part(tile, of).samples[round] += samples;
  const auto width = static_cast<std::size_t>(width_);
  for (const auto& [pixel, rgb] : contributions) {
    if (!std::all_of(rgb.begin(), rgb.end(), [](float x) { return std::abs(x) < 0x1p40f; })) {
      ++rejected_;
      continue;
    }
    const std::size_t column = pixel % width / tile_pixels, row = pixel / width / tile_pixels;
    Rgb3& total = part(row * tile_columns_ + column, of).sums[round];
    for (std::size_t c = 0; c < 3; ++c) {
      const FixedSum value(static_cast<double>(rgb[c]));
      pixels_[static_cast<std::size_t>(of)][pixel][c] += value;
      total[c] += value;
    }
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
  for (std::size_t own = 0; own < pixels_.size(); ++own) {
    for (std::size_t p = 0; p < pixels_[own].size(); ++p) {
      for (std::size_t c = 0; c < 3; ++c) pixels_[own][p][c] += part.pixels_[own][p][c];
    }
  }
  for (const auto& [name, values] : part.guides_) {
    std::vector<float>& own = guides_.try_emplace(name, values.size()).first->second;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      if (part.samples(t) > 0) copy(part.block(t), values, own);
    }
  }
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    for (const Of of : both) {
      Part& own = this->part(t, of);
      const Part& more = part.part(t, of);
      own.target = std::max(own.target, more.target);
      for (std::size_t r = 0; r < rounds; ++r) {
        own.samples[r] += more.samples[r];
        for (std::size_t c = 0; c < 3; ++c) own.sums[r][c] += more.sums[r][c];
      }
    }
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
  const double paths = light_paths();
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const auto own = static_cast<double>(samples(t));
    const PixelBlock b = block(t);
    for (int y = b.y; own > 0 && y < b.y + b.height; ++y) {
      for (int x = b.x; x < b.x + b.width; ++x) {
        const std::size_t p =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
        for (std::size_t c = 0; c < 3; ++c) {
          const double light = paths > 0 ? pixels_[1][p][c].value() / paths : 0;
          image.pixel(x, y)[c] = static_cast<float>(pixels_[0][p][c].value() / own + light);
        }
      }
    }
  }
  return image;
}

PictureSums::Deviations PictureSums::deviations(std::size_t tile, const std::array<double, 3>& weights,
                                                const std::array<double, rounds>& light_paths) const {
  Deviations result;
  for (const Of of : both) {
    const Part& own = part(tile, of);
    std::array<double, rounds> values{}, samples{};
    for (std::size_t r = 0; r < rounds; ++r) {
      samples[r] = (of == Of::film ? static_cast<double>(own.samples[r]) : light_paths[r]) * area(tile);
      for (std::size_t c = 0; c < 3; ++c) values[r] += weights[c] * own.sums[r][c].value();
      result.empty = result.empty && own.sums[r] == Rgb3{};
    }
    const double all = std::accumulate(samples.begin(), samples.end(), 0.0);
    if (!(all > 0)) continue;
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / all;
    result.mean += mean;
    auto& deviations = of == Of::film ? result.film : result.light;
    for (std::size_t r = 0; r < rounds; ++r) deviations[r] = (values[r] - mean * samples[r]) / all;
  }
  return result;
}

std::array<Estimate, 3> PictureSums::mean() const {
  std::array<Estimate, 3> result;
  const auto paths = light_paths_by_round();
  double all = 0;
  std::array<bool, rounds> used{};
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    if (samples(t) == 0) continue;
    all += area(t);
    for (std::size_t r = 0; r < rounds; ++r) used[r] = used[r] || samples(t, r) > 0;
  }
  const auto used_count = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<double, rounds> sum{};
    std::array<double, 3> weights{};
    weights[c] = 1;
    bool empty = true;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      if (samples(t) == 0) continue;
      const Deviations own = deviations(t, weights, paths);
      empty = empty && own.empty;
      result[c].mean += own.mean * area(t) / all;
      for (std::size_t r = 0; r < rounds; ++r) sum[r] += (own.film[r] + own.light[r]) * area(t) / all;
    }
    // Without contributions the error is unknown.
    result[c].standard_error = empty ? std::numeric_limits<double>::quiet_NaN() : error_of(sum, used_count);
  }
  return result;
}

Estimate PictureSums::luminance(std::size_t tile) const {
  const Deviations own = deviations(tile, luminance_weights, light_paths_by_round());
  std::array<double, rounds> sum{};
  std::size_t used = 0;
  for (std::size_t r = 0; r < rounds; ++r) {
    sum[r] = own.film[r] + own.light[r];
    used += samples(tile, r) > 0;
  }
  return {own.mean, own.empty ? std::numeric_limits<double>::quiet_NaN() : error_of(sum, used)};
}

std::vector<PictureSums::Noise> PictureSums::noise() const {
  const auto paths = light_paths_by_round();
  std::vector<Noise> result;
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const Deviations own = deviations(t, luminance_weights, paths);
    std::size_t used = 0;
    for (std::size_t r = 0; r < rounds; ++r) used += samples(t, r) > 0;
    const double film = error_of(own.film, used), light = error_of(own.light, used);
    result.push_back({film * film * area(t), light * light * area(t), own.mean});
  }
  return result;
}

double PictureSums::Noise::relative(double floor) const noexcept {
  return std::sqrt(film + light) / std::max(mean, floor);
}

}  // namespace renderer
