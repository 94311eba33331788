// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval::blur_detail {

/// Columns and rows from first to last, both included.
struct PixelRect {
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// Inverse depths between which all surfaces lie, and the number of layers that have them; least > most: none.
struct DepthRange {
  float least = 1, most = 0;
  int layers = 0;

  bool empty() const noexcept { return least > most; }
};

/// Ranges of inverse depth below any rectangle of pixels: N-buffers (Decoret 2005) over blocks of 8 x 8 pixels. A level
/// holds the ranges of squares twice as large as those of the level before it, one for each place of a block.
class NBuffer {
 public:
  static constexpr int block = 8;

  /// planes: inverse depth of each layer, columns x rows, below 0 where empty. Allocates where it grows.
  void fill(int columns, int rows, std::span<const std::span<const float>> planes);
  /// Of a rectangle, clipped to the picture, widened to whole blocks; one beside the picture has that of its nearest
  /// edge.
  DepthRange below(const PixelRect& rect) const noexcept;

 private:
  struct Level {
    std::vector<float> least, most, layers;
  };
  int columns_ = 0, rows_ = 0;  ///< of pixels
  int block_columns_ = 0, block_rows_ = 0;
  std::size_t count_ = 0;  ///< of levels in use
  std::vector<Level> levels_;
  std::vector<float> row_least_, row_most_, row_layers_;
};

}  // namespace petzval::blur_detail
