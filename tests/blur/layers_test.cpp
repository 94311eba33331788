// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/layers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"

namespace layers_test {

using petzval::testing::expect_error;
using petzval::testing::expect_tokens;

using namespace petzval;

constexpr float infinity = std::numeric_limits<float>::infinity(), none = std::numeric_limits<float>::quiet_NaN();

/// The camera of Lee, Eisemann, Seidel 2010: 30 degrees, 800 x 600, a lens of 18 mm.
LensRays rays_of_paper(double nearest = 1000) {
  return LensRays::thin(layer_camera(800, 600, radians(30)), {.radius_mm = 9, .inverse_focus = 1 / 5000.0},
                        vogel_points(100), {.nearest_mm = nearest});
}

FragmentLists random_lists(int columns, int rows, int most, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> number(0, 1);
  FragmentLists lists{.columns = columns, .rows = rows, .offsets = {0}, .fragments = {}};
  for (int i = 0; i < columns * rows; ++i) {
    const int count = static_cast<int>(number(engine) * static_cast<float>(most + 1));
    for (int k = 0; k < count; ++k) {
      const float w = k == 0 && number(engine) < 0.5f ? 0.0f : 1e-3f * number(engine);  // at most one sky
      lists.fragments.push_back({1 / w, number(engine), number(engine), number(engine), 1});
    }
    lists.offsets.push_back(lists.fragments.size());
  }
  return lists;
}

/// A renderer of given lists of surfaces.
LayerSet::Peel renderer_of(const FragmentLists& lists) {
  return [&lists](int, std::span<const float> below, const LayerPlanes& out) {
    std::size_t written = 0;
    for (std::size_t pixel = 0; pixel < below.size(); ++pixel) {
      float nearest = -1;
      for (std::size_t i = lists.offsets[pixel]; i < lists.offsets[pixel + 1]; ++i) {
        const auto& f = lists.fragments[i];
        const float w = 1 / f.depth_mm;
        if (w < below[pixel] && w > nearest) {
          nearest = w;
          out.inverse_depth[pixel] = w, out.red[pixel] = f.red, out.green[pixel] = f.green, out.blue[pixel] = f.blue;
        }
      }
      written += nearest >= 0;
    }
    return written;
  };
}

TEST(PeelPlans, BiasEqualsTheUmbra) {
  // x = d s / (E - s), s = 2 pixels at the depth of the sample, in mm; computed with 40 digits.
  const PeelPlan plan = plan_peel(rays_of_paper(), 1000, infinity);
  EXPECT_GE(plan.bias * 1000, 0.099240441641156558);  // the 100 points stay inside the rim
  EXPECT_LE(plan.bias * 1000, 1.06 * 0.099240441641156558);
  const LensRays rim =
      LensRays::thin(layer_camera(800, 600, radians(30)), {.radius_mm = 9}, std::vector<PupilPoint>{{0.25, 1}});
  const double bias = plan_peel(rim, 1000, infinity).bias;
  EXPECT_NEAR(bias * 1000, 0.099240441641156558, 1e-8);
  const double behind[][2] = {{1000, 110.17417547249749}, {2000, 495.26175768611782}, {5000, 4924.6167439382412}};
  for (const auto& [d, x] : behind) EXPECT_NEAR(1 / (1 / d - bias) - d, x, 1e-5 * x);
  EXPECT_EQ(plan_peel(rim, 1000, infinity).most_layers, 11);  // 10.08 offsets from 1 m to infinity
  EXPECT_GE(plan.camera.overscan, 8);
  EXPECT_LE(plan.camera.overscan, 14);
}

TEST(PeelPlans, PinholeNeedsOneLayer) {
  const LensRays pinhole = LensRays::thin(layer_camera(80, 60, radians(30)), {.radius_mm = 0}, vogel_points(4));
  EXPECT_EQ(plan_peel(pinhole, 1000, infinity).most_layers, 1);
}

TEST(PeelPlans, RefuseInvalidDepths) {
  const LensRays rays = rays_of_paper();
  expect_error([&] { plan_peel(rays, 0, 100); }, {0, 100});
  expect_error([&] { plan_peel(rays, 100, 100); }, {100});
  expect_error([&] { plan_peel(rays, 0.001, 100); }, {"px"});
}

TEST(Peeling, EqualsThinningOfFullLists) {
  PeelPlan plan = plan_peel(rays_of_paper(), 1000, infinity);
  plan.camera.columns = 37, plan.camera.rows = 23, plan.camera.overscan = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const FragmentLists lists = random_lists(37, 23, 40, seed);
    LayerSet peeled, thinned;
    peeled.peel(plan, 16, renderer_of(lists));
    thinned.peel_fragments(lists, plan.bias, 16);
    ASSERT_EQ(peeled.count(), thinned.count());
    EXPECT_LE(peeled.count(), plan.most_layers);
    EXPECT_GT(peeled.count(), 6);
    for (int layer = 0; layer < peeled.count(); ++layer) {
      EXPECT_TRUE(std::ranges::equal(peeled.inverse_depth(layer), thinned.inverse_depth(layer)));
      for (std::size_t i = 0; i < peeled.inverse_depth(layer).size(); ++i) {
        EXPECT_EQ(peeled.rgba(layer, i), thinned.rgba(layer, i));
      }
    }
  }
}

TEST(Peeling, RefusesSurfacesThatAreNotFarther) {
  PeelPlan plan{.camera = {.columns = 2, .rows = 1, .focal_px = 1}, .bias = 0.1};
  LayerSet layers;
  const auto same_again = [](int, std::span<const float>, const LayerPlanes& out) {
    out.inverse_depth[1] = 0.5f;
    return std::size_t{1};
  };
  expect_error([&] { layers.peel(plan, 2, same_again); }, {"layer 1", "column 1", "row 0", "inverse", 0.5});
  expect_error([&] { layers.peel(plan, 0, same_again); }, {"layers", 0});
  expect_error([&] { layers.peel(plan, 65, same_again); }, {"layers", 65});
  expect_error([&] { layers.peel(plan, 2, {}); }, {"layers", "peel"});
}

TEST(Lists, ComposeByAlpha) {
  // A pane of alpha 1/2, a wall close behind the pane and a wall far behind the pane.
  const FragmentLists lists{.columns = 1,
                            .rows = 1,
                            .offsets = {0, 3},
                            .fragments = {{5000, 0, 0, 1, 1}, {1001, 0, 1, 0, 1}, {1000, 0.5f, 0, 0, 0.5f}}};
  LayerSet layers;
  layers.peel_fragments(lists, 1e-5, 4);
  ASSERT_EQ(layers.count(), 2);
  EXPECT_FLOAT_EQ(layers.rgba(0, 0)[0], 0.5f);
  EXPECT_FLOAT_EQ(layers.rgba(0, 0)[1], 0.5f);
  EXPECT_FLOAT_EQ(layers.rgba(0, 0)[3], 1);
  EXPECT_FLOAT_EQ(layers.inverse_depth(1)[0], 1 / 5000.0f);
  EXPECT_TRUE(layers.opaque());
}

TEST(Lists, IgnoreInvalidSurfacesAndKeepTheSky) {
  const FragmentLists lists{
      .columns = 2,
      .rows = 1,
      .offsets = {0, 4, 4},
      .fragments = {{none, 9, 9, 9, 1}, {-1, 9, 9, 9, 1}, {0, 9, 9, 9, 1}, {infinity, 1, 2, 3, 1}}};
  LayerSet layers;
  layers.peel_fragments(lists, 1e-5, 4);
  ASSERT_EQ(layers.count(), 1);
  EXPECT_EQ(layers.inverse_depth(0)[0], 0);
  EXPECT_EQ(layers.rgba(0, 0)[2], 3);
  EXPECT_LT(layers.inverse_depth(0)[1], 0);
}

TEST(Lists, RoundTripThroughLayers) {
  const FragmentLists lists = random_lists(19, 11, 5, 4);
  LayerSet layers, again;
  layers.peel_fragments(lists, 1e-6, 8);
  again.peel_fragments(layers.fragments(), 1e-6, 8);
  ASSERT_EQ(layers.count(), again.count());
  for (int layer = 0; layer < layers.count(); ++layer) {
    for (std::size_t i = 0; i < layers.inverse_depth(layer).size(); ++i) {
      EXPECT_EQ(layers.rgba(layer, i), again.rgba(layer, i));
      EXPECT_NEAR(layers.inverse_depth(layer)[i], again.inverse_depth(layer)[i], 2e-10f);
    }
  }
}

TEST(Images, BecomeLayers) {
  const std::vector<float> rgba{1, 2, 3, 1, 4, 5, 6, 1}, depth{100, infinity}, behind{200, none};
  LayerSet layers;
  const std::vector<LayerImage> images{{2, 1, rgba, depth}, {2, 1, rgba, behind}};
  layers.set(images);
  ASSERT_EQ(layers.count(), 2);
  EXPECT_EQ(layers.rgba(0, 1)[1], 5);
  EXPECT_EQ(layers.inverse_depth(0)[1], 0);
  EXPECT_FLOAT_EQ(layers.inverse_depth(1)[0], 0.005f);
  EXPECT_LT(layers.inverse_depth(1)[1], 0);
}

TEST(Images, KeepThirteenBitsOfColoursOfAnySizeAndSign) {
  // The second layer is the first with an alpha below 1.
  std::mt19937 engine(4);
  std::uniform_real_distribution<float> number(-1, 1);
  constexpr int columns = 211, rows = 3;
  std::vector<float> first, second;
  for (int i = 0; i < columns * rows; ++i) {
    for (int c = 0; c < 3; ++c) {
      first.push_back(std::exp2(60 * number(engine)) * number(engine));
      second.push_back(i == 0 ? 0.0f : number(engine));
    }
    first.push_back(1), second.push_back(i % 2 == 0 ? 1 : 0.5f);
  }
  const std::vector<float> depth(columns * rows, 100.0f), behind(columns * rows, 200.0f), far(columns * rows, 300.0f);
  LayerSet layers;
  const std::vector<LayerImage> images{
      {columns, rows, first, depth}, {columns, rows, second, behind}, {columns, rows, first, far}};
  layers.set(images);
  ASSERT_EQ(layers.count(), 3);
  EXPECT_FALSE(layers.opaque());
  for (int layer = 0; layer < 3; ++layer) {
    const std::vector<float>& given = layer == 1 ? second : first;
    for (std::size_t i = 0; i < given.size() / 4; ++i) {
      const auto kept = layers.rgba(layer, i);
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_LE(std::abs(kept[c] - given[4 * i + c]), std::abs(given[4 * i + c]) * 0x1p-13f) << layer << ' ' << i;
      }
      ASSERT_EQ(kept[3], given[4 * i + 3]) << layer << ' ' << i;
      ASSERT_FLOAT_EQ(layers.inverse_depth(layer)[i], 0.01f / static_cast<float>(layer + 1));
    }
  }
  const std::size_t bytes = layers.memory_bytes();
  layers.set(images);
  EXPECT_EQ(layers.memory_bytes(), bytes);
}

TEST(Images, RefuseInconsistentImages) {
  const std::vector<float> rgba{1, 2, 3, 1, 4, 5, 6, 1}, depth{100, infinity}, nearer{50, none}, empty{none, none};
  LayerSet layers;
  const auto says = [&](std::vector<LayerImage> images, const std::string& what) {
    const std::string said = petzval::testing::message([&] { layers.set(images); });
    expect_tokens(said, {what});
  };
  says({}, "0 layers");
  says({{2, 1, rgba, depth}, {1, 1, std::span(rgba).first(4), std::span(depth).first(1)}}, "layer 1: size = 1 x 1");
  says({{2, 1, rgba, std::span(depth).first(1)}}, "layer 0: number of colours = 8, of depths = 1");
  for (const float alpha : {2.0f, -1.0f, none, infinity}) {
    std::vector<float> mixed = rgba;
    mixed[7] = alpha;
    says({{2, 1, mixed, depth}}, "layer 0: column 1, row 0: alpha =");
  }
  says({{2, 1, rgba, depth}, {2, 1, rgba, nearer}}, "layer 1: column 0, row 0: inverse depth = 0.02");
  says({{2, 1, rgba, nearer}, {2, 1, rgba, depth}},
       "layer 1: column 1, row 0: inverse depth = 0 / mm");  // behind an empty pixel
}

// Points at one depth, given by their distances. Their raster positions are centres of pixels.
TEST(AxialDepths, EqualPointsInOnePlane) {
  const LayerCamera camera{.columns = 24, .rows = 16, .focal_px = 20, .axis = {9, 6.5}, .overscan = 3};
  constexpr double depth = 700;
  std::vector<float> distances;
  for (int row = 0; row < camera.layer_rows(); ++row) {
    for (int column = 0; column < camera.layer_columns(); ++column) {
      const Vec2<double> pixel{column + 0.5 - camera.overscan, row + 0.5 - camera.overscan};
      const Vec2<double> off = (pixel - camera.axis) * (depth / camera.focal_px);
      const Vec2<double> seen = camera.raster({off.x, -off.y, depth});
      ASSERT_NEAR(seen.x, pixel.x, 1e-12);
      ASSERT_NEAR(seen.y, pixel.y, 1e-12);
      distances.push_back(static_cast<float>(std::hypot(off.x, off.y, depth)));
    }
  }
  FragmentLists lists{.columns = camera.layer_columns(), .rows = camera.layer_rows(), .offsets = {0}, .fragments = {}};
  for (const float distance : distances) {  // 0, 1 and 2 points in a pixel
    for (std::size_t k = 0; k < lists.offsets.size() % 3; ++k)
      lists.fragments.push_back({.depth_mm = distance, .back_mm = distance});
    lists.offsets.push_back(lists.fragments.size());
  }
  axial_depths(camera, lists);
  for (const auto& fragment : lists.fragments) EXPECT_NEAR(fragment.depth_mm, depth, 2e-4);
  for (const auto& fragment : lists.fragments) EXPECT_EQ(fragment.back_mm, fragment.depth_mm);
  distances[5] = infinity, distances[6] = none;
  axial_depths(camera, distances);
  EXPECT_EQ(distances[5], infinity);
  EXPECT_TRUE(std::isnan(distances[6]));
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (i == 5 || i == 6) continue;
    EXPECT_NEAR(distances[i], depth, 2e-4) << i;
  }
  distances.pop_back();
  lists.offsets.pop_back();
  expect_error([&] { axial_depths(camera, distances); }, {"axial_depths", 659, 30, 22});
  expect_error([&] { axial_depths(camera, lists); }, {"axial_depths", 659, 30, 22});
}

}  // namespace layers_test
