// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/config.hpp"

namespace petzval::blur_detail {

/// Lines of the rays of a position, in rows of equal length: raster position of the line at infinity relative to the
/// position (along columns and rows), slope (along columns and rows), and weight.
enum Row : std::size_t { at_x, at_y, slope_x, slope_y, weight, row_count };

/// The ray set of a pixel: the side x side sets alternate over blocks of side x side pixels.
constexpr std::size_t set_of(int column, int row, int side) noexcept {
  return static_cast<std::size_t>(row % side * side + column % side);
}

}  // namespace petzval::blur_detail
