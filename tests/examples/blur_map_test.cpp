// SPDX-License-Identifier: Apache-2.0
#include "support/blur_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/error.hpp"
#include "petzval/pupil/f_number.hpp"
#include "support/point_scene.hpp"

namespace {

using examples::PointScene;
using petzval::ScenePoint;

const petzval::Plane table{{0.1, std::cos(0.3), std::sqrt(1 - 0.01 - std::cos(0.3) * std::cos(0.3))}, -300};

/// Points of a plane, spread over the image of a 100 mm lens.
std::vector<ScenePoint> places_of(const petzval::Plane& plane) {
  std::vector<ScenePoint> result;
  for (const auto& [x, z] :
       {std::pair{-0.1, -850.0}, {0.12, -900.0}, {0.0, -1000.0}, {-0.13, -1150.0}, {0.1, -1200.0}}) {
    const double across = x * -z;
    const petzval::Vec3<double>& n = plane.normal;
    result.push_back({{across, (plane.offset - n.x * across - n.z * z) / n.y, z}, false});
  }
  return result;
}

double at(const examples::BlurMap& map, const petzval::Film& film, double x, double y) {
  return map[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.columns) + static_cast<std::size_t>(x)];
}

TEST(PointScene, GoesThroughItsPoints) {
  const petzval::IdealLens lens = petzval::thick_lens(petzval::testing::data_lens("double_gauss_100mm_f2_28deg"));
  const petzval::Film film{.z_mm = 150};
  std::vector<ScenePoint> places = places_of(table);
  places.push_back({{80, 30, -2000}, false});
  places.push_back({{-0.05, 0.1, -1}, true});
  const PointScene scene(lens, places);
  for (const ScenePoint& place : places) {
    const auto point = examples::on_film(lens, film, place);
    ASSERT_TRUE(point);
    const auto found = scene.at(film, *point);
    ASSERT_TRUE(found);
    const double depth = lens.pupils.entrance.z - found->position.z;
    if (place.at_infinity) {
      EXPECT_TRUE(found->at_infinity || depth > 1e9);
      continue;
    }
    EXPECT_NEAR(found->position.x, place.position.x, 1e-6);
    EXPECT_NEAR(found->position.y, place.position.y, 1e-6);
    EXPECT_NEAR(found->position.z, place.position.z, 1e-5);
  }
}

TEST(PointScene, RequiresAPointInFrontOfTheLens) {
  const std::vector<ScenePoint> behind{{{0, 0, 100}, false}};
  EXPECT_THROW(PointScene(petzval::thin_lens(50, 2), behind), petzval::Error);
}

TEST(BlurMap, PlaneOfFocusIsSharpEverywhere) {
  const petzval::IdealLens lens = petzval::thin_lens(100, 4);
  const auto places = places_of(table);
  const PointScene scene(lens, places);
  petzval::Film film = examples::with_pixels(petzval::film_in(lens.image_of(table).value()), 180);
  const auto sharp = examples::blur_map(film, scene, lens, nullptr, 2);
  ASSERT_EQ(sharp.size(), 180u * 120u);
  for (const double y : {20.0, 60.0, 100.0}) {
    for (const double x : {20.0, 90.0, 160.0}) EXPECT_LT(std::abs(at(sharp, film, x, y)), 1e-4) << x << ' ' << y;
  }
  film = examples::with_pixels({.z_mm = lens.image(places[2])->position.z}, 180);
  const auto upright = examples::blur_map(film, scene, lens, nullptr, 2);
  EXPECT_GT(std::abs(at(upright, film, 90, 110)), 0.1);
  EXPECT_EQ(examples::blur_map(film, scene, lens, nullptr, 1), upright);
}

TEST(BlurMap, IsUprightAndSigned) {
  const petzval::IdealLens lens = petzval::thin_lens(50, 2);
  // Near at the lower left, far at the upper right.
  const std::vector<ScenePoint> places{{{-200, -150, -1000}, false}, {{600, 450, -3000}, false}};
  const petzval::Film film = examples::with_pixels({.z_mm = lens.image({{0, 0, -1500}, false})->position.z}, 360);
  const auto near = film.raster(*examples::on_film(lens, film, places[0]));
  const auto far = film.raster(*examples::on_film(lens, film, places[1]));
  EXPECT_LT(near[0], 180);
  EXPECT_GT(near[1], 120);
  EXPECT_GT(far[0], 180);
  EXPECT_LT(far[1], 120);
  const auto map = examples::blur_map(film, PointScene(lens, places), lens, nullptr, 1);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& place = i == 0 ? near : far;
    const double blur = petzval::signed_blur(*lens.image(places[i]), film);
    EXPECT_EQ(blur < 0, i == 0);
    EXPECT_NEAR(at(map, film, place.x, place.y), blur, 0.02 * std::abs(blur));
  }
}

TEST(BlurMap, ExactRaysAgreeWithTheThickLensStoppedDown) {
  const petzval::Lens lens = petzval::with_f_number(petzval::testing::data_lens("double_gauss_100mm_f2_28deg"), 32);
  const petzval::IdealLens thick = petzval::thick_lens(lens);
  const auto places = places_of(table);
  const PointScene scene(thick, places);
  const petzval::Film film = examples::with_pixels({.z_mm = thick.image(places[2])->position.z}, 90);
  const auto exact = examples::blur_map(film, scene, thick, &lens, 2);
  const auto ideal = examples::blur_map(film, scene, thick, nullptr, 2);
  double middle = 0, all = 0, largest = 0;
  for (int y = 0; y < film.rows; ++y) {
    for (int x = 0; x < film.columns; ++x) {
      const double off = std::abs(at(exact, film, x, y) - at(ideal, film, x, y));
      all = std::max(all, off);
      largest = std::max(largest, std::abs(at(ideal, film, x, y)));
      if (std::abs(x - 45) < 20 && std::abs(y - 30) < 14) middle = std::max(middle, off);
    }
  }
  EXPECT_GT(largest, 0.09);
  EXPECT_LT(middle, 0.01);
  EXPECT_LT(all, 0.03);  // curvature of field
}

TEST(BlurMap, ScaleCovers99PercentOfThePixels) {
  const std::vector<examples::BlurMap> maps{{0.012, -0.034}, {std::nan("")}, {0.012, -0.012}};
  EXPECT_DOUBLE_EQ(examples::scale_of(std::span(maps).last(1)), 0.02);
  EXPECT_DOUBLE_EQ(examples::scale_of(std::span(maps).first(2)), 0.02);  // the 99th percentile is the lower value
  EXPECT_DOUBLE_EQ(examples::scale_of(std::span(maps).subspan(1, 1)), 1e-3);
}

}  // namespace
