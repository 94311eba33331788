// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval::analysis_detail {

/// A square grid of square pixels on the film: `pixels` a side, 1 to 32768, rows from the top (largest y first).
struct PixelGrid {
  Vec2<double> centre{0, 0};  ///< mm
  double pixel_mm = 1;
  int pixels = 1;
};

/// Adds 1 to the pixel of each point; points outside the grid are ignored.
/// @param x, y film positions, mm, N each
/// @param counts array of `pixels` x `pixels`, [row][column]; integers, so that sums are exact
/// @param units amounts to add instead of 1, one per point; may be empty
PETZVAL_API void count_points(const PixelGrid& grid, std::span<const double> x, std::span<const double> y,
                              std::span<std::uint64_t> counts, std::span<const std::uint32_t> units = {}) noexcept;

}  // namespace petzval::analysis_detail
