// SPDX-License-Identifier: Apache-2.0
// Fates on both sides of every edge and on the edge itself, for single rays and for batches of both arithmetics on
// every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "batches.hpp"

namespace edges_test {

using namespace testing_batches;
using petzval::Prescription;
using petzval::SurfaceRow;
using testing_lenses::one_surface;

template <class T>
class EdgesOf : public testing::Test {
 public:
  /// Relative distance from an edge at which fates must be correct.
  static constexpr double near = sizeof(T) == 4 ? 1e-5 : 1e-9;
};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(EdgesOf, Plain);

SurfaceRow surface(double radius, double conic, double n_behind) {
  SurfaceRow row;
  row.radius = radius;
  row.conic = conic;
  row.medium.nd = n_behind;
  return row;
}

template <class T>
Ray<T> ray_of(double x, double y, double z, double dx, double dy, double dz) {
  return {{static_cast<T>(x), static_cast<T>(y), static_cast<T>(z)},
          {static_cast<T>(dx), static_cast<T>(dy), static_cast<T>(dz)}};
}

/// Checks that every tracer gives the ray this fate.
template <class T>
void expect_fate(const Lens& lens, const Ray<T>& ray, Travel travel, RayFate fate, const std::string& what) {
  EXPECT_EQ(name(petzval::trace(lens, ray, {.travel = travel}).fate), name(fate)) << what << ", one ray";
  for (const auto& options : every_batch(travel)) {
    const auto answer = traced(lens, std::vector<Ray<T>>(3, ray), options);
    for (const RayFate found : answer.fates) EXPECT_EQ(name(found), name(fate)) << what << ", " << text(options);
  }
}

constexpr auto passes = RayFate::transmitted, misses = RayFate::missed_surface, clipped = RayFate::vignetted,
               reflected = RayFate::totally_reflected;

TYPED_TEST(EdgesOf, TheEquatorOfASphere) {
  const Lens lens = one_surface(surface(50, 0, 1.5)), mirrored = one_surface(surface(-50, 0, 1.5));
  for (const double off : {-this->near, this->near}) {
    const std::string what = "at the equator x 1 + " + std::to_string(off);
    const double x = 50 * (1 + off);
    const bool in = off < 0;
    expect_fate(lens, ray_of<TypeParam>(x, 0, -3, 0, 0, 1), Travel::to_film, in ? passes : misses, what);
    expect_fate(lens, ray_of<TypeParam>(0, -x, 90, 0, 0, -1), Travel::to_scene, in ? reflected : misses, what);
    expect_fate(mirrored, ray_of<TypeParam>(0, x, -90, 0, 0, 1), Travel::to_film, in ? passes : misses, what);
  }
}

TYPED_TEST(EdgesOf, ATangentAtFortyFiveDegrees) {
  const double s = std::sqrt(0.5);
  for (const double off : {-this->near, this->near}) {
    const double x = 50 * s * (1 + off) - 20 * s, z = 50 - 50 * s * (1 + off) - 20 * s;
    expect_fate(one_surface(surface(50, 0, 1.5)), ray_of<TypeParam>(x, 0, z, s, 0, s), Travel::to_film,
                off < 0 ? passes : misses, "tangent, off by " + std::to_string(off));
  }
}

TYPED_TEST(EdgesOf, TheCriticalAngle) {
  const Lens flat = one_surface(surface(0, 0, 1), 1.5), behind = one_surface(surface(0, 0, 1.5));
  for (const double off : {-this->near, this->near}) {
    const double sine = (1 + off) / 1.5, cosine = std::sqrt(1 - sine * sine);
    const std::string what = "sine of incidence off by " + std::to_string(off);
    const RayFate fate = off < 0 ? passes : reflected;
    expect_fate(flat, ray_of<TypeParam>(-3, 1, -2, sine, 0, cosine), Travel::to_film, fate, what);
    expect_fate(behind, ray_of<TypeParam>(3, 1, 2, 0.6 * sine, 0.8 * sine, -cosine), Travel::to_scene, fate, what);
  }
  // On a sphere, the sine of incidence of rays parallel to the axis is height divided by radius.
  const Lens round = one_surface(surface(-30, 0, 1), 1.5);
  for (const double off : {-this->near, this->near}) {
    expect_fate(round, ray_of<TypeParam>(20 * (1 + off), 0, -30, 0, 0, 1), Travel::to_film,
                off < 0 ? passes : reflected, "sphere, off by " + std::to_string(off));
  }
}

/// Surfaces of every kind.
std::vector<SurfaceRow> kinds() {
  std::vector<SurfaceRow> rows{surface(0, 0, 1.5),   surface(40, 0, 1.5),    surface(-25, 0, 1.5),
                               surface(40, -1, 1.5), surface(-60, -30, 1.5), surface(30, 0.5, 1.5)};
  rows.push_back(surface(40, 0, 1.5));
  rows.back().curved_in = petzval::Section::x;
  rows.push_back(surface(-40, -0.5, 1.5));
  rows.back().aspheric = {{4, 1e-6}, {7, -1e-10}};
  return rows;
}

// All squares are exact in binary, so that only the comparison decides.
TYPED_TEST(EdgesOf, RimAndObscurationEdgeBelongToTheClearAperture) {
  struct Place {
    double x, y;
    RayFate fate;
  };
  const double out = 1 + this->near, in = 1 - this->near;
  const std::vector<Place> places{{12.5, 0, passes},       {0, -12.5, passes},       {7.5, 10, passes},
                                  {-7.5, 10, passes},      {12.5 * out, 0, clipped}, {7.5, 10 * out, clipped},
                                  {12.5 * in, 0, passes},  {3.25, 0, passes},        {-1.25, 3, passes},
                                  {3.25 * in, 0, clipped}, {1.25, -3 * in, clipped}, {0, 0, clipped},
                                  {0, 3.25 * out, passes}};
  int kind = 0;
  for (SurfaceRow row : kinds()) {
    row.semi_diameter = 12.5;
    row.obscuration_semi_diameter = 3.25;
    const Lens lens = one_surface(row);
    for (const auto& [x, y, fate] : places) {
      const std::string what = "surface " + std::to_string(kind) + " at " + std::to_string(x) + " " + std::to_string(y);
      expect_fate(lens, ray_of<TypeParam>(x, y, -9, 0, 0, 1), Travel::to_film, fate, what);
      expect_fate(lens, ray_of<TypeParam>(x, y, 9, 0, 0, -1), Travel::to_scene, fate, what);
    }
    ++kind;
  }
}

TYPED_TEST(EdgesOf, ClosedApertureTransmitsTheAxisOnly) {
  for (SurfaceRow row : kinds()) {
    row.semi_diameter = 0;
    const Lens lens = one_surface(row);
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      const double sense = travel == Travel::to_film ? 1 : -1;
      expect_fate(lens, ray_of<TypeParam>(0, 0, -9 * sense, 0, 0, sense), travel, passes, "axis");
      expect_fate(lens, ray_of<TypeParam>(1e-6, 0, -9 * sense, 0, 0, sense), travel, clipped, "next to the axis");
    }
  }
}

TYPED_TEST(EdgesOf, TheFarSideOfASphereIsMissed) {
  const Lens sphere = one_surface(surface(50, 0, 1)), bowl = one_surface(surface(-50, 0, 1));
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    expect_fate(sphere, ray_of<TypeParam>(-90, 3, 60, 1, 0, 0), travel, misses, "beyond the equator");
    expect_fate(bowl, ray_of<TypeParam>(-90, 3, -60, 1, 0, 0), travel, misses, "beyond the equator");
    expect_fate(sphere, ray_of<TypeParam>(-90, 3, 40, 1, 0, 0), travel, passes, "before the equator");
    expect_fate(bowl, ray_of<TypeParam>(-90, 3, -40, 1, 0, 0), travel, passes, "before the equator");
  }
  // A line that crosses both halves of the sphere: each direction of travel has its own crossing.
  expect_fate(sphere, ray_of<TypeParam>(0, 40, -5, 0, 0, 1), Travel::to_film, passes, "front");
  expect_fate(sphere, ray_of<TypeParam>(-60, 0, 45, 0.8, 0, 0.6), Travel::to_scene, misses, "leaves by the far half");
}

TYPED_TEST(EdgesOf, TheSecondSheetOfAHyperboloidIsMissed) {
  const Lens lens = one_surface(surface(50, -2.25, 1));  // second vertex at z = -80
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    expect_fate(lens, ray_of<TypeParam>(-200, 3, -100, 1, 0, 0), travel, misses, "second sheet");
    expect_fate(lens, ray_of<TypeParam>(-200, 3, 10, 1, 0, 0), travel, passes, "first sheet");
    expect_fate(lens, ray_of<TypeParam>(-200, 3, -40, 1, 0, 0), travel, misses, "between the sheets");
  }
}

TYPED_TEST(EdgesOf, DirectionOfTravelSelectsTheCrossing) {
  const Lens sphere = one_surface(surface(50, 0, 1));
  const double length = std::sqrt(1.01);
  const Ray<TypeParam> ray = ray_of<TypeParam>(-60, 0, 30, 1 / length, 0, -0.1 / length);
  for (const auto& options : every_batch(Travel::to_film)) {
    const auto answer = traced(sphere, std::vector{ray}, options);
    ASSERT_EQ(answer.fates[0], passes) << text(options);
    EXPECT_LT(answer.rays[0].origin.x, 0) << text(options);
  }
  for (const auto& options : every_batch(Travel::to_scene)) {
    const auto answer = traced(sphere, std::vector{ray}, options);
    ASSERT_EQ(answer.fates[0], passes) << text(options);
    EXPECT_GT(answer.rays[0].origin.x, 0) << text(options);
  }
}

}  // namespace edges_test
