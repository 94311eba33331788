// SPDX-License-Identifier: Apache-2.0
#include "blur/n_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

namespace n_buffer_test {

using petzval::blur_detail::DepthRange;
using petzval::blur_detail::NBuffer;
using petzval::blur_detail::PixelRect;

struct Planes {
  int columns, rows;
  std::vector<std::vector<float>> layers;

  std::vector<std::span<const float>> spans() const { return {layers.begin(), layers.end()}; }
};

/// Random depths. The first layer has a surface in a fraction `full` of the pixels, the second in half of these pixels.
Planes random_planes(int columns, int rows, int count, double full, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> number(0, 1);
  Planes planes{columns, rows, {}};
  for (int layer = 0; layer < count; ++layer) {
    auto& plane = planes.layers.emplace_back();
    for (int i = 0; i < columns * rows; ++i) plane.push_back(number(engine) < full ? number(engine) : -1.0f);
    full /= 2;
  }
  return planes;
}

DepthRange by_hand(const Planes& planes, const PixelRect& rect) {
  constexpr int block = NBuffer::block;
  const auto widened = [](int pixel, int length, bool up) {
    const int first = std::clamp(pixel, 0, length - 1) / block * block;
    return up ? std::min(first + block, length) : first;
  };
  DepthRange range{1e30f, -1, 0};
  for (std::size_t layer = 0; layer < planes.layers.size(); ++layer) {
    for (int row = widened(rect.top, planes.rows, false); row < widened(rect.bottom, planes.rows, true); ++row) {
      for (int column = widened(rect.left, planes.columns, false); column < widened(rect.right, planes.columns, true);
           ++column) {
        const float w = planes.layers[layer][static_cast<std::size_t>(row * planes.columns + column)];
        if (w < 0) continue;
        range.least = std::min(range.least, w), range.most = std::max(range.most, w);
        range.layers = static_cast<int>(layer) + 1;
      }
    }
  }
  return range;
}

class NBuffers : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(NBuffers, EqualTheRangesOfRectangles) {
  const auto [columns, rows] = GetParam();
  NBuffer buffer;
  std::mt19937 engine(3);
  for (const double full : {1.0, 0.4, 0.01, 0.0}) {
    const Planes planes = random_planes(columns, rows, 3, full, 7);
    buffer.fill(columns, rows, planes.spans());
    std::uniform_int_distribution<int> across(-20, columns + 20), down(-20, rows + 20);
    for (int i = 0; i < 2000; ++i) {
      const int a = across(engine), b = across(engine), c = down(engine), d = down(engine);
      const PixelRect rect{std::min(a, b), std::min(c, d), std::max(a, b), std::max(c, d)};
      const DepthRange found = buffer.below(rect), wanted = by_hand(planes, rect);
      ASSERT_EQ(found.empty(), wanted.empty());
      ASSERT_EQ(found.layers, wanted.layers);
      if (wanted.empty()) continue;
      ASSERT_EQ(found.least, wanted.least);
      ASSERT_EQ(found.most, wanted.most);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Sizes, NBuffers,
                         ::testing::Values(std::pair{1, 1}, std::pair{7, 300}, std::pair{129, 64}, std::pair{250, 77}));

}  // namespace n_buffer_test
