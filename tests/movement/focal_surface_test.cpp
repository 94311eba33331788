// SPDX-License-Identifier: Apache-2.0
#include "petzval/movement/focal_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "petzval/core/error.hpp"

namespace {

using namespace petzval;

const IdealLens lens = thin_lens(50, 2);
const Film film{.z_mm = 50 + 50 * 50 / 1950.0};  // focused at 2 m

TEST(FocalSurface, MeetsItsPoints) {
  const std::vector<FocalPoint> points{{.place = {-9, 0}, .inverse_distance = 1 / 1500.0},
                                       {.place = {9, 2}, .inverse_distance = 1 / 4000.0, .extent_stops = -1},
                                       {.place = {1, 5}, .extent_stops = 3},
                                       {.place = {0, -8}, .inverse_distance = 0, .extent_stops = 2}};
  const FocalSurface surface(lens, film, points);
  EXPECT_EQ(surface.origin_z(), 0);
  for (const auto& point : points) {
    const auto values = surface.at(point.place);
    EXPECT_EQ(values.inverse_distance, point.inverse_distance.value_or(values.inverse_distance));
    EXPECT_EQ(values.extent_stops, point.extent_stops.value_or(values.extent_stops));
    EXPECT_EQ(values.blur_mm, 0);
  }
}

TEST(FocalSurface, PassesBlurredPointsByTheBlurOfTheLens) {
  for (const double stops : {0.0, 2.0}) {
    for (const double blur : {-0.1, 0.2}) {
      const double object = 1 / 2500.0;
      const std::vector<FocalPoint> points{
          {.place = {3, 4}, .inverse_distance = object, .blur_mm = blur, .extent_stops = stops},
          {.place = {-3, 4}, .inverse_distance = 1 / 2000.0}};
      const FocalSurface surface(lens, film, points);
      const auto values = surface.at({3, 4});
      EXPECT_NEAR(values.blur_mm, blur, 1e-14);
      // The film that the surface stands for: the thin lens, stopped down, focused there.
      const double focused = 1 / values.inverse_distance;
      const IdealLens stopped = thin_lens(50, 2 * std::exp2(stops / 2));
      const auto image = stopped.image({{0, 0, -1 / object}});
      const double found = signed_blur(*image, {.z_mm = 50 + 2500 / (focused - 50)});
      // Of the same picture: the blur grows with the distance of the film.
      EXPECT_NEAR(found * film.z() / (50 + 2500 / (focused - 50)), blur, 1e-12);
    }
  }
}

TEST(FocalSurface, WithoutDistancesIsWhereTheFilmIsFocused) {
  const std::vector<FocalPoint> points{{.place = {1, 5}, .extent_stops = 3}};
  const FocalSurface surface(lens, film, points);
  EXPECT_NEAR(surface.at({7, 7}).inverse_distance, 1 / 2000.0, 1e-15);
  EXPECT_EQ(surface.at({7, 7}).extent_stops, 3);
  EXPECT_EQ(FocalSurface(lens, {.z_mm = 50}, points).at({7, 7}).inverse_distance, 0);
}

}  // namespace
