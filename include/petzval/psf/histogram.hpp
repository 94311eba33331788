// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// Square pixels on the film in a square: `pixels` a side, 1 to 32768, rows from the top (largest y first).
struct PixelGrid {
  std::array<double, 2> centre{0, 0};  ///< mm
  double pixel_mm = 1;
  int pixels = 1;
};

/// Adds 1 to the pixel of each point. Points beside the grid count nowhere. x, y: N each, film, mm. counts: pixels
/// squared, [row][column]; integers, so that none is lost in however full a pixel.
PETZVAL_API void count_points(const PixelGrid& grid, std::span<const double> x, std::span<const double> y,
                              std::span<std::uint64_t> counts) noexcept;

}  // namespace petzval::inline v0
