// SPDX-License-Identifier: Apache-2.0
// Failing allocations while layers are filled and blurred.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../c/handles.hpp"
#include "allocations.hpp"
#include "blur/gather_method.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/petzval.h"

namespace petzval {
namespace blur_test {

using testing::bits;
using testing::expect_all_or_nothing;

constexpr float infinity = std::numeric_limits<float>::infinity();

LayerCamera small_camera() { return layer_camera(64, 96, radians(15)); }

/// Rays that are equal for all pixels, or differ.
LensRays rays_of(bool shared) {
  ThinLens lens{.radius_mm = 15, .inverse_focus = 1 / 2000.0};
  if (!shared) lens.focus = [](const Vec2<double>& at) { return FocusAt{(1 + 0.01 * at.y) / 2000, 1}; };
  return LensRays::thin(small_camera(), lens, vogel_points(7), {.nearest_mm = 1000});
}

/// A bright board before a sky.
void fill(LayerSet& layers, const PeelPlan& plan) {
  layers.peel(plan, 3, [&](int layer, std::span<const float>, const LayerPlanes& out) -> std::size_t {
    if (layer > 1) return 0;
    for (std::size_t i = 0; i < out.red.size(); ++i) {
      const bool board = layer == 0 && i % 16 < 8;
      out.inverse_depth[i] = layer == 0 ? (board ? 1 / 1200.0f : 0.0f) : (i % 16 < 8 ? 0.0f : -1.0f);
      out.red[i] = i % 64 == 0 ? 100.0f : 0.5f, out.green[i] = 0.2f, out.blue[i] = 1;
    }
    return out.red.size();
  });
}
LayerSet layers_for(const LensRays& rays) {
  LayerSet layers;
  fill(layers, plan_peel(rays, 1000, infinity));
  return layers;
}

std::string shown(const LayerSet& layers) {
  std::string text = std::to_string(layers.columns()) + ' ' + std::to_string(layers.rows());
  for (int layer = 0; layer < layers.count(); ++layer) text += bits(layers.inverse_depth(layer));
  return text;
}
std::string shown(const BlurredImage& picture) { return bits(std::span<const float>(picture.rgba)); }

TEST(MemoryEnds, WhileLayersAreFilled) {
  const PeelPlan plan = plan_peel(rays_of(true), 1000, infinity);
  const LayerSet whole = layers_for(rays_of(true));
  const FragmentLists lists = whole.fragments();
  const std::vector<float> rgba(4 * 64), depths(64, 2000.0f);
  const LayerImage image{8, 8, rgba, depths};
  const std::vector<std::function<void(LayerSet&)>> fillings{
      [&](LayerSet& layers) { fill(layers, plan); }, [&](LayerSet& layers) { layers.peel_fragments(lists, 0, 4); },
      [&](LayerSet& layers) {
        layers.set({&image, 1});
      }};
  for (const auto& filling : fillings) {
    // Reuses the layers of another image.
    const LayerImage small{4, 4, std::span(rgba).first(64), std::span(depths).first(16)};
    expect_all_or_nothing([&] {
      LayerSet layers;
      layers.set({&small, 1});
      try {
        filling(layers);
      } catch (...) {
        if (layers.columns() != 0 || layers.rows() != 0 || layers.count() != 0) return std::string("half filled");
        throw;
      }
      return shown(layers);
    });
  }
}

TEST(MemoryEnds, WhileRaysOfALensAreTabulated) {
  for (const bool shared : {true, false}) {
    expect_all_or_nothing([&] {
      const LensRays rays = rays_of(shared);
      std::vector<LayerRay> found(rays.count());
      rays.at(0, 5, 7, found);
      std::string text;
      for (const LayerRay& ray : found) text += bits(std::span<const double>(&ray.position.x, 1));
      return text;
    });
  }
}

TEST(MemoryEnds, InAnyThreadOfABlur) {
  for (const bool shift_invariant : {true, false}) {
    SCOPED_TRACE(shift_invariant);
    const LensRays rays = rays_of(shift_invariant);
    const LayerSet layers = layers_for(rays);
    expect_all_or_nothing([&] {
      BlurredImage picture;
      try {
        gather(layers, rays, {.threads = 4}, picture);
      } catch (...) {
        if (picture.columns != 0 || picture.rows != 0 || !picture.rgba.empty()) return std::string("half blurred");
        throw;
      }
      return shown(picture);
    });
  }
}

TEST(Memory, IsKeptBetweenGathersOfTheCInterface) {
  petzval_film film = petzval_film_init();
  film.columns = 150, film.rows = 100;
  const testing::CameraHandle camera = testing::create_camera(testing::read_lens(), &film);
  petzval_lens_rays_options few = petzval_lens_rays_options_init();
  few.count = 20;
  petzval_lens_rays* rays = nullptr;
  ASSERT_EQ(petzval_lens_rays_create(camera.get(), &few, &rays), PETZVAL_OK) << petzval_message();
  const testing::RaysHandle own_rays(rays);
  std::vector<float> rgba, depth_mm;
  for (int i = 0; i < 150 * 100; ++i) {
    rgba.insert(rgba.end(), {0.2f, 0.4f, 0.6f, 1}), depth_mm.push_back(i % 30 < 10 ? 800.0f : 3000.0f);
  }
  const float *const colours = rgba.data(), *const depths = depth_mm.data();
  petzval_layers* layers = nullptr;
  ASSERT_EQ(petzval_layers_create(150, 100, 1, &colours, &depths, &layers), PETZVAL_OK) << petzval_message();
  const testing::LayersHandle own_layers(layers);
  petzval_blur* blur = nullptr;
  ASSERT_EQ(petzval_blur_create(&blur), PETZVAL_OK);
  const testing::BlurHandle own_blur(blur);
  petzval_gather_options options = petzval_gather_options_init();
  options.progress = [](double, void*) { return std::int32_t{0}; };
  const auto allocations_of_gather = [&] {
    const long before = testing::allocations();
    EXPECT_EQ(petzval_gather(layers, rays, &options, blur, rgba.data(), 16 * 150, depth_mm.data()), PETZVAL_OK);
    return testing::allocations() - before;
  };
  EXPECT_GT(allocations_of_gather(), 0);
  EXPECT_EQ(allocations_of_gather(), 0);
  options.left = 31, options.columns = 77, options.rows = 50;
  EXPECT_EQ(allocations_of_gather(), 0);
}

}  // namespace blur_test
}  // namespace petzval
