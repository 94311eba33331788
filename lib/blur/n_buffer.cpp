// SPDX-License-Identifier: Apache-2.0
#include "n_buffer.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace petzval::blur_detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

int last_power(int n) { return static_cast<int>(std::bit_width(static_cast<unsigned>(n))) - 1; }

/// Combines each position with the positions `step` columns and rows further on.
template <class Better>
void join(const std::vector<float>& from, std::vector<float>& to, int columns, int rows, int step, Better better) {
  to.resize(from.size());
  for (int row = 0; row < rows; ++row) {
    const auto line = [&](int r) {
      return from.data() + static_cast<std::size_t>(std::min(r, rows - 1)) * static_cast<std::size_t>(columns);
    };
    const float *const upper = line(row), *const lower = line(row + step);
    float* const out = to.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns);
    for (int column = 0; column < columns; ++column) {
      const int next = std::min(column + step, columns - 1);
      out[column] = better(better(upper[column], upper[next]), better(lower[column], lower[next]));
    }
  }
}

float smaller(float a, float b) noexcept { return a < b ? a : b; }
float larger(float a, float b) noexcept { return a > b ? a : b; }

}  // namespace

void NBuffer::fill(int columns, int rows, std::span<const std::span<const float>> planes) {
  columns_ = columns, rows_ = rows;
  block_columns_ = (columns + block - 1) / block, block_rows_ = (rows + block - 1) / block;
  count_ = static_cast<std::size_t>(last_power(std::min(block_columns_, block_rows_))) + 1;
  if (levels_.size() < count_) levels_.resize(count_);

  const auto width = static_cast<std::size_t>(columns), blocks = static_cast<std::size_t>(block_columns_);
  row_least_.resize(width), row_most_.resize(width), row_layers_.resize(width);
  Level& base = levels_[0];
  for (std::vector<float>* v : {&base.least, &base.most, &base.layers})
    v->resize(blocks * static_cast<std::size_t>(block_rows_));
  for (int block_row = 0; block_row < block_rows_; ++block_row) {
    std::fill(row_least_.begin(), row_least_.end(), infinity);
    std::fill(row_most_.begin(), row_most_.end(), -1.0f);
    std::fill(row_layers_.begin(), row_layers_.end(), 0.0f);
    const int end = std::min(rows, (block_row + 1) * block);
    for (std::size_t layer = 0; layer < planes.size(); ++layer) {
      const float number = static_cast<float>(layer + 1);
      for (int row = block_row * block; row < end; ++row) {
        const float* const w = planes[layer].data() + static_cast<std::size_t>(row) * width;
        for (std::size_t i = 0; i < width; ++i) {
          row_most_[i] = larger(row_most_[i], w[i]);
          row_least_[i] = smaller(row_least_[i], w[i] < 0 ? infinity : w[i]);
          row_layers_[i] = larger(row_layers_[i], w[i] < 0 ? 0.0f : number);
        }
      }
    }
    for (std::size_t b = 0; b < blocks; ++b) {
      float least = infinity, most = -1, layers = 0;
      for (std::size_t i = b * block; i < std::min(width, (b + 1) * block); ++i) {
        least = smaller(least, row_least_[i]), most = larger(most, row_most_[i]),
        layers = larger(layers, row_layers_[i]);
      }
      const std::size_t at = static_cast<std::size_t>(block_row) * blocks + b;
      base.least[at] = least, base.most[at] = most, base.layers[at] = layers;
    }
  }
  for (std::size_t l = 1; l < count_; ++l) {
    const int step = 1 << (l - 1);
    join(levels_[l - 1].least, levels_[l].least, block_columns_, block_rows_, step, smaller);
    join(levels_[l - 1].most, levels_[l].most, block_columns_, block_rows_, step, larger);
    join(levels_[l - 1].layers, levels_[l].layers, block_columns_, block_rows_, step, larger);
  }
}

DepthRange NBuffer::below(const PixelRect& rect) const noexcept {
  const int left = std::clamp(rect.left, 0, columns_ - 1) / block,
            right = std::clamp(rect.right, 0, columns_ - 1) / block, top = std::clamp(rect.top, 0, rows_ - 1) / block,
            bottom = std::clamp(rect.bottom, 0, rows_ - 1) / block;
  // Squares as wide as the shorter side cover exactly the rectangle; the last square overlaps the square before it.
  const int level = last_power(std::min(right - left, bottom - top) + 1), size = 1 << level;
  const Level& l = levels_[static_cast<std::size_t>(level)];
  float least = infinity, most = -1, layers = 0;
  for (int row = top;; row = std::min(row + size, bottom + 1 - size)) {
    for (int column = left;; column = std::min(column + size, right + 1 - size)) {
      const auto at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(block_columns_) + static_cast<std::size_t>(column);
      least = smaller(least, l.least[at]), most = larger(most, l.most[at]), layers = larger(layers, l.layers[at]);
      if (column + size > right) break;
    }
    if (row + size > bottom) break;
  }
  return {least, most, static_cast<int>(layers)};
}

}  // namespace petzval::blur_detail
