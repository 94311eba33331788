// SPDX-License-Identifier: Apache-2.0
#include "layers/picture_quality.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"

namespace {

using petzval::testing::expect_error;

using namespace lens_blur;
using petzval::RgbImage;
using Colour = std::array<float, 3>;

template <class F>
RgbImage painted(int width, int height, const F& colour) {
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Colour c = colour(x, y);
      std::copy(c.begin(), c.end(), image.pixel(x, y));
    }
  }
  return image;
}
RgbImage even(const Colour& colour, int width = 12, int height = 9) {
  return painted(width, height, [&](int, int) { return colour; });
}
/// A pattern of multiples of 1/16, which are exact on every machine.
RgbImage pattern(int kind, int width = 30, int height = 20) {
  return painted(width, height, [&](int x, int y) {
    return Colour{static_cast<float>((7 * x + 3 * y + 5 * kind) % 16) / 16,
                  static_cast<float>((x / 5 + y / (4 + kind)) % 2) * 0.75f + 0.125f,
                  static_cast<float>((x * x + kind * y * y) % 16) / 16};
  });
}
double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(PictureQuality, EqualImagesArePerfect) {
  const RgbImage picture = pattern(0);
  EXPECT_EQ(likeness(picture, picture).psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(likeness(picture, picture).ssim, 1, 1e-12);
  EXPECT_EQ(energy_drift(picture, picture), 0);
  for (const float f : flip(picture, picture)) EXPECT_EQ(f, 0);
}

TEST(PictureQuality, UniformImagesEqualTheFormulas) {
  const double a = 0.5, b = 0.625, c1 = 1e-4;
  const Likeness grey = likeness(even({0.5f, 0.5f, 0.5f}), even({0.625f, 0.625f, 0.625f}));
  EXPECT_NEAR(grey.psnr_db, -20 * std::log10(b - a), 1e-9);
  EXPECT_NEAR(grey.ssim, (2 * a * b + c1) / (a * a + b * b + c1), 1e-9);
  // An error in one of three channels.
  EXPECT_NEAR(likeness(even({0.5f, 0.5f, 0.5f}), even({0.5f, 0.5f, 0.625f})).psnr_db,
              -20 * std::log10((b - a) / std::sqrt(3.0)), 1e-9);
  EXPECT_NEAR(energy_drift(even({0.5f, 1, 2}), even({0.5f, 0.5f, 1})), 0.75, 1e-12);
}

TEST(PictureQuality, ClipsToWhite) {
  EXPECT_EQ(likeness(even({3, 7, 1}), even({1, 1, 9})).psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(likeness(even({3, 3, 3}), even({0.5f, 0.5f, 0.5f})).psnr_db, -20 * std::log10(0.5), 1e-9);
}

TEST(PictureQuality, LowerContrastIsLostStructure) {
  // Pixels alternate about one brightness: the mean under the window is constant, the deviation changes.
  const auto chess = [](float swing) {
    return painted(40, 40, [&](int x, int y) {
      const float value = 0.5f + ((x + y) % 2 == 0 ? swing : -swing);
      return Colour{value, value, value};
    });
  };
  const double a = 0.25, b = 0.125, c2 = 9e-4;
  EXPECT_NEAR(likeness(chess(0.25f), chess(0.125f)).ssim, (2 * a * b + c2) / (a * a + b * b + c2), 2e-4);
  EXPECT_NEAR(likeness(chess(0.25f), chess(-0.25f)).ssim, (-2 * a * a + c2) / (2 * a * a + c2), 2e-4);
}

TEST(PictureQuality, CountsPixelsOfTheMask) {
  const RgbImage reference = even({0.5f, 0.5f, 0.5f}, 40, 20);
  RgbImage picture = reference;
  std::vector<unsigned char> left(800, 0), right(800, 0);
  for (std::size_t i = 0; i < 800; ++i) {
    const std::size_t column = i % 40;
    if (column == 30) picture.pixels[3 * i] = 0.75f;
    left[i] = column < 20, right[i] = column == 30;
  }
  EXPECT_EQ(likeness(picture, reference, left).psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(likeness(picture, reference, left).ssim, 1, 1e-12);
  EXPECT_NEAR(likeness(picture, reference, right).psnr_db, -20 * std::log10(0.25 / std::sqrt(3.0)), 1e-9);
  EXPECT_LT(likeness(picture, reference, right).ssim, 0.9);
}

// The formulas of the paper by dense two-dimensional filters in double.
TEST(Flip, UniformImagesEqualTheirColours) {
  const auto of = [](const Colour& a, const Colour& b) { return flip(even(a), even(b))[50]; };
  EXPECT_NEAR(of({0, 0, 0}, {1, 1, 1}), 0.96738, 2e-5);
  EXPECT_NEAR(of({0, 1, 0}, {0, 0, 1}), 1, 2e-5);  // the two most different colours
  EXPECT_NEAR(of({0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}), 0.45185, 2e-5);
  EXPECT_NEAR(of({1, 0, 0}, {0.75f, 0.125f, 0.0625f}), 0.53854, 2e-5);
}

TEST(Flip, PatternsEqualThePaper) {
  const std::vector<float> map = flip(pattern(0), pattern(1));
  EXPECT_NEAR(mean(map), 0.68957, 5e-5);
  EXPECT_NEAR(map[0], 0.67848, 5e-5);
  EXPECT_NEAR(map[15 * 30 + 20], 0.41538, 5e-5);
  EXPECT_NEAR(map[19 * 30 + 29], 0.97055, 5e-5);
  // Blue and yellow are filtered by two Gaussians.
  const RgbImage grey = even({0.5f, 0.5f, 0.5f}, 30, 20), stripes = painted(30, 20, [](int x, int) {
                                                            return Colour{0.5f, 0.5f, static_cast<float>(x / 3 % 2)};
                                                          });
  const std::vector<float> blue = flip(grey, stripes);
  EXPECT_NEAR(mean(blue), 0.31012, 5e-5);
  EXPECT_NEAR(blue[10 * 30 + 15], 0.19573, 5e-5);
}

TEST(Flip, IsSymmetric) { EXPECT_EQ(flip(pattern(0), pattern(1)), flip(pattern(1), pattern(0))); }

TEST(PictureQuality, RefusesPicturesOfDifferentSizes) {
  const RgbImage a = even({0, 0, 0}, 4, 3), b = even({0, 0, 0}, 3, 4);
  expect_error([&] { likeness(a, b); }, {4, 3});
  expect_error([&] { flip(a, b); }, {4, 3});
}

TEST(DepthEdges, ReachOneCircleOfConfusion) {
  // The left half is 2 m away, the right one 10 m; a lens of 400 mm is focused at 5 m.
  const petzval::LayerCamera camera = petzval::layer_camera(120, 60, petzval::radians(30.0));
  constexpr double radius = 200, focus = 5000, near = 2000, far = 10000;
  const petzval::LensRays rays = petzval::LensRays::thin(camera, {.radius_mm = radius, .inverse_focus = 1 / focus},
                                                         petzval::vogel_points(400), {.nearest_mm = 1000});
  const auto layers_of = [&](float right) {
    std::vector<float> rgba(120 * 60 * 4, 1), depth(120 * 60);
    for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = i % 120 < 60 ? static_cast<float>(near) : right;
    petzval::LayerSet layers;
    const petzval::LayerImage image{.columns = 120, .rows = 60, .rgba = rgba, .depth_mm = depth};
    layers.set({&image, 1});
    return layers;
  };
  const double circle = camera.focal_px * radius * std::max(1 / near - 1 / focus, 1 / focus - 1 / far);
  ASSERT_GT(circle, 6);
  const std::vector<unsigned char> mask = near_depth_edges(layers_of(static_cast<float>(far)), rays);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const double off = std::abs(static_cast<double>(i % 120) - 59.5);  // distance of the pixel from the edge
    if (std::abs(off - circle - 0.5) <= 1.5) continue;                 // partly covered pixels
    EXPECT_EQ(mask[i], off < circle) << i % 120 << ' ' << i / 120;
  }
  // Steps that rays can follow are not edges.
  const double follows = 0.9 / rays.largest_slope();
  for (const unsigned char m : near_depth_edges(layers_of(static_cast<float>(1 / (1 / near - follows))), rays)) {
    EXPECT_EQ(m, 0);
  }
}

TEST(PictureQuality, PlotNamesRaysAndPsnr) {
  const std::string svg =
      quality_plot({{750, 59.7}, {32, 39.3}, {64, std::numeric_limits<double>::infinity()}}, "town");
  for (const char* token : {"32", "750", "39.3", "59.7", "town"}) {
    EXPECT_TRUE(petzval::testing::has_token(svg, token)) << token;
  }
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_TRUE(quality_plot({}, "").starts_with("<svg"));
}

}  // namespace
