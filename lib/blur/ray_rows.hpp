// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/version.hpp"

namespace petzval::blur_detail {

/// Lines of the rays of a place, in rows of as many numbers: where a line runs to at infinity less the place itself
/// (along columns and rows), its slope (the same), and its weight.
enum Row : std::size_t { at_x, at_y, slope_x, slope_y, weight, row_count };

/// Which of side x side sets of rays a pixel takes: they take turns in squares.
constexpr std::size_t set_of(int column, int row, int side) noexcept {
  return static_cast<std::size_t>(row % side * side + column % side);
}

}  // namespace petzval::blur_detail
