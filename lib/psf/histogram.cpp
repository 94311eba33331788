// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/histogram.hpp"

#include <algorithm>
#include <cstddef>

namespace petzval::inline v0 {

void count_points(const PixelGrid& grid, std::span<const double> x, std::span<const double> y,
                  std::span<std::uint64_t> counts) noexcept {
  // Numbers of pixels for a block of points on lanes, then additions one by one: bins in lanes or images for each lane
  // would only cost more. A 0 stands in for what no integer can hold.
  constexpr std::size_t block = 256;
  std::array<std::int32_t, block> pixel;
  const auto [cx, cy] = grid.centre;
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
    // Those beside the grid fall out without a branch, of which a cropped picture would guess many wrong.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      pixel[kept] = pixel[i];
      kept += pixel[i] >= 0;
    }
    for (std::size_t i = 0; i < kept; ++i) ++counts[static_cast<std::size_t>(pixel[i])];
  }
}

}  // namespace petzval::inline v0
