// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture_sums.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "../expect_error.hpp"
#include "made_up_sums.hpp"

namespace {

using namespace renderer;
using petzval::testing::expect_error;

constexpr int width = 40, height = 35;  // 3 x 3 tiles, clipped at the edges

TEST(PictureSums, TilesCoverEachPixelOnce) {
  const PictureSums sums(width, height);
  EXPECT_EQ(sums.tile_columns(), 3u);
  EXPECT_EQ(sums.tile_rows(), 3u);
  std::vector<int> seen(static_cast<std::size_t>(width * height));
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    const PixelBlock b = sums.block(t);
    for (int y = b.y; y < b.y + b.height; ++y) {
      for (int x = b.x; x < b.x + b.width; ++x) ++seen[static_cast<std::size_t>(y * width + x)];
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), width * height);
}

TEST(PictureSums, BitsAreIndependentOfTheOrder) {
  const PictureSums forwards = made_up_part(width, height, 1, 1, 20);
  PictureSums backwards(width, height);
  std::mt19937 random(3);
  for (std::size_t t = backwards.tiles(); t-- > 0;) {
    for (std::uint32_t pass = 0; pass < 20; ++pass) {
      std::vector<Contribution> unit = made_up_unit(backwards, t, pass);
      std::shuffle(unit.begin(), unit.end(), random);
      backwards.add(t, pass % PictureSums::rounds, 3, unit);
    }
  }
  EXPECT_EQ(backwards, forwards);
  EXPECT_EQ(backwards.picture().pixels, forwards.picture().pixels);
  EXPECT_NE(made_up_part(width, height, 1, 1, 19), forwards);
}

TEST(PictureSums, RefuseOtherSizesAndRepeatedTiles) {
  PictureSums sums = made_up_part(width, height, 1, 3, 1);
  const PictureSums before = sums;
  expect_error([&] { sums.add(PictureSums(width, height + 1)); }, {40, 36, 35});
  const std::size_t last[] = {6};
  expect_error([&] { sums.add(made_up_sums(width, height, last, 1)); }, {"tile 6"});
  EXPECT_EQ(sums, before);
}

TEST(PictureSums, IgnoreInvalidRadiance) {
  PictureSums sums(width, height);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  sums.add(0, 0, 1,
           std::vector<Contribution>{
               {0, {std::nanf(""), 1, 1}}, {0, {1, -infinity, 1}}, {0, {1, 1, 0x1p40f}}, {0, {1, 2, -3}}});
  EXPECT_EQ(sums.rejected(), 3u);
  EXPECT_EQ(sums.picture().pixel(0, 0)[1], 2);
  EXPECT_EQ(sums.picture().pixel(0, 0)[2], -3);
  PictureSums both(width, height);
  both.add(8, 0, 1, std::vector<Contribution>{{0, {0, 0, infinity}}});
  both.add(sums);
  EXPECT_EQ(both.rejected(), 4u);
}

TEST(PictureSums, PixelIsItsSumOverItsSamples) {
  PictureSums sums(width, height);
  sums.add(0, 0, 4, std::vector<Contribution>{{1, {8, 0, 0}}, {static_cast<std::uint32_t>(width - 1), {3, 0, 0}}});
  EXPECT_EQ(sums.picture().pixel(1, 0)[0], 2);
  EXPECT_EQ(sums.picture().pixel(width - 1, 0)[0], 0) << "a tile without samples";
  sums.add(2, 1, 6, {});
  EXPECT_EQ(sums.picture().pixel(width - 1, 0)[0], 0.5f);
  EXPECT_EQ(sums.samples(2), 6u);
  EXPECT_EQ(sums.samples(2, 1), 6u);
  EXPECT_EQ(sums.samples(2, 0), 0u);
}

/// Film samples are divided by the samples of their tile, light paths by their number per pixel of the picture.
TEST(PictureSums, LightIsDividedByTheLightPathsOfThePicture) {
  using Of = PictureSums::Of;
  PictureSums sums(32, 16);
  sums.add(0, 0, 4, std::vector<Contribution>{{0, {8, 0, 0}}});
  sums.add(1, 0, 2, std::vector<Contribution>{{16, {8, 0, 0}}});
  sums.add(0, 0, 6, std::vector<Contribution>{{0, {3, 0, 0}}, {16, {30, 0, 0}}}, Of::light);
  EXPECT_EQ(sums.light_paths(), 3);
  EXPECT_EQ(sums.picture().pixel(0, 0)[0], 2 + 1);
  EXPECT_EQ(sums.picture().pixel(16, 0)[0], 4 + 10);
  EXPECT_EQ(sums.samples(0, Of::light), 6u);
  EXPECT_EQ(sums.mean()[0].mean, (3 + 14) / 512.0);
}

/// Means of pixels over the samples of the tile, and of luminance over the area of the tile, which is smaller at edges.
TEST(PictureSums, MeansArePlainMeans) {
  constexpr std::uint32_t passes = 5;
  constexpr double samples = 1 + 2 + 1 + 2 + 1;
  PictureSums sums(width, height);
  std::vector<double> area(sums.tiles()), luminance(area), luminance_size(area);
  std::array<double, 3> total{}, size{};
  std::vector<std::array<double, 3>> pixels(static_cast<std::size_t>(width * height));
  std::mt19937 random(4);
  std::uniform_real_distribution<float> light(-1, 3);
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    for (std::size_t t = 0; t < sums.tiles(); ++t) {
      std::vector<Contribution> unit(300);
      for (auto& [pixel, rgb] : unit) {
        pixel = static_cast<std::uint32_t>(random() % pixels.size());
        const std::size_t fallen_on = pixel / width / 16 * sums.tile_columns() + pixel % width / 16;
        for (std::size_t c = 0; c < 3; ++c) {
          rgb[c] = light(random);
          const double value = static_cast<double>(rgb[c]), weighted = std::array{0.2126, 0.7152, 0.0722}[c] * value;
          pixels[pixel][c] += value;
          total[c] += value;
          size[c] += std::abs(value);
          luminance[fallen_on] += weighted;
          luminance_size[fallen_on] += std::abs(weighted);
        }
      }
      sums.add(t, pass, 1 + pass % 2, unit);
    }
  }
  const petzval::RgbImage picture = sums.picture();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      area[static_cast<std::size_t>(y / 16) * sums.tile_columns() + static_cast<std::size_t>(x / 16)] += 1;
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_FLOAT_EQ(picture.pixel(x, y)[c],
                        static_cast<float>(pixels[static_cast<std::size_t>(y * width + x)][c] / samples));
      }
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const double all = samples * width * height;
    EXPECT_NEAR(sums.mean()[c].mean, total[c] / all, size[c] / all * 1e-12);
  }
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    const double all = samples * area[t];
    EXPECT_NEAR(sums.luminance(t).mean, luminance[t] / all, luminance_size[t] / all * 1e-6) << t;
  }
}

/// Fewer or more passes than rounds, with different numbers of samples.
TEST(PictureSums, StandardErrorsFollowTheSamplesOfEachRound) {
  constexpr int runs = 4000;
  constexpr double spread = 0.25;
  std::mt19937 random(7);
  std::normal_distribution<float> light(1, spread);
  for (const std::size_t passes : {3u, 16u, 40u}) {
    double squares = 0, samples = 0;
    for (int run = 0; run < runs; ++run) {
      PictureSums sums(1, 1);
      for (std::size_t pass = 0; pass < passes; ++pass) {
        std::vector<Contribution> unit(4 + pass % 2);
        for (Contribution& own : unit) own.rgb.fill(light(random));
        sums.add(0, pass % PictureSums::rounds, static_cast<std::uint32_t>(unit.size()), unit);
      }
      const double error = sums.mean()[0].standard_error;
      ASSERT_NEAR(sums.luminance(0).standard_error, error, 1e-6);
      squares += error * error;
      samples = static_cast<double>(sums.samples(0));
    }
    // Four standard errors of a variance with so many degrees of freedom; 1 % for unequal rounds.
    const double freedom = runs * static_cast<double>(std::min(passes, PictureSums::rounds) - 1);
    EXPECT_NEAR(squares / runs / (spread * spread / samples), 1, 4 * std::sqrt(2 / freedom) + 0.01) << passes;
  }
}

TEST(PictureSums, StandardErrorsOfOneRoundAreNan) {
  PictureSums sums(width, height);
  EXPECT_EQ(sums.mean()[0].mean, 0);
  EXPECT_TRUE(std::isnan(sums.mean()[0].standard_error));
  sums.add(0, 0, 5, std::vector<Contribution>{{0, {1, 1, 1}}});
  EXPECT_EQ(sums.mean()[0].mean, 1.0 / (5 * 16 * 16));
  EXPECT_TRUE(std::isnan(sums.mean()[0].standard_error));
  EXPECT_TRUE(std::isnan(sums.luminance(3).standard_error));
}

}  // namespace
