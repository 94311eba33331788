// SPDX-License-Identifier: Apache-2.0
#include "renderer/highlights.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace renderer {
namespace {

/// Discs of light on a uniform background, stretched across the radius or elongated along it.
petzval::RgbImage row_of_lights(double stretch, double comet, double background) {
  petzval::RgbImage image(650, 60);
  std::fill(image.pixels.begin(), image.pixels.end(), static_cast<float>(background));
  for (int ball = -6; ball <= 6; ++ball) {
    const double middle = 325 + 45.0 * ball, outwards = ball < 0 ? -1 : 1;
    const double share = std::abs(ball) / 6.0, tall = 1 + (stretch - 1) * share;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double dx = (x + 0.5 - middle) * outwards, dy = (y + 0.5 - 30) / tall;
        if (dx * dx + dy * dy > 100) continue;
        // Bright inside with a tail outwards: the first moment of a linear slope over the disc.
        const double value = 2 - comet * share * dx / 10;
        for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] += static_cast<float>(value);
      }
    }
  }
  return image;
}

TEST(Highlights, DiscsAreRound) {
  const auto found = ball_highlights(row_of_lights(1, 0, 0.1));
  ASSERT_EQ(found.size(), 13u);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_TRUE(found[i]);
    EXPECT_NEAR(found[i]->axis_ratio, 1, 0.03);
    EXPECT_NEAR(found[i]->outward_skewness, 0, 0.05);
    EXPECT_NEAR(found[i]->x, 325 + 45 * (static_cast<double>(i) - 6), 0.3);
    EXPECT_NEAR(found[i]->y, 30, 0.3);
  }
}

TEST(Highlights, HaveTheGivenAxesAndTails) {
  const auto found = ball_highlights(row_of_lights(1.4, 1, 0.3));
  ASSERT_EQ(found.size(), 13u);
  for (const std::size_t edge : {std::size_t{0}, std::size_t{12}}) {
    ASSERT_TRUE(found[edge]);
    EXPECT_NEAR(found[edge]->axis_ratio, 1.4, 0.08);
    EXPECT_NEAR(found[edge]->to_radius_deg, 90, 3);
    // A disc whose radiance falls from 3 inside to 1 outside has an outward tail on both sides.
    EXPECT_GT(found[edge]->outward_skewness, 0.1);
  }
  ASSERT_TRUE(found[6]);
  EXPECT_NEAR(found[6]->axis_ratio, 1, 0.03);
}

TEST(Highlights, IgnoreReflectionsOfOtherBalls) {
  petzval::RgbImage image = row_of_lights(1, 0, 0.1);
  for (int y = 28; y < 32; ++y) {
    for (int x = 341; x < 345; ++x) image.pixel(x, y)[0] = image.pixel(x, y)[1] = image.pixel(x, y)[2] = 3;
  }
  const auto found = ball_highlights(image);
  ASSERT_TRUE(found[6] && found[7]);
  EXPECT_NEAR(found[6]->axis_ratio, 1, 0.03);
  EXPECT_NEAR(found[6]->x, 325, 0.3);
  EXPECT_GT(found[6]->neighbour_light, 0.05);
  EXPECT_FALSE(found[6]->trusted());
  EXPECT_LT(found[7]->neighbour_light, 0.001);
  EXPECT_TRUE(found[7]->trusted());
}

TEST(Highlights, IgnoreSmallSpots) {
  petzval::RgbImage image(24, 24);
  for (int y = 11; y < 13; ++y) {
    for (int x = 10; x < 14; ++x) image.pixel(x, y)[0] = image.pixel(x, y)[1] = image.pixel(x, y)[2] = 3;
  }
  const auto found = highlight_in(image, 0, 23);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->trusted());
}

TEST(Highlights, DarkImagesHaveNoHighlights) {
  EXPECT_FALSE(highlight_in(petzval::RgbImage(40, 30), 0, 39));
  const auto none = ball_highlights(petzval::RgbImage(200, 30));
  for (const auto& h : none) EXPECT_FALSE(h);
  EXPECT_FALSE(highlight_in(petzval::RgbImage(2, 2), 0, 1));
}

}  // namespace
}  // namespace renderer
