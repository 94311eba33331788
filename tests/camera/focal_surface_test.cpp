// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/focal_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "petzval/core/error.hpp"

namespace focal_surface_test {

using namespace petzval;
using petzval::testing::expect_error;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

const IdealLens lens = thin_lens(50, 2);
const Film film{.z_mm = 50 + 50 * 50 / 1950.0};  // focused at 2 m

/// Both kinds with weights of several powers.
std::vector<FocalSurfaceOptions> every_kind() {
  std::vector<FocalSurfaceOptions> result;
  for (const double beta : {1.0, 2.0, 2.5, 3.0, 4.0, 5.3, 8.0}) {
    for (const SurfaceKind kind : {SurfaceKind::affine, SurfaceKind::shepard}) result.push_back({kind, beta});
  }
  return result;
}

TEST(FocalSurface, PassesThroughItsPoints) {
  const std::vector<FocalPoint> points{{.film_point = {-9, 0}, .inverse_distance = 1 / 1500.0},
                                       {.film_point = {9, 2}, .inverse_distance = 1 / 4000.0, .extent_stops = -1},
                                       {.film_point = {1, 5}, .extent_stops = 3},
                                       {.film_point = {0, -8}, .inverse_distance = 0, .extent_stops = 2}};
  for (const FocalSurfaceOptions& options : every_kind()) {
    const FocalSurface surface(lens, film, points, options);
    EXPECT_EQ(surface.origin_z(), 0);
    for (const auto& point : points) {
      const auto values = surface.at(point.film_point);
      EXPECT_EQ(values.inverse_distance, point.inverse_distance.value_or(values.inverse_distance));
      EXPECT_EQ(values.extent_stops, point.extent_stops.value_or(values.extent_stops));
      EXPECT_EQ(values.blur_mm, 0);
    }
  }
}

TEST(FocalSurface, MissesBlurredPointsByTheirBlur) {
  for (const double stops : {0.0, 2.0}) {
    for (const double blur : {-0.1, 0.2}) {
      const double object = 1 / 2500.0;
      const std::vector<FocalPoint> points{
          {.film_point = {3, 4}, .inverse_distance = object, .blur_mm = blur, .extent_stops = stops},
          {.film_point = {-3, 4}, .inverse_distance = 1 / 2000.0}};
      const FocalSurface surface(lens, film, points);
      const auto values = surface.at({3, 4});
      EXPECT_NEAR(values.blur_mm, blur, 1e-14);
      // The equivalent plain camera: the thin lens, stopped down, focused on the surface.
      const double focused = 1 / values.inverse_distance;
      const IdealLens stopped = thin_lens(50, 2 * std::exp2(stops / 2));
      const auto image = stopped.image({{0, 0, -1 / object}});
      const double found = signed_blur(*image, {.z_mm = 50 + 2500 / (focused - 50)});
      // Divided by the image distance, because the blur grows with the distance of the film.
      EXPECT_NEAR(found * film.z() / (50 + 2500 / (focused - 50)), blur, 1e-12);
    }
  }
}

TEST(FocalSurface, WithoutDistancesKeepsTheFocusOfTheFilm) {
  const std::vector<FocalPoint> points{{.film_point = {1, 5}, .extent_stops = 3}};
  const FocalSurface surface(lens, film, points);
  EXPECT_NEAR(surface.at({7, 7}).inverse_distance, 1 / 2000.0, 1e-15);
  EXPECT_EQ(surface.at({7, 7}).extent_stops, 3);
  EXPECT_EQ(FocalSurface(lens, {.z_mm = 50}, points).at({7, 7}).inverse_distance, 0);
  // 0.1 mm behind the image of 2 m; computed with 40 digits.
  const Film behind{.z_mm = 50 * 2000 / 1950.0 + 0.1};
  EXPECT_NEAR(FocalSurface(lens, behind, points).at({0, 0}).inverse_distance, 0.53795099555866061e-3, 1e-16);
}

std::vector<FocalPoint> random_points(unsigned seed, std::size_t count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<FocalPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    FocalPoint& point = points.emplace_back();
    point.film_point = {18 * unit(random), 12 * unit(random)};
    if (i % 3 != 1) point.inverse_distance = 1e-3 * std::abs(unit(random));
    if (i % 3 != 2) point.extent_stops = 4 * unit(random);
    point.weight = 0.1 + std::abs(unit(random));
  }
  return points;
}

TEST(FocalSurface, IndependentOfPointOrderAndScaleOfWeights) {
  const auto points = random_points(1, 17);
  auto turned = std::vector(points.rbegin(), points.rend()), heavy = points, faded = points;
  for (auto& point : heavy) point.weight *= 1e7;
  for (auto& point : faded) point.fade = 0.3;
  const FocalSurface surface(lens, film, points);
  for (const auto& other : {turned, heavy, faded}) {
    const FocalSurface same(lens, film, other);
    for (const auto& at : random_points(2, 100)) {
      const auto a = surface.at(at.film_point), b = same.at(at.film_point);
      EXPECT_NEAR(a.inverse_distance, b.inverse_distance, 1e-15);
      EXPECT_NEAR(a.extent_stops, b.extent_stops, 1e-12);
    }
  }
}

TEST(FocalSurface, RotatesAndScalesWithTheImage) {
  const auto points = random_points(3, 9);
  const double scale = 3, cosine = std::cos(0.7), sine = std::sin(0.7);
  const auto moved = [&](const FilmPoint& p) {
    return FilmPoint{scale * (cosine * p.x - sine * p.y), scale * (sine * p.x + cosine * p.y)};
  };
  auto large = points;
  for (auto& point : large) point.film_point = moved(point.film_point);
  const IdealLens large_lens = thin_lens(150, 2);
  const Film large_film{.width_mm = 72, .height_mm = 108, .z_mm = 3 * *film.z_mm};
  // Near faded points the distance scales with the size of the image.
  for (const double fade : {1.0, 0.2}) {
    auto from = points;
    from[0].fade = large[0].fade = fade;
    const FocalSurface surface(lens, film, from), other(large_lens, large_film, large);
    for (const auto& at : random_points(4, 100)) {
      const auto a = surface.at(at.film_point), b = other.at(moved(at.film_point));
      EXPECT_NEAR(a.inverse_distance, b.inverse_distance, 1e-14);
      EXPECT_NEAR(a.extent_stops, b.extent_stops, 1e-11);
    }
  }
}

TEST(FocalSurface, ReproducesThePlaneOfFocusOfATiltedFilm) {
  // Through the entrance pupil of a thin lens, 1 / distance over an upright picture is linear on a plane of the scene.
  const double z = *film.z_mm;
  const auto inverse = [&](const FilmPoint& p) { return 5e-4 + 2e-5 * p.x / z * 50 - 1e-5 * p.y; };
  std::vector<FocalPoint> points;
  for (const FilmPoint at : {FilmPoint{-10, -8}, FilmPoint{12, -3}, FilmPoint{2, 9}, FilmPoint{-5, 5}}) {
    points.push_back({.film_point = at, .inverse_distance = inverse(at)});
  }
  for (const FocalSurfaceOptions& options : every_kind()) {
    if (options.kind != SurfaceKind::affine) continue;
    const FocalSurface surface(lens, film, points, options);
    const double rounding = options.beta <= 4 ? 1e-15 : 1e-13;
    for (const auto& at : random_points(5, 50)) {
      EXPECT_NEAR(surface.at(at.film_point).inverse_distance, inverse(at.film_point), rounding) << options.beta;
      const auto slopes = surface.slopes(at.film_point);
      EXPECT_NEAR(slopes.inverse_distance.x, 2e-5 / z * 50, rounding) << options.beta;
      EXPECT_NEAR(slopes.inverse_distance.y, -1e-5, rounding) << options.beta;
    }
  }
}

TEST(FocalSurface, IsContinuousWhereAPointVanishes) {
  auto points = random_points(6, 9);
  const FilmPoint node = points[0].film_point;
  auto without = points;
  without.erase(without.begin());
  const FocalSurface gone(lens, film, without);
  for (const bool by_weight : {true, false}) {
    // At the point itself and next to it, in equal steps of the logarithm.
    for (const FilmPoint at : {node, FilmPoint{node.x + 0.01, node.y}, FilmPoint{node.x + 1, node.y - 1}}) {
      double last = nan, largest_step = 0;
      for (double share = 1; share > 1e-12; share *= 0.98) {
        points[0].weight = by_weight ? share : 1;
        points[0].fade = by_weight ? 1 : share;
        const double value = FocalSurface(lens, film, points).at(at).inverse_distance;
        if (!std::isnan(last)) largest_step = std::max(largest_step, std::abs(value - last));
        last = value;
      }
      EXPECT_NEAR(last, gone.at(at).inverse_distance, 1e-11);
      EXPECT_LT(largest_step, 4e-5);  // of 1e-3
    }
  }
}

// A plane through three points is independent of their weights. Nevertheless the surface must be continuous while the
// fade or the weight of a point goes to 0, in both precisions.
TEST(FocalSurface, IsContinuousWherePointsBecomeCollinear) {
  const auto value = [&](double fade, double weight, const FilmPoint& place) {
    const FocalPoint points[]{{.film_point = {-9, 0}, .inverse_distance = 1 / 1500.0},
                              {.film_point = {0, -8}, .inverse_distance = 0},
                              {.film_point = {9, 2}, .inverse_distance = 1 / 2500.0, .weight = weight, .fade = fade}};
    const FocalSurface surface(lens, film, points);
    const float x = static_cast<float>(place.x), y = static_cast<float>(place.y);
    float in_float = 0;
    surface.at(1, &x, &y, &in_float, static_cast<float*>(nullptr));
    const double result = surface.at(place).inverse_distance;
    EXPECT_NEAR(static_cast<double>(in_float), result, 1e-6) << fade << ", " << weight;
    return result;
  };
  for (const FilmPoint place : {FilmPoint{9, 8}, {9, 2}, {-3, 5}}) {
    for (const bool by_fade : {true, false}) {
      const auto at = [&](double amount) { return by_fade ? value(amount, 1, place) : value(1, amount, place); };
      // In steps of 5 % from 1 to 0.
      double before = at(1);
      for (double amount = 0.95; amount > 1e-12; amount *= 0.95) {
        const double now = at(amount);
        EXPECT_LT(std::abs(now - before), 0.06 / 1500) << amount;
        before = now;
      }
      EXPECT_NEAR(before, at(0), 1e-9);
    }
  }
}

// The points lie next to a line.
TEST(FocalSurface, FloatEqualsDoubleNextToCollinearPoints) {
  for (const double beside : {1.0, 0.6, 0.3, 0.1, 0.02, 1e-4}) {
    const FocalPoint points[]{{.film_point = {-9, 0}, .inverse_distance = 1 / 1500.0},
                              {.film_point = {0, beside}, .inverse_distance = 1 / 3000.0},
                              {.film_point = {9, 0}, .inverse_distance = 1 / 2000.0}};
    const FocalSurface surface(lens, film, points);
    for (const FilmPoint place : {FilmPoint{4, 9}, {-12, -7}, {1, 1}}) {
      const float x = static_cast<float>(place.x), y = static_cast<float>(place.y);
      float in_float = 0;
      surface.at(1, &x, &y, &in_float, static_cast<float*>(nullptr));
      EXPECT_NEAR(static_cast<double>(in_float), surface.at(place).inverse_distance, 3e-7) << beside;
    }
  }
}

TEST(FocalSurface, FloatEqualsDoubleForSteepWeights) {
  for (const double beta : {1.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
    for (unsigned seed = 0; seed < 60; ++seed) {
      const FocalSurface surface(lens, film, random_points(seed, 3 + seed % 8), {.beta = beta});
      std::vector<float> x, y;
      for (std::size_t i = 0; i < 200; ++i) {
        const auto [u, v] = petzval::testing::Kronecker<2>()(i);
        x.push_back(static_cast<float>(36 * (u - 0.5))), y.push_back(static_cast<float>(24 * (v - 0.5)));
      }
      std::vector<float> in_float(x.size());
      surface.at<float>(x.size(), x.data(), y.data(), in_float.data(), nullptr);
      for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(in_float[i]), surface.at({x[i], y[i]}).inverse_distance,
                    2e-4 * (surface.nearest() - surface.farthest()))
            << beta << ' ' << seed;
      }
    }
  }
}

void expect_equal_batches(const FocalSurface& surface) {
  const Film raster{.columns = 37, .rows = 23, .z_mm = 50};
  const std::size_t count = 37 * 23;
  std::vector<double> x, y, distances(count), extents(count), frame(count), frame_extents(count);
  for (int r = 0; r < 23; ++r) {
    for (int c = 0; c < 37; ++c) {
      const FilmPoint at = raster.point(c + 0.5, r + 0.5);
      x.push_back(at.x), y.push_back(at.y);
    }
  }
  surface.at(count, x.data(), y.data(), distances.data(), extents.data());
  for (const int threads : {1, 3}) {
    surface.frame(raster, threads, frame.data(), frame_extents.data());
    EXPECT_EQ(frame, distances);
    EXPECT_EQ(frame_extents, extents);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto single = surface.at({x[i], y[i]});
    EXPECT_EQ(single.inverse_distance, distances[i]);
    EXPECT_EQ(single.extent_stops, extents[i]);
  }
  // Float results agree up to rounding.
  const std::vector<float> xf(x.begin(), x.end()), yf(y.begin(), y.end());
  std::vector<float> in_float(count);
  surface.at<float>(count, xf.data(), yf.data(), in_float.data(), nullptr);
  for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(in_float[i], distances[i], 1e-8);
}

class FocalSurfaces : public ::testing::TestWithParam<FocalSurfaceOptions> {};

INSTANTIATE_TEST_SUITE_P(FocalSurface, FocalSurfaces, ::testing::ValuesIn(every_kind()));

TEST_P(FocalSurfaces, BatchesAndFramesEqualSingleFilmPoints) {
  for (const std::size_t points : {2, 13, 64, 200})
    expect_equal_batches({lens, film, random_points(7, points), GetParam()});
}

TEST(FocalSurface, StaysWithinItsLimits) {
  const auto points = random_points(8, 5);
  const FocalSurface surface(lens, film, points);
  double least = infinity, most = -infinity;
  for (const auto& point : points) {
    if (!point.inverse_distance) continue;
    least = std::min(least, *point.inverse_distance), most = std::max(most, *point.inverse_distance);
  }
  EXPECT_NEAR(surface.nearest(), most + (most - least), 1e-18);
  EXPECT_NEAR(surface.farthest(), least - (most - least), 1e-18);
  for (const double x : {-1e300, -1e5, 0.0, 300.0, 1e9, infinity, -infinity, nan}) {
    for (const double y : {-1e300, 2.0, 1e4, infinity, nan}) {
      const auto values = surface.at({x, y});
      EXPECT_GE(values.inverse_distance, surface.farthest());
      EXPECT_LE(values.inverse_distance, surface.nearest());
      EXPECT_GE(values.extent_stops, surface.least_extent());
      EXPECT_LE(values.extent_stops, surface.most_extent());
      const auto slopes = surface.slopes({x, y});
      EXPECT_TRUE(std::isfinite(slopes.inverse_distance.x + slopes.extent_stops.y));
    }
  }
  // Extrapolated points on a slope towards the lens stay outside the front focal length.
  const std::vector<FocalPoint> steep{{.film_point = {0, 0}, .inverse_distance = 0},
                                      {.film_point = {1, 0}, .inverse_distance = 1 / 52.0}};
  const FocalSurface near(lens, film, steep);
  EXPECT_TRUE(lens.image({{0, 0, -1 / near.at({10, 0}).inverse_distance}}));
}

TEST(FocalSurface, RefusesInvalidPoints) {
  const FocalPoint good{.film_point = {0, 0}, .inverse_distance = 1e-3, .extent_stops = 0};
  const auto surface = [](const FocalPoint& second) {
    return [second] {
      FocalSurface(lens, film, std::vector{FocalPoint{.film_point = {1, 1}, .inverse_distance = 1e-3}, second});
    };
  };
  EXPECT_NO_THROW(surface(good)());
  const auto with = [&](auto member, double value) {
    FocalPoint point = good;
    point.*member = value;
    return surface(point);
  };
  using P = FocalPoint;
  expect_error(with(&P::inverse_distance, nan), {"focal surface", "point 2", "distance", "nan"});
  expect_error(with(&P::inverse_distance, 1 / 50.0), {"focal surface", "point 2", "entrance pupil", 50});
  expect_error(with(&P::inverse_distance, infinity), {"focal surface", "point 2", "entrance pupil", 0});
  expect_error(with(&P::blur_mm, infinity), {"focal surface", "point 2", "blur", "inf"});
  expect_error(with(&P::blur_mm, 40), {"focal surface", "point 2", "blur", 40});
  expect_error(with(&P::extent_stops, 21), {"focal surface", "point 2", "extent", 21});
  expect_error(with(&P::weight, -1), {"focal surface", "point 2", "weight", -1});
  expect_error(with(&P::fade, 1.5), {"focal surface", "point 2", "fade", 1.5});
  expect_error(with(&P::fade, nan), {"focal surface", "point 2", "fade", "nan"});
  expect_error(surface({.film_point = {nan, 0}, .inverse_distance = 1e-3}),
               {"focal surface", "point 2", "film point", "nan", 0});
  const auto points = std::vector{good};
  const auto weightless = std::vector{FocalPoint{.inverse_distance = 1e-3, .weight = 0}, FocalPoint{}};
  expect_error(surface({.film_point = {1, 1e8}, .inverse_distance = 1e-3}),
               {"focal surface", "point 2", "film point", 1e8});
  expect_error([&] { FocalSurface(lens, film, {}); }, {"focal surface", "points", 0});
  expect_error([&] { FocalSurface(lens, film, weightless); }, {"focal surface", "points", 2});
  expect_error([&] { FocalSurface(lens, film, points, {.beta = 0.9}); }, {"focal surface", "beta", 0.9});
  expect_error([&] { FocalSurface(lens, film, points, {.beta = nan}); }, {"focal surface", "beta", "nan"});
  expect_error([&] { FocalSurface(lens, {.width_mm = 0, .z_mm = 50}, points); }, {"focal surface", "film", 0});
  expect_error([&] { FocalSurface(lens, {}, points); }, {"film", "z_mm"});
  IdealLens telecentric = lens;
  telecentric.pupils.entrance.z = infinity;
  expect_error([&] { FocalSurface(telecentric, film, points); }, {"entrance pupil", "infinity"});
}

// For any points, values are finite and within the limits, or the points are refused.
TEST(FocalSurface, IsFiniteForAnyPoints) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto one_of = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    const int count = round % 50 == 0 ? 3000 : 1 + one_of(12), shape = one_of(4);
    const bool spoiled = one_of(8) == 0;
    std::vector<FocalPoint> points;
    for (int i = 0; i < count; ++i) {
      const double t = unit(random);
      FocalPoint point;
      point.film_point = shape == 0   ? FilmPoint{18 * t, 12 * unit(random)}
                         : shape == 1 ? FilmPoint{18 * t, -7 * t + 1}  // on a line
                         : shape == 2
                             ? FilmPoint{double(one_of(2)), 3}                                  // at two positions
                             : FilmPoint{5 + 1e-9 * t, std::ldexp(unit(random), -one_of(60))};  // nearly coincident
      if (one_of(4)) point.inverse_distance = one_of(5) ? 1e-3 * std::abs(unit(random)) : 0;
      if (one_of(2)) point.extent_stops = 20 * unit(random);
      if (!one_of(4)) point.blur_mm = 0.05 * unit(random);
      point.weight = one_of(6) ? std::ldexp(1, one_of(200) - 100) : 0;
      point.fade = one_of(6) ? std::abs(unit(random)) : 0;
      points.push_back(point);
    }
    if (spoiled) {
      FocalPoint& point = points[static_cast<std::size_t>(one_of(count))];
      double* const numbers[] = {&point.film_point.x, &point.film_point.y, &point.weight, &point.fade, &point.blur_mm};
      *numbers[one_of(5)] = one_of(2) ? nan : infinity;
    }
    const FocalSurfaceOptions options{.kind = one_of(2) ? SurfaceKind::affine : SurfaceKind::shepard,
                                      .beta = one_of(2) ? 1 + one_of(8) : 1 + 7 * std::abs(unit(random))};
    std::optional<FocalSurface> surface;
    try {
      surface.emplace(lens, film, points, options);
    } catch (const Error&) {
      ++refused;
      continue;
    }
    ASSERT_FALSE(spoiled) << round;
    std::vector<float> x, y;
    for (int i = 0; i < 40; ++i) {
      const FilmPoint node = points[static_cast<std::size_t>(one_of(count))].film_point;
      const double away = std::ldexp(1, -one_of(70));
      x.push_back(static_cast<float>(i < 20 ? 18 * unit(random) : node.x + away));
      y.push_back(static_cast<float>(i < 20 ? 12 * unit(random) : node.y - away * one_of(2)));
    }
    std::vector<float> distances(x.size()), extents(x.size());
    surface->at(x.size(), x.data(), y.data(), distances.data(), extents.data());
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(distances[i] >= static_cast<float>(surface->farthest()) &&
                  distances[i] <= static_cast<float>(surface->nearest()))
          << round << " " << distances[i];
      ASSERT_TRUE(extents[i] >= static_cast<float>(surface->least_extent()) &&
                  extents[i] <= static_cast<float>(surface->most_extent()))
          << round << " " << extents[i];
      const auto slopes = surface->slopes({x[i], y[i]});
      const auto& [distance, extent, blur] = slopes.values;
      ASSERT_TRUE(distance >= surface->farthest() && distance <= surface->nearest()) << round << " " << distance;
      ASSERT_TRUE(extent >= surface->least_extent() && extent <= surface->most_extent()) << round << " " << extent;
      ASSERT_TRUE(std::isfinite(blur)) << round;
      ASSERT_TRUE(std::isfinite(slopes.inverse_distance.x + slopes.inverse_distance.y + slopes.extent_stops.x +
                                slopes.extent_stops.y))
          << round;
    }
  }
  EXPECT_GT(refused, 20);
  EXPECT_LT(refused, 200);
}

TEST(FocalPoints, LieWhereChiefRaysMeetTheFilm) {
  const IdealLens thick = thick_lens(petzval::testing::data_lens("double_gauss_100mm_f2.0"));
  const Film tilted{.z_mm = thick.rear_focal_z + 3, .tilt_rad = 0.1, .swing_rad = -0.05};
  const Vec3<double> places[] = {{100, -50, -2000}, {-900, 0, -1500}, {0, 0, -3000}};
  std::vector<FocusPoint> points;
  for (const auto& place : places) {
    points.push_back({.keys = {{.anchor = ScenePoint{place}, .blur_mm = 0.1, .weight = 2, .extent_stops = 3}}});
  }
  points[2].fixes_distance = false;
  points[2].keys[0].anchor = ScenePoint{{0.1, 0, -1}, true};
  const auto found = focal_points(thick, tilted, points, {});
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto image = thick.image(std::get<ScenePoint>(points[i].keys[0].anchor));
    EXPECT_EQ(found[i].film_point.x, chief_point(*image, tilted)->x);
    EXPECT_EQ(found[i].film_point.y, chief_point(*image, tilted)->y);
    EXPECT_EQ(found[i].blur_mm, 0.1);
    EXPECT_EQ(found[i].weight, 2);
    EXPECT_EQ(found[i].extent_stops, 3);
    EXPECT_EQ(found[i].fade, 1);
    EXPECT_EQ(found[i].inverse_distance.has_value(), i < 2);
  }
  EXPECT_FALSE(tilted.contains(found[1].film_point));  // outside the frame
  EXPECT_DOUBLE_EQ(*found[0].inverse_distance, 1 / (thick.pupils.entrance.z + 2000));
  EXPECT_EQ(focal_points(thick, tilted, points, {.film = tilted}).size(), 2u);
  expect_error([&] { focal_points(thick, tilted, points, {}, std::vector<double>{1}); }, {"fades", 1, 3});
}

TEST(FocalPoints, CountByTheirFades) {
  std::vector<FocusPoint> points{{.keys = {{.anchor = ScenePoint{{100, -50, -2000}}}}, .until = 1},
                                 {.keys = {{.anchor = ScenePoint{{0, -50, -30}}}}},  // within the focal length
                                 {.keys = {{.anchor = ScenePoint{{0, 30, -900}}}}}};
  EXPECT_EQ(focal_points(lens, film, points, {.time = 1}).size(), 2u);
  EXPECT_EQ(focal_points(lens, film, points, {.time = 2}).size(), 1u);
  const auto faded = focal_points(lens, film, points, {.time = 2}, std::vector{0.5, 1.0, 1.0});
  ASSERT_EQ(faded.size(), 2u);
  EXPECT_EQ(faded[0].fade, 0.5);
  EXPECT_EQ(focal_points(lens, film, points, {.time = 1}, std::vector{0.0, 1.0, 1.0}).size(), 1u);
  // The nearest point keeps its weight.
  const auto weighed = focal_points(lens, film, points, {.time = 0, .nearer_weighs_more = true});
  EXPECT_DOUBLE_EQ(weighed[0].weight, 900.0 / 2000);
  EXPECT_EQ(weighed[1].weight, 1);
}

}  // namespace focal_surface_test
