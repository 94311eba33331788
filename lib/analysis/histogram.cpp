// SPDX-License-Identifier: Apache-2.0
#include "analysis/histogram.hpp"

#include <algorithm>
#include <cstddef>

namespace petzval::analysis_detail {

void count_points(const PixelGrid& grid, std::span<const double> x, std::span<const double> y,
                  std::span<std::uint64_t> counts, std::span<const std::uint32_t> units) noexcept {
  // The pixel numbers of a block of points are computed in SIMD lanes, and the points are then counted one by one: a
  // separate image for each lane would take longer. For points outside the grid 0 is converted, because their pixel
  // numbers may not fit into an integer.
  constexpr std::size_t block = 256;
  std::array<std::int32_t, block> pixel;
  const double cx = grid.centre.x, cy = grid.centre.y;
  const double scale = 1 / grid.pixel_mm, side = grid.pixels, half = side / 2;
  for (std::size_t begin = 0; begin < x.size(); begin += block) {
    const std::size_t count = std::min(block, x.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const double column = (x[begin + i] - cx) * scale + half, row = (cy - y[begin + i]) * scale + half;
      const bool inside = (column >= 0) & (column < side) & (row >= 0) & (row < side);
      const auto at =
          static_cast<std::int32_t>(inside ? row : 0) * grid.pixels + static_cast<std::int32_t>(inside ? column : 0);
      pixel[i] = inside ? at : -1;
    }
    if (!units.empty()) {
      for (std::size_t i = 0; i < count; ++i) {
        if (pixel[i] >= 0) counts[static_cast<std::size_t>(pixel[i])] += units[begin + i];
      }
      continue;
    }
    // Drops points outside the grid without a branch, because the branch would be mispredicted for a cropped picture.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      pixel[kept] = pixel[i];
      kept += pixel[i] >= 0;
    }
    for (std::size_t i = 0; i < kept; ++i) ++counts[static_cast<std::size_t>(pixel[i])];
  }
}

}  // namespace petzval::analysis_detail
