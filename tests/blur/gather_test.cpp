// SPDX-License-Identifier: Apache-2.0
#include "petzval/blur/lens_rays.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "../expect_error.hpp"
#include "blur/gather_method.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "reference_gather.hpp"

namespace gather_test {

using petzval::testing::expect_error;

using namespace petzval;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Surfaces of a scene in the direction with tangents x and y (up) of the layer camera.
struct Surface {
  float inverse_depth = -1, red = 0, green = 0, blue = 0, alpha = 1;
};
using Scene = std::vector<Surface> (*)(double x, double y);

/// A floor, two boards with holes and a sky: occlusion at edges, and depths that vary within a pixel.
std::vector<Surface> boards(double x, double y) {
  std::vector<Surface> seen;
  const auto wave = [](double a) { return static_cast<float>(0.5 + 0.5 * std::sin(a)); };
  if (std::abs(x + 0.08) < 0.05 && std::abs(y) < 0.1 && std::hypot(x + 0.08, y) > 0.02) {
    seen.push_back({1 / 1200.0f, 1, wave(300 * x), 0.2f});
  }
  if (std::abs(x - 0.05) < 0.07 && std::abs(y - 0.03) < 0.06) seen.push_back({1 / 2100.0f, wave(200 * y), 0.3f, 1});
  if (y < -0.02) {
    const double w = -y / 300;
    seen.push_back({static_cast<float>(w), wave(0.02 * x / w), wave(0.003 / w), 0.5f});
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const auto& a, const auto& b) { return a.inverse_depth > b.inverse_depth; });
  seen.push_back({0, 0.3f, 0.5f, 0.9f});
  return seen;
}

/// The scene with glass instead of the first board.
std::vector<Surface> panes(double x, double y) {
  std::vector<Surface> seen = boards(x, y);
  for (Surface& s : seen) {
    if (s.inverse_depth == 1 / 1200.0f) s.alpha = 0.4f, s.red *= 0.4f, s.green *= 0.4f, s.blue *= 0.4f;
  }
  return seen;
}

LayerSet::Peel renderer_of(Scene scene, const LayerCamera& camera) {
  return [=](int, std::span<const float> below, const LayerPlanes& out) {
    std::size_t written = 0;
    for (int row = 0; row < camera.layer_rows(); ++row) {
      for (int column = 0; column < camera.layer_columns(); ++column) {
        const auto pixel = static_cast<std::size_t>(row * camera.layer_columns() + column);
        const double x = (column + 0.5 - camera.overscan - camera.axis.x) / camera.focal_px,
                     y = -(row + 0.5 - camera.overscan - camera.axis.y) / camera.focal_px;
        for (const Surface& s : scene(x, y)) {
          if (!(s.inverse_depth < below[pixel])) continue;
          out.inverse_depth[pixel] = s.inverse_depth;
          out.red[pixel] = s.red, out.green[pixel] = s.green, out.blue[pixel] = s.blue, out.alpha[pixel] = s.alpha;
          ++written;
          break;
        }
      }
    }
    return written;
  };
}

LayerCamera small_camera() { return layer_camera(150, 100, radians(15)); }

LayerSet layers_of(Scene scene, const LensRays& rays, int count = 6) {
  const PeelPlan plan = plan_peel(rays, 1000, infinity);
  LayerSet layers;
  layers.peel(plan, count, renderer_of(scene, plan.camera));
  return layers;
}

LensRays thin_rays(double radius, int points = 61, const LensRaysOptions& options = {.nearest_mm = 1000}) {
  return LensRays::thin(small_camera(), {.radius_mm = radius, .inverse_focus = 1 / 2000.0},
                        vogel_points(points * options.set_count), options);
}
/// Rays that differ between pixels.
LensRays tilted_rays(double radius, int points = 61, const LensRaysOptions& options = {.nearest_mm = 1000}) {
  return LensRays::thin(small_camera(),
                        {.radius_mm = radius,
                         .focus =
                             [](const Vec2<double>& raster) {
                               return FocusAt{(1 + 0.4 * raster.y / 100) / 2000.0, 1};
                             }},
                        vogel_points(points * options.set_count), options);
}

struct Difference {
  double mean = 0, most = 0;
};
Difference difference(const BlurredImage& a, const BlurredImage& b) {
  Difference d;
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const double off = std::abs(a.rgba[i] - b.rgba[i]);
    d.mean += off / static_cast<double>(a.rgba.size()), d.most = std::max(d.most, off);
  }
  return d;
}

/// The largest difference between a picture and the first layer.
double from_first_layer(const BlurredImage& picture, const LayerSet& layers) {
  const int overscan = (layers.columns() - 150) / 2;
  double worst = 0;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 150; ++column) {
      for (int c = 0; c < 4; ++c) {
        const float seen = picture.rgba[static_cast<std::size_t>(4 * (row * 150 + column) + c)];
        const float layer = layers.rgba(0, static_cast<std::size_t>((row + overscan) * layers.columns() + column +
                                                                    overscan))[static_cast<std::size_t>(c)];
        worst = std::max(worst, static_cast<double>(std::abs(seen - layer)));
      }
    }
  }
  return worst;
}

TEST(Gather, PinholeEqualsTheFirstLayer) {
  const LensRays rays = thin_rays(0, 5);
  const LayerSet layers = layers_of(boards, rays);
  for (const bool by_blocks : {true, false}) {
    EXPECT_LT(from_first_layer(blur_detail::gather(layers, rays, {}, {by_blocks}), layers), 1e-6) << by_blocks;
  }
}

// Rays that move by 0.01 pixel over all depths: a step of one pixel is a hundred times as long as the scene.
TEST(Gather, TinyLensEqualsTheFirstLayer) {
  for (const LensRays& rays : {thin_rays(0.05, 12), tilted_rays(0.05, 12)}) {
    const LayerSet layers = layers_of(boards, rays);
    for (const bool by_blocks : {true, false}) {
      EXPECT_LT(from_first_layer(blur_detail::gather(layers, rays, {}, {by_blocks}), layers), 1e-6) << by_blocks;
    }
  }
}

TEST(Gather, KeepsAUniformColour) {
  const Scene even = [](double x, double y) {
    std::vector<Surface> seen = boards(x, y);
    for (Surface& s : seen) s.red = 3, s.green = 0.25f, s.blue = 1e-3f;
    return seen;
  };
  for (const LensRays& rays : {thin_rays(20), tilted_rays(20)}) {
    const BlurredImage picture = gather(layers_of(even, rays), rays, {.highlights_above = 0});
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
      ASSERT_NEAR(picture.rgba[i], 3, 1e-5);
      ASSERT_NEAR(picture.rgba[i + 1], 0.25, 1e-6);
      ASSERT_NEAR(picture.rgba[i + 3], 1, 1e-6);
    }
  }
}

TEST(Gather, EqualsTheReference) {
  for (const Scene scene : {Scene(boards), Scene(panes)}) {
    for (const LensRays& rays :
         {thin_rays(25), tilted_rays(25), tilted_rays(25, 20, {.nearest_mm = 1000, .set_count = 4})}) {
      const LayerSet layers = layers_of(scene, rays);
      const BlurredImage reference = petzval::testing::reference_gather(layers, rays);
      for (const bool by_blocks : {true, false}) {
        const Difference d = difference(blur_detail::gather(layers, rays, {}, {by_blocks}), reference);
        // Rounding in float takes a few rays to an adjacent pixel, and so does the line of a block.
        const bool exact = !by_blocks || rays.shift_invariant();
        EXPECT_LT(d.mean, exact ? 2e-4 : 2e-3) << by_blocks << (scene == Scene(panes) ? ", panes" : "");
        EXPECT_LT(d.most, exact ? 0.06 : 0.2) << by_blocks;
      }
    }
  }
}

// A lens that transmits 70 % on the right side and 0 on the left.
TEST(Gather, DarkensColoursAndKeepsAlpha) {
  const LensRays rays(small_camera(), vogel_points(24), 1,
                      [](int, const Vec2<double>& raster, std::span<const PupilPoint>, std::span<LayerRay> found) {
                        double turn = 0.3;
                        for (LayerRay& ray : found) {
                          ray = {raster, {9000 * std::cos(turn), 9000 * std::sin(turn)}, raster.x < 75 ? 0 : 0.7};
                          turn += 1;
                        }
                      },
                      {.nearest_mm = 1000});
  for (const Scene scene : {Scene(boards), Scene(panes)}) {
    const LayerSet layers = layers_of(scene, rays, 1);  // rays miss many of its surfaces
    const BlurredImage reference = petzval::testing::reference_gather(layers, rays);
    for (const bool by_blocks : {true, false}) {
      const BlurredImage picture = blur_detail::gather(layers, rays, {.highlights_above = 0}, {by_blocks});
      EXPECT_LT(difference(picture, reference).mean, 2e-4) << by_blocks;
      double most = 0;
      for (std::size_t i = 0; i < picture.missed.size(); ++i) {
        const float* const pixel = &picture.rgba[4 * i];
        ASSERT_NEAR(picture.missed[i], reference.missed[i], 0.06) << i;
        ASSERT_LE(picture.missed[i], 1 + 1e-5f);
        ASSERT_LE(pixel[3], 1 + 1e-5f);
        ASSERT_LE(pixel[1], (i % 150 < 50 ? 0 : 0.7f) + 1e-5f);
        most = std::max<double>(most, picture.missed[i]);
      }
      EXPECT_GT(most, 0.2);
    }
  }
}

// Rays without a known surface take the mean of the others, so that a scene of one colour keeps its colour.
TEST(Gather, KeepsAUniformColourWithMissingSurfaces) {
  const Scene grey_boards = [](double x, double y) {
    std::vector<Surface> seen;
    if (std::abs(x) < 0.02) seen.push_back({1 / 1000.0f, 0.5f, 0.5f, 0.5f});
    if (std::abs(y) < 0.03) seen.push_back({1 / 1500.0f, 0.5f, 0.5f, 0.5f});
    seen.push_back({1 / 5000.0f, 0.5f, 0.5f, 0.5f});
    return seen;
  };
  for (const LensRays& rays : {thin_rays(40), tilted_rays(40)}) {
    const LayerSet layers = layers_of(grey_boards, rays, 1);
    for (const bool by_blocks : {true, false}) {
      const BlurredImage picture = blur_detail::gather(layers, rays, {.highlights_above = 0}, {by_blocks});
      EXPECT_GT(picture.missed_count, 0u) << by_blocks;
      for (std::size_t i = 0; i < picture.missed.size(); ++i) {
        ASSERT_NEAR(picture.rgba[4 * i], 0.5, 1e-4) << by_blocks << ' ' << i << ' ' << picture.missed[i];
      }
    }
  }
}

TEST(Gather, LinesOfBlocksAndOfPixelsAgree) {
  for (const auto& [scene, sets] : {std::pair(Scene(boards), 1), std::pair(Scene(panes), 1),
                                    std::pair(Scene(boards), 4), std::pair(Scene(panes), 16)}) {
    for (const auto& rays_of : {thin_rays, tilted_rays}) {
      const LensRays rays = rays_of(25, 200 / sets, {.nearest_mm = 1000, .set_count = sets});
      const LayerSet layers = layers_of(scene, rays);
      const BlurredImage blocks = blur_detail::gather(layers, rays, {}, {true}),
                         pixels = blur_detail::gather(layers, rays, {}, {false});
      double squares = 0;
      for (std::size_t i = 0; i < blocks.rgba.size(); ++i) {
        squares += std::pow(static_cast<double>(blocks.rgba[i] - pixels.rgba[i]), 2);
      }
      // The fewer rays a pixel has, the more a single ray in an adjacent pixel counts.
      EXPECT_GT(-10 * std::log10(squares / static_cast<double>(blocks.rgba.size())), rays.shift_invariant() ? 55 : 40)
          << sets;
    }
  }
}

// Rays that end in the void far from their pixels: the window of the tile contains no pixel of the tile.
TEST(Gather, ReadsNoPixelOutsideItsWindow) {
  const LayerCamera camera = layer_camera(6, 6, radians(20));
  const LensRays rays(camera, vogel_points(6), 1,
                      [](int, const Vec2<double>& raster, std::span<const PupilPoint> at, std::span<LayerRay> found) {
                        for (std::size_t i = 0; i < at.size(); ++i) {
                          found[i] = {.position = raster + Vec2<double>{0.0137, 0.0291},
                                      .slope = {-400 + 100 * at[i].u + 3 * raster.y, -400 - 100 * at[i].v},
                                      .weight = 1};
                        }
                      },
                      {.nearest_mm = 400});
  const PeelPlan plan = plan_peel(rays, 450, infinity);
  // The first rows are empty, and the last rows have surfaces nearer than planned.
  const int columns = plan.camera.layer_columns(), rows = plan.camera.layer_rows();
  FragmentLists lists{.columns = columns, .rows = rows, .offsets = {0}, .fragments = {}};
  for (int i = 0; i < columns * rows; ++i) {
    if (i / columns > 8) lists.fragments.push_back({1, 1, 1, 1, 1});
    lists.offsets.push_back(lists.fragments.size());
  }
  LayerSet layers;
  layers.peel_fragments(lists, 0, 1);
  for (const bool by_blocks : {true, false}) {
    const BlurredImage picture = blur_detail::gather(layers, rays, {}, {by_blocks});
    for (const float value : picture.rgba) EXPECT_EQ(value, 0) << by_blocks;
    for (const float share : picture.missed) EXPECT_EQ(share, 0);
  }
}

TEST(Gather, IndependentOfBounds) {
  for (const LensRays& rays : {thin_rays(25), tilted_rays(25)}) {
    const LayerSet layers = layers_of(boards, rays);
    for (const bool by_blocks : {true, false}) {
      const BlurredImage bounded = blur_detail::gather(layers, rays, {}, {by_blocks}),
                         free = blur_detail::gather(layers, rays, {}, {by_blocks, false});
      EXPECT_EQ(bounded.rgba, free.rgba) << by_blocks;
      EXPECT_LT(bounded.step_count, free.step_count) << by_blocks;
    }
  }
}

TEST(Gather, IndependentOfThreads) {
  for (const LensRays& rays :
       {thin_rays(25), tilted_rays(25), tilted_rays(9, 20, {.nearest_mm = 1000, .set_count = 4})}) {
    const LayerSet layers = layers_of(boards, rays);
    const BlurredImage one = gather(layers, rays), three = gather(layers, rays, {.threads = 3});
    EXPECT_EQ(one.rgba, three.rgba);
    EXPECT_EQ(one.missed, three.missed);
  }
}

/// The scene with lights at four depths, at the edges of regions and beyond the picture; some are partly hidden.
std::vector<Surface> lights(double x, double y) {
  std::vector<Surface> seen = boards(x, y);
  for (Surface& s : seen) {
    const double apart = 0.031 + 0.01 * s.inverse_depth * 1000;
    if (std::hypot(std::remainder(x, apart), std::remainder(y, apart)) < 0.0025) s.red = 300, s.blue = 40;
  }
  return seen;
}

TEST(Gather, RegionsHaveTheBitsOfTheWholePicture) {
  std::mt19937 random(5);
  const LensRays coloured =
      LensRays::thin(small_camera(), {.radius_mm = 25, .inverse_focus = 1 / 2000.0, .colour_shift = {1e-5, 0, -2e-5}},
                     vogel_points(40), {.nearest_mm = 1000});
  for (const LensRays& rays : {thin_rays(25), tilted_rays(25), coloured, tilted_rays(60, 8),
                               tilted_rays(25, 20, {.nearest_mm = 1000, .set_count = 4})}) {
    for (const Scene scene : {Scene(panes), Scene(lights)}) {
      const LayerSet layers = layers_of(scene, rays), other = layers_of(boards, rays);
      const BlurredImage whole = gather(layers, rays);
      EXPECT_EQ(whole.highlight_count > 0, scene == Scene(lights));
      std::vector<std::pair<int, int>> tiles;
      constexpr int columns = 37, rows = 23;
      for (int i = 0; i < 150 * 100; ++i) {
        if (i % 150 % columns == 0 && i / 150 % rows == 0) tiles.emplace_back(i % 150, i / 150);
      }
      std::shuffle(tiles.begin(), tiles.end(), random);
      BlurredImage picture;
      gather(other, rays, {}, picture);  // the highlights of another scene must not stay
      for (const auto& [left, top] : tiles) {
        const int width = std::min(columns, 150 - left), height = std::min(rows, 100 - top);
        gather(layers, rays, {.threads = 1 + left % 3, .left = left, .top = top, .columns = width, .rows = height},
               picture);
        ASSERT_EQ(picture.columns * picture.rows, width * height);
        for (int i = 0; i < width * height; ++i) {
          const auto at = static_cast<std::size_t>((top + i / width) * 150 + left + i % width),
                     own = static_cast<std::size_t>(i);
          ASSERT_TRUE(std::equal(&whole.rgba[4 * at], &whole.rgba[4 * at] + 4, &picture.rgba[4 * own])) << at;
          ASSERT_EQ(whole.missed[at], picture.missed[own]) << at;
        }
      }
    }
  }
}

TEST(Gather, LeavesAnEmptyPictureIfCancelled) {
  for (const LensRays& rays :
       {thin_rays(25), tilted_rays(25), tilted_rays(9, 20, {.nearest_mm = 1000, .set_count = 4})}) {
    const LayerSet layers = layers_of(boards, rays);
    const BlurredImage whole = gather(layers, rays);
    BlurredImage picture = gather(layers, rays);
    std::stop_source stop;
    const GatherOptions options{.threads = 2, .stop = stop.get_token()};
    gather(layers, rays, options, picture);
    EXPECT_EQ(picture.rgba, whole.rgba);
    const std::jthread other([&] { stop.request_stop(); });
    const auto until_cancelled = [&] {
      for (;;) gather(layers, rays, options, picture);
    };
    EXPECT_THROW(until_cancelled(), Cancelled);
    EXPECT_EQ(picture.columns, 0);
    EXPECT_TRUE(picture.rgba.empty() && picture.missed.empty());
    gather(layers, rays, {}, picture);
    EXPECT_EQ(picture.rgba, whole.rgba);
  }
}

TEST(Gather, EmptyPixelsAreTransparent) {
  const Scene alone = [](double x, double y) {
    std::vector<Surface> seen;
    if (x < 0) seen.push_back({1 / 1500.0f, 0.5f, 0.5f, static_cast<float>(0.5 + y)});
    return seen;
  };
  const LensRays rays = thin_rays(60, 400);
  const BlurredImage picture = gather(layers_of(alone, rays), rays);
  const double blur = 60 * (1 / 1500.0 - 1 / 2000.0) * rays.camera().focal_px;
  ASSERT_GT(blur, 2);
  for (int column = 0; column < 150; ++column) {
    // Fraction of the disc around the pixel to the left of the edge at 75.
    const double s = std::clamp((75 - (column + 0.5)) / blur, -1.0, 1.0);
    const double wanted = 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi;
    const float* const pixel = &picture.rgba[static_cast<std::size_t>(4 * (50 * 150 + column))];
    EXPECT_NEAR(pixel[3], wanted, 0.06) << column;
    EXPECT_NEAR(pixel[0], 0.5 * pixel[3], 0.06) << column;  // missed rays are not transparent
  }
}

TEST(Gather, ReportsMissingSurfaces) {
  const LensRays rays = thin_rays(25);
  const LayerSet one = layers_of(boards, rays, 1), all = layers_of(boards, rays, 8);
  const BlurredImage of_one = gather(one, rays), of_all = gather(all, rays);
  EXPECT_GT(of_one.missed_count, 50 * (of_all.missed_count + 1));
  EXPECT_GT(*std::max_element(of_one.missed.begin(), of_one.missed.end()), 0.2f);
  EXPECT_LT(difference(of_one, of_all).mean, 0.01);
}

TEST(Gather, ReusesMemory) {
  const LensRays rays = thin_rays(25);
  const LayerSet layers = layers_of(boards, rays);
  BlurredImage picture;
  gather(layers, rays, {}, picture);
  const float* const before = picture.rgba.data();
  gather(layers, rays, {}, picture);
  EXPECT_EQ(before, picture.rgba.data());
}

TEST(Gather, RefusesInconsistentInput) {
  const LensRays rays = thin_rays(9);
  const LayerSet layers = layers_of(boards, rays);
  const auto says = [&](const LayerSet& l, const LensRays& r, const GatherOptions& options,
                        const std::vector<petzval::testing::Token>& tokens) {
    expect_error([&] { gather(l, r, options); }, tokens);
  };
  says(LayerSet(), rays, {}, {"layers", 0, 0});
  says(layers, rays, {.highlights_above = -1}, {"highlights_above", -1});
  says(layers, rays, {.threads = 0}, {"threads", 0});
  for (const auto& [left, columns] : {std::pair(-1, 9), {142, 9}, {0, -1}, {3, 0}, {2147483647, 9}, {1, 2147483647}}) {
    says(layers, rays, {.left = left, .top = 1, .columns = columns, .rows = 5}, {"region", columns, left});
  }
  // A surface 0.01 mm in front of a lens of 18 mm.
  FragmentLists near{
      .columns = 150, .rows = 100, .offsets = std::vector<std::size_t>(15001, 1), .fragments = {{0.01f, 1, 1, 1, 1}}};
  near.offsets[0] = 0;
  LayerSet too_near;
  too_near.peel_fragments(near, 0, 1);
  says(too_near, rays, {}, {16384, 0.01});
  near.fragments[0].depth_mm = 0.3f;
  too_near.peel_fragments(near, 0, 1);
  says(too_near, rays, {}, {"layers"});
  EXPECT_EQ(gather(layers, rays).columns, 150);
}

TEST(Highlights, AreUniformDiscs) {
  // One pixel of value 1000 at 1 m, seen by 32 rays, becomes a disc without holes with the radius of the formula.
  const Scene lamp = [](double x, double y) {
    std::vector<Surface> seen;
    if (std::abs(x) < 0.0014 && std::abs(y) < 0.0014) seen.push_back({1 / 1000.0f, 1000, 500, 0.5f});
    seen.push_back({1 / 2000.0f, 0.1f, 0.1f, 0.1f});
    return seen;
  };
  for (const LensRays& rays : {thin_rays(30, 32), LensRays::thin(small_camera(),
                                                                 {.radius_mm = 30,
                                                                 .focus =
                                                                      [](const Vec2<double>& r) {
                                                                        return FocusAt{1 / 2000.0 + 1e-9 * r.x, 1};
                                                                      }},
                                                                 vogel_points(32), {.nearest_mm = 1000})}) {
    const LayerSet layers = layers_of(lamp, rays);
    const BlurredImage picture = gather(layers, rays);
    EXPECT_GT(picture.highlight_count, 0u);
    const double radius = 30 * (1 / 1000.0 - 1 / 2000.0) * rays.camera().focal_px;
    const double area = std::numbers::pi * radius * radius, level = picture.highlight_count * 1000 / area;
    double light = 0, least = 1e9, most = 0, outside = 0;
    for (int row = 0; row < 100; ++row) {
      for (int column = 0; column < 150; ++column) {
        const float* const pixel = &picture.rgba[static_cast<std::size_t>(4 * (row * 150 + column))];
        light += pixel[0] - 0.1;
        const double from_middle = std::hypot(column + 0.5 - 75, row + 0.5 - 50);
        if (from_middle < radius - 3)
          least = std::min<double>(least, pixel[0]), most = std::max<double>(most, pixel[0]);
        if (from_middle > radius + 3) outside = std::max<double>(outside, pixel[0]);
      }
    }
    EXPECT_NEAR(light, level * area, 0.01 * level * area);
    EXPECT_LT(outside, 0.2);
    EXPECT_GT(least, 0.85 * level);
    EXPECT_LT(most, 1.15 * level);
  }
}

TEST(Highlights, AreLightsWithMoreBlurPixelsThanRays) {
  const LensRays rays = thin_rays(30, 32);  // focused at 2 m
  static float lamp_at;
  const Scene lamp = [](double x, double y) {
    std::vector<Surface> seen;
    if (std::abs(x) < 0.0014 && std::abs(y) < 0.0014) seen.push_back({lamp_at, 1000, 1000, 1000});
    return seen;
  };
  for (const double radius_px : {-5.0, -4.0, -2.5, 0.0, 2.5, 4.0, 5.0}) {  // positive: nearer than the focus
    lamp_at = static_cast<float>(1 / 2000.0 + radius_px / (30 * rays.camera().focal_px));
    const bool spread = std::numbers::pi * radius_px * radius_px > 32;
    EXPECT_EQ(gather(layers_of(lamp, rays), rays).highlight_count > 0, spread) << radius_px;
  }
}

TEST(Highlights, AreLightsInFrontOfAWhiteWall) {
  // A wall that is bright, but dimmer than the lamp by far, fills the blur of the lamp.
  static float wall;
  const Scene lamp = [](double x, double y) {
    std::vector<Surface> seen;
    if (std::abs(x) < 0.0014 && std::abs(y) < 0.0014) seen.push_back({1 / 1000.0f, 1000, 500, 0.5f});
    seen.push_back({1 / 2000.0f, wall, wall, wall});
    return seen;
  };
  const LensRays rays = thin_rays(30, 32);
  std::uint64_t lights[2];
  for (const bool white : {false, true}) {
    wall = white ? 2.0f : 0.1f;
    lights[white] = gather(layers_of(lamp, rays), rays).highlight_count;
  }
  EXPECT_GT(lights[0], 0u);
  EXPECT_EQ(lights[1], lights[0]);
}

TEST(Highlights, AreSmoothIfRaysSpreadUnevenly) {
  // The map of the pupil (x, y) to the blur (x + 0.4 x^2, y) has a density of 1 / (1 + 0.8 x).
  const LayerCamera camera = small_camera();
  constexpr double radius = 22, w = 1 / 1000.0, stretch = 0.4;
  const LensRays::Source source = [=](int, const Vec2<double>& raster, std::span<const PupilPoint> points,
                                      std::span<LayerRay> found) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double turn = 2 * std::numbers::pi * points[i].u, r = std::sqrt(points[i].v), x = r * std::cos(turn);
      const Vec2<double> slope = Vec2<double>{x + stretch * x * x, r * std::sin(turn)} * (2 * radius / w);
      found[i] = {raster - slope * (0.5 * w), slope, 1};
    }
  };
  const LensRays rays(camera, vogel_points(32), 1, source, {.nearest_mm = 1000});
  const Scene lamp = [](double x, double y) {
    std::vector<Surface> seen;
    if (std::abs(x) < 0.0014 && std::abs(y) < 0.0014) seen.push_back({1 / 1000.0f, 1000, 500, 0.5f});
    seen.push_back({1 / 2000.0f, 0, 0, 0});
    return seen;
  };
  const BlurredImage picture = gather(layers_of(lamp, rays), rays);
  ASSERT_GT(picture.highlight_count, 0u);
  double worst = 0;  // where rays are sparse
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 150; ++column) {
      // The film is on the other side of the lamp.
      const double at = -(column + 0.5 - 75) / radius, y = (row + 0.5 - 50) / radius;
      const double x = (std::sqrt(std::max(0.0, 1 + 4 * stretch * at)) - 1) / (2 * stretch);
      if (x < 0.2 || std::hypot(x, y) > 0.9) continue;
      const double level =
          picture.highlight_count * 1000 / (std::numbers::pi * radius * radius) / (1 + 2 * stretch * x);
      worst = std::max(worst, std::abs(picture.rgba[static_cast<std::size_t>(4 * (row * 150 + column))] / level - 1));
    }
  }
  EXPECT_LT(worst, 0.1);
}

/// Lamps at 4 m whose discs the edge of a board at 1.2 m cuts.
std::vector<Surface> lamps_behind_a_board(double x, double y) {
  std::vector<Surface> seen;
  if (x + 0.3 * y < 0) seen.push_back({1 / 1200.0f, 0.1f, 0.1f, 0.1f});
  const bool lamp = std::abs(x - 0.005) < 0.012 && std::abs(std::remainder(y, 0.04)) < 0.0014;
  const float light = lamp ? 1000.0f : 0.1f;
  seen.push_back({1 / 4000.0f, light, light, light});
  return seen;
}

float largest_change(const BlurredImage& a, const BlurredImage& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) most = std::max(most, std::abs(a.rgba[i] - b.rgba[i]));
  return most;
}

// Layers of a camera with a moving focus differ in overscan from frame to frame.
TEST(Highlights, MoreOverscan_GivesTheSamePicture) {
  const LensRays rays = thin_rays(60, 32);
  PeelPlan plan = plan_peel(rays, 1000, infinity);
  std::vector<BlurredImage> pictures;
  for (const int more : {0, 1, 2, 3}) {
    plan.camera.overscan += more;
    LayerSet layers;
    layers.peel(plan, 2, renderer_of(lamps_behind_a_board, plan.camera));
    pictures.push_back(gather(layers, rays));
    ASSERT_GT(pictures[0].highlight_count, 0u);
    EXPECT_LT(largest_change(pictures[0], pictures.back()), 1e-3f) << more;
  }
}

TEST(Highlights, LightAtTheThreshold_IsPartlyADisc) {
  const LensRays rays = thin_rays(60, 32);
  const LayerSet layers = layers_of(lamps_behind_a_board, rays, 2);
  const auto above = [&](double threshold) { return gather(layers, rays, {.highlights_above = threshold}); };
  const float all = largest_change(above(1000), above(100));
  EXPECT_GT(all, 1);
  EXPECT_LT(largest_change(above(1000), above(999)), 0.02f * all);
}

TEST(Highlights, StopIfCancelled) {
  const Scene lamps = [](double x, double y) {
    const bool lamp = std::hypot(std::remainder(x, 0.1), std::remainder(y, 0.05)) < 0.002;
    return std::vector<Surface>{{1 / 1000.0f, lamp ? 1000.0f : 0.1f, 0.1f, 0.1f}};
  };
  std::stop_source stop;
  bool ready = false;
  int calls = 0;
  const LensRays rays(small_camera(), vogel_points(32), 1,
                      [&](int, const Vec2<double>& raster, std::span<const PupilPoint> at, std::span<LayerRay> found) {
                        for (std::size_t i = 0; i < at.size(); ++i) {
                          const double turn = 2 * std::numbers::pi * at[i].u, radius = 9000 * std::sqrt(at[i].v);
                          const Vec2<double> slope{radius * std::cos(turn), radius * std::sin(turn) + raster.x};
                          found[i] = {raster - slope / 2000.0, slope, 1};
                        }
                        if (ready && ++calls == 3) stop.request_stop();
                      },
                      {.nearest_mm = 1000});
  const LayerSet layers = layers_of(lamps, rays);
  ready = true;
  EXPECT_THROW(gather(layers, rays, {.stop = stop.get_token()}), Cancelled);
  EXPECT_EQ(calls, 3);
}

TEST(Highlights, AreHiddenByNearerSurfaces) {
  // A distant lamp; a near board covers the left half of its disc.
  const Scene lamp = [](double x, double y) {
    std::vector<Surface> seen;
    if (x < 0) seen.push_back({1 / 2000.0f, 0.1f, 0.1f, 0.1f});
    if (std::abs(x) < 0.0014 && std::abs(y) < 0.0014) seen.push_back({1 / 20000.0f, 3000, 3000, 3000});
    seen.push_back({0, 0.1f, 0.1f, 0.1f});
    return seen;
  };
  const LensRays rays = thin_rays(30, 32);
  const BlurredImage picture = gather(layers_of(lamp, rays), rays);
  double left = 0, right = 0;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 150; ++column) {
      (column < 74 ? left : right) += picture.rgba[static_cast<std::size_t>(4 * (row * 150 + column))] - 0.1;
    }
  }
  EXPECT_GT(right, 1000);
  EXPECT_LT(left, 0.02 * right);
}

}  // namespace gather_test
