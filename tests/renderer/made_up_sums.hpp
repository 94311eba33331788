// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "renderer/picture_sums.hpp"

namespace renderer {

/// Random contributions of a work unit: most in its own pixels, some anywhere, of both signs and any magnitude.
inline std::vector<Contribution> made_up_unit(const PictureSums& sums, std::size_t tile, std::uint32_t pass) {
  std::mt19937 random(static_cast<std::uint32_t>(1000 * tile) + pass);
  std::uniform_real_distribution<float> power(-18, 11), sign(-0.1f, 1);
  const PixelBlock block = sums.block(tile);
  const auto below = [&](int count) { return static_cast<int>(random() % static_cast<std::uint32_t>(count)); };
  std::vector<Contribution> unit;
  for (int i = 0; i < 300; ++i) {
    const bool own = i % 3 > 0;
    const int x = own ? block.x + below(block.width) : below(sums.width());
    const int y = own ? block.y + below(block.height) : below(sums.height());
    unit.push_back({static_cast<std::uint32_t>(y * sums.width() + x), {}});
    for (float& c : unit.back().rgb) c = std::copysign(std::pow(10.0f, power(random)), sign(random));
  }
  return unit;
}

/// Passes over these tiles with this number of samples.
inline PictureSums made_up_sums(int width, int height, std::span<const std::size_t> tiles, std::uint32_t passes,
                                std::uint32_t samples = 3) {
  PictureSums sums(width, height);
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    for (const std::size_t tile : tiles) {
      sums.add(tile, pass % PictureSums::rounds, samples, made_up_unit(sums, tile, pass));
    }
  }
  return sums;
}

/// Tiles whose index modulo the number of shards equals the index of the shard.
inline PictureSums made_up_part(int width, int height, std::size_t index, std::size_t count, std::uint32_t passes) {
  std::vector<std::size_t> tiles;
  for (std::size_t t = index - 1; t < PictureSums(width, height).tiles(); t += count) tiles.push_back(t);
  return made_up_sums(width, height, tiles, passes);
}

}  // namespace renderer
