// SPDX-License-Identifier: Apache-2.0
#include "focus/plane_fit.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {
namespace plane_fit_test {

using namespace focus_detail;
using Points = std::vector<PicturePoint>;
using Vec = Vec3<double>;

void expect_fit(const Points& points, PlaneRank rank, double a, double b, double c, double tolerance = 1e-12) {
  const PlaneFit fit = fit_plane(points);
  EXPECT_EQ(fit.rank, rank);
  EXPECT_NEAR(fit.a, a, tolerance);
  EXPECT_NEAR(fit.b, b, tolerance);
  EXPECT_NEAR(fit.c, c, tolerance);
}

// Numbers computed with 40 digits.
TEST(PlaneFit, GivesTheKnownPlanes) {
  using enum PlaneRank;
  const Points four{{-0.2, 0.05, 1 / 2.0}, {0.15, 0.1, 1 / 3.0}, {0.02, -0.12, 1 / 2.4}, {0.2, -0.1, 1 / 4.0}};
  expect_fit(four, plane, -0.57369057369057369, 0.036660036660036660, 0.4000234000234000);
  expect_fit({{-0.2, 0.05, 0.5}, {0.15, 0.1, 1 / 3.0}}, line, -1.4 / 3, -0.2 / 3, 0.41);
  expect_fit({{-0.2, 0.05, 0.5}, {0.15, 0.1, 0.3}}, line, -0.56, -0.08, 0.392);
  expect_fit({{0.1, 0.2, 0.4}, {0.1, 0.2, 0.5}}, point, 0, 0, 0.45);
  expect_fit({{-0.1, -0.1, 0.5}, {0, 0, 0.4}, {0.2, 0.2, 0.1}}, line, -0.678571428571429, -0.678571428571429,
             0.378571428571429, 1e-15 + 5e-16);
  expect_fit({{-0.2, 0, 0.5}, {0.2, 0, 0.3}, {0, 0.1, 0.5}}, plane, -0.5, 1, 0.4);
  expect_fit({}, none, 0, 0, 0);
  expect_fit({{0.1, 0.2, 0.4, 0}}, none, 0, 0, 0);
  expect_fit({{0.1, 0.2, 0.4}}, point, 0, 0, 0.4);
}

TEST(PlaneFit, IsAPlaneInTheSceneAndOfTheFilm) {
  const PlaneFit fit =
      fit_plane(Points{{-0.2, 0.05, 1 / 2.0}, {0.15, 0.1, 1 / 3.0}, {0.02, -0.12, 1 / 2.4}, {0.2, -0.1, 1 / 4.0}});
  // The reference values are for a scene at positive z.
  const Plane plane = plane_of(fit, 0).value();
  const double sign = plane.normal.x < 0 ? 1 : -1;
  EXPECT_NEAR(sign * plane.offset, 1.4278670618130103, 1e-12);
  EXPECT_NEAR(sign * plane.normal.x, -0.81915387384537973, 1e-12);
  EXPECT_NEAR(sign * plane.normal.y, 0.052345658831723789, 1e-12);
  EXPECT_NEAR(-sign * plane.normal.z, 0.57118023684786267, 1e-12);
  EXPECT_GE(plane.normal.z, 0);
  const IdealLens lens = thin_lens(0.05, 2);
  const Film film = film_in(lens.image_of(plane).value());
  EXPECT_NEAR(degrees(film.angle()), 1.6799842871979173, 1e-9);
  // A steeper plane, and the slope at which the tilt of the film reaches 20 degrees.
  const double steepest = 7.1338165916175663;
  const Plane steep = plane_of({PlaneRank::plane, steepest * 0.6, steepest * -0.8, 0.4}, 0).value();
  EXPECT_NEAR(degrees(film_in(lens.image_of(steep).value()).angle()), 20, 1e-9);
}

TEST(PlaneFit, PlaneHoldsThePointsItWasFittedTo) {
  // Depths from z = 7, planes that contain the view direction (c = 0), and a plane focused beyond infinity (c < 0).
  for (const double c : {1e-3, 0.0, -1e-4}) {
    Points points;
    std::vector<Vec> places;
    for (const auto& [x, y] : {std::pair{0.3, 0.1}, {0.5, -0.2}, {0.2, 0.4}, {0.7, 0.6}}) {
      const double inverse = 2e-3 * x - 1e-4 * y + c;
      points.push_back({x, y, inverse});
      places.emplace_back(x / inverse, y / inverse, 7 - 1 / inverse);
    }
    const Plane plane = plane_of(fit_plane(points), 7).value();
    for (const Vec& p : places) EXPECT_NEAR(glm::dot(plane.normal, p), plane.offset, 1e-9);
  }
  EXPECT_FALSE(plane_of(fit_plane(Points{{0.1, 0.2, 0}}), 0));
}

TEST(PlaneFit, WeightsAreRepetitionsAndUnitsAreIrrelevant) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  Points base, repeated;
  for (int i = 0; i < 9; ++i) {
    const int times = 1 + i % 3;
    base.push_back({unit(random), unit(random), unit(random), static_cast<double>(times)});
    for (int k = 0; k < times; ++k) repeated.push_back({base.back().x, base.back().y, base.back().inverse_distance});
  }
  const PlaneFit fit = fit_plane(base);
  expect_fit(repeated, PlaneRank::plane, fit.a, fit.b, fit.c, 1e-14);
  for (const double scale : {1e-6, 1e6, 1e-150, 1e150}) {
    Points scaled = base;
    for (auto& p : scaled) p.inverse_distance *= scale, p.weight *= scale;
    expect_fit(scaled, PlaneRank::plane, fit.a * scale, fit.b * scale, fit.c * scale, 1e-14 * scale);
  }
}

}  // namespace plane_fit_test
}  // namespace petzval
