// SPDX-License-Identifier: Apache-2.0
#include "renderer/path_colours.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <glm/glm.hpp>

namespace renderer {
namespace {

/// Mean image colour of a light, or of a surface in white light, over all paths.
glm::dvec3 seen(const PathColourSource& source, const Rgb& rgb, int bounces = 1) {
  constexpr int count = 20'000;
  glm::dvec3 sum(0);
  for (int i = 0; i < count; ++i) {
    const PathColours c = source.draw((static_cast<float>(i) + 0.5f) / count);
    Lanes value(1);
    for (int b = 0; b < bounces; ++b) value *= c.from_rgb * rgb;
    for (int lane = c.lanes; lane < 4; ++lane) value[lane] = 0;
    sum += glm::dvec3(c.to_rgb * value) / static_cast<double>(count);
  }
  return sum;
}

TEST(PathColours, EqualTheColoursOfLightsAndSurfaces) {
  for (const ColourMode mode : {ColourMode::d, ColourMode::rgb, ColourMode::hero}) {
    const PathColourSource source(mode);
    for (const Rgb& rgb :
         {Rgb(1, 1, 1), Rgb(1, 0, 0), Rgb(0, 1, 0), Rgb(0, 0, 1), Rgb(0.2f, 0.5f, 0.9f), Rgb(30, 20, 5)}) {
      const glm::dvec3 mean = seen(source, rgb);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c], rgb[c], 2e-3 * std::max({rgb.r, rgb.g, rgb.b})) << static_cast<int>(mode) << c;
    }
    const glm::dvec3 grey = seen(source, Rgb(0.5f, 0.5f, 0.5f), 3);  // stays grey after any number of scatterings
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(grey[c], 0.125, 5e-4);
  }
}

TEST(PathColours, ReflectancesAreBetween0And1) {
  const PathColourSource source(ColourMode::hero);
  for (int i = 0; i < 1000; ++i) {
    const PathColours c = source.draw(static_cast<float>(i) / 1000);
    ASSERT_EQ(c.lanes, 4);
    for (int lane = 0; lane < 4; ++lane) {
      float sum = 0;
      for (int primary = 0; primary < 3; ++primary) {
        EXPECT_GE(c.from_rgb[primary][lane], 0);
        EXPECT_LE(c.from_rgb[primary][lane], 1);
        sum += c.from_rgb[primary][lane];
      }
      EXPECT_NEAR(sum, 1, 1e-3);
      const float nm = c.nm[static_cast<std::size_t>(lane)];
      EXPECT_GE(nm, *std::min_element(source.compiled_nm().begin(), source.compiled_nm().end()));
      EXPECT_LE(nm, *std::max_element(source.compiled_nm().begin(), source.compiled_nm().end()));
    }
  }
}

TEST(PathColours, AnyLaneMayBeTheHero) {
  // Shifted by a quarter, the same wavelengths appear in another order.
  const PathColourSource source(ColourMode::hero);
  const PathColours a = source.draw(0.1f), b = source.draw(0.35f);
  for (std::size_t lane = 0; lane < 4; ++lane) EXPECT_NEAR(a.nm[(lane + 1) % 4], b.nm[lane], 0.01f);
  std::array<int, 3> heroes{};
  const PathColourSource triple(ColourMode::rgb);
  for (int i = 0; i < 300; ++i)
    ++heroes[static_cast<std::size_t>(triple.draw((static_cast<float>(i) + 0.5f) / 300).hero)];
  for (const int count : heroes) EXPECT_EQ(count, 100);
}

}  // namespace
}  // namespace renderer
