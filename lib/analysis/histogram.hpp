// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval::analysis_detail {

/// A square of square pixels on the film: `pixels` a side, 1 to 32768, rows from the top (largest y first).
struct PixelGrid {
  Vec2<double> centre{0, 0};  ///< mm
  double pixel_mm = 1;
  int pixels = 1;
};

/// Adds 1 to the pixel of each point; points outside the grid are not counted. x, y: N each, film, mm. counts: pixels
/// squared, [row][column]; integers, which count exactly however full a pixel is. units: what to add in place of 1 for
/// each point, or none.
PETZVAL_API void count_points(const PixelGrid& grid, std::span<const double> x, std::span<const double> y,
                              std::span<std::uint64_t> counts, std::span<const std::uint32_t> units = {}) noexcept;

}  // namespace petzval::analysis_detail
