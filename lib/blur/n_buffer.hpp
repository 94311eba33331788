// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval::blur_detail {

/// A rectangle of pixels; right and bottom are included.
struct PixelRect {
  int left = 0, top = 0, right = 0, bottom = 0;
};

/// The range of inverse depths of all surfaces, and the number of layers with surfaces. Empty if least > most.
struct DepthRange {
  float least = 1, most = 0;
  int layers = 0;

  bool empty() const noexcept { return least > most; }
};

/// Ranges of inverse depth below any rectangle of pixels: N-buffers (Decoret 2005) over blocks of 8 x 8 pixels. Each
/// level holds, for every block position, the range of a square with twice the side of the previous level.
class NBuffer {
 public:
  static constexpr int block = 8;

  /// Allocates memory only if the picture or the number of layers grows.
  /// @param planes inverse depth of each layer, columns x rows, negative if empty
  void fill(int columns, int rows, std::span<const std::span<const float>> planes);
  /// The range below a rectangle, clipped to the picture and widened to full blocks. A rectangle outside the picture
  /// has the range at the nearest edge.
  DepthRange below(const PixelRect& rect) const noexcept;
  /// Count of stored numbers.
  std::size_t size() const noexcept {
    std::size_t numbers = row_least_.size() + row_most_.size() + row_layers_.size();
    for (const Level& l : levels_) numbers += l.least.size() + l.most.size() + l.layers.size();
    return numbers;
  }

 private:
  struct Level {
    std::vector<float> least, most, layers;
  };
  int columns_ = 0, rows_ = 0;  ///< pixels
  int block_columns_ = 0, block_rows_ = 0;
  std::size_t count_ = 0;  ///< levels in use
  std::vector<Level> levels_;
  std::vector<float> row_least_, row_most_, row_layers_;
};

}  // namespace petzval::blur_detail
