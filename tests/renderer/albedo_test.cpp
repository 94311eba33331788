// SPDX-License-Identifier: Apache-2.0
#include "renderer/albedo.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace {

using renderer::Albedo;
using renderer::Rgb;

TEST(Albedo, CheckerAlternatesBetweenCubes) {
  Albedo albedo{.colour = {1, 0, 0}, .checker = Albedo::Checker{{0, 1, 0}, 10}};
  for (const glm::vec3 axis : {glm::vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    for (int cube = -5; cube <= 5; ++cube) {
      for (const float inside : {-4.7f, 0.0f, 4.7f}) {
        const glm::vec3 point = axis * (10.0f * static_cast<float>(cube) + inside) + glm::vec3(0.1f, -0.2f, 0.05f);
        EXPECT_EQ(renderer::at(albedo, point, {}), cube % 2 == 0 ? Rgb(1, 0, 0) : Rgb(0, 1, 0))
            << cube << " " << inside;
      }
    }
  }
}

TEST(Albedo, ImageIsUprightAndRepeated) {
  auto image = std::make_shared<petzval::RgbImage>(4, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x) image->pixel(x, y)[0] = 0.1f * static_cast<float>(x + 4 * y);
  const Albedo albedo{.image = image};
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / 4, v = (1.5f - static_cast<float>(y)) / 2;
      for (const float turn : {-3.0f, 0.0f, 7.0f})
        EXPECT_NEAR(renderer::at(albedo, {}, {u + turn, v - turn}).r, image->pixel(x, y)[0], 1e-5f) << x << " " << y;
    }
  }
  // Between the last and the first column, in the upper row.
  EXPECT_NEAR(renderer::at(albedo, {}, {0, 0.75f}).r, 0.15f, 1e-5f);
}

TEST(Albedo, ImageIsClampedTo0To1) {
  auto image = std::make_shared<petzval::RgbImage>(1, 1);
  image->pixel(0, 0)[0] = 3, image->pixel(0, 0)[1] = -1, image->pixel(0, 0)[2] = 0.5f;
  EXPECT_EQ(renderer::at({.image = image}, {}, {0.3f, 0.9f}), Rgb(1, 0, 0.5f));
}

}  // namespace
