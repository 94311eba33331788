// SPDX-License-Identifier: Apache-2.0
// Blurred images have constant bits on the baseline instruction set (PETZVAL_INSTRUCTION_SET=baseline).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "blur/gather_method.hpp"
#include "core/instruction_set.hpp"
#include "hash.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {
namespace gather_bits_test {

/// Two striped boards in front of a wall, from integers only: equal on every machine.
LayerSet boards(const LensRays& rays) {
  const PeelPlan plan = plan_peel(rays, 1000, 8000);
  LayerSet layers;
  layers.peel(plan, 3, [&](int layer, std::span<const float>, const LayerPlanes& out) {
    std::size_t written = 0;
    const int columns = plan.camera.layer_columns(), rows = plan.camera.layer_rows();
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const auto pixel = static_cast<std::size_t>(row * columns + column);
        const bool near = column % 60 < 25 && row % 50 < 35, middle = (column + 2 * row) % 80 < 50;
        const float depths[] = {1000, 2500, 8000};
        int surface = -1;
        for (int skip = layer, k = 0; k < 3; ++k) {
          if ((k == 0 && !near) || (k == 1 && !middle)) continue;
          if (skip-- == 0) surface = k;
        }
        if (surface < 0) continue;
        const float stripe = (column / 4 + row / 4 + surface) % 2 ? 0.75f : 0.25f;
        out.inverse_depth[pixel] = 1 / depths[surface];
        out.red[pixel] = stripe, out.green[pixel] = 0.5f * stripe, out.blue[pixel] = 1 - stripe, out.alpha[pixel] = 1;
        ++written;
      }
    }
    return written;
  });
  return layers;
}

std::uint64_t hash(const BlurredImage& picture) {
  testing_bits::Hash h;
  for (const float value : picture.rgba) h.take(value);
  for (const float value : picture.missed) h.take(value);
  return h.value();
}

TEST(GatherBits, EqualTheTable) {
  if (instruction_sets().size() > 1) GTEST_SKIP() << "wider instruction sets give other bits";
  const LayerCamera camera = layer_camera(120, 90, radians(15));
  const LensRays same =
      LensRays::thin(camera, {.radius_mm = 20, .inverse_focus = 1 / 2000.0}, vogel_points(31), {.nearest_mm = 1000});
  const LensRays varied = LensRays::thin(camera,
                                         {.radius_mm = 20,
                                          .focus =
                                              [](const Vec2<double>& raster) {
                                                return FocusAt{(1 + 0.4 * raster.y / 90) / 2000.0, 1};
                                              }},
                                         vogel_points(31), {.nearest_mm = 1000});
  EXPECT_EQ(hash(gather(boards(same), same)), 0x410c03e041ae69f8u);
  EXPECT_EQ(hash(gather(boards(varied), varied, {.threads = 2})), 0xab76b76edb0671fdu);
  EXPECT_EQ(hash(blur_detail::gather(boards(varied), varied, {}, {.by_blocks = false})), 0xbcf69b2919a61816u);
}

}  // namespace gather_bits_test
}  // namespace petzval
