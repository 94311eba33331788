// SPDX-License-Identifier: Apache-2.0
// Aiming and boundaries for every lens of data/ and for extreme and invalid input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace extremes_test {

using testing::data_lens;
using testing::data_prescriptions;
using testing::expect_error;
constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();

double edge_deg(const Prescription& p) { return p.half_field_deg.value_or(1); }

RayFate fate(const Lens& lens, const PupilBoundary& boundary, const PupilSpan& span, double radius) {
  const Vec2<double> p = boundary.at(span.direction, radius);
  return trace(lens, boundary.plane.ray(p.x, p.y)).fate;
}

TEST(Extremes, EdgeRaysPassAndTheNextAreLost) {
  int edges = 0;
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    for (const double share : {0.0, 0.5, 1.0}) {
      for (const double z : {-infinity, -20 * std::abs(*p.focal_length_mm)}) {
        if (std::isfinite(z) && share * edge_deg(p) > 80) continue;
        SCOPED_TRACE(p.id + " at " + std::to_string(share * edge_deg(p)) + " of z " + std::to_string(z));
        const PupilBoundary boundary = pupil_boundary(lens, {radians(share * edge_deg(p)), z}, 0, 12);
        EXPECT_FALSE(boundary.empty() && share < 1);
        for (const PupilSpan& span : boundary.spans) {
          ASSERT_EQ(fate(lens, boundary, span, span.to_radius), RayFate::transmitted);
          ASSERT_EQ(fate(lens, boundary, span, span.from_radius), RayFate::transmitted);
          const Vec2<double> beyond = boundary.at(span.direction, span.to_radius + 1e-12);
          const auto next = trace(lens, boundary.plane.ray(beyond.x, beyond.y));
          ASSERT_FALSE(next.transmitted());
          EXPECT_EQ(next.surface, span.to.surface);
          EXPECT_EQ(next.fate, span.to.next_fate);
          ASSERT_TRUE(span.from_radius == 0 ||
                      fate(lens, boundary, span, span.from_radius - 1e-12) != RayFate::transmitted);
          ++edges;
        }
      }
    }
  }
  EXPECT_GT(edges, 4500);
}

TEST(Extremes, AreaOfEveryLensEqualsAGridOfRays) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    for (const double share : {0.7, 1.0}) {
      SCOPED_TRACE(p.id + " at " + std::to_string(share * edge_deg(p)));
      const PupilBoundary boundary = pupil_boundary(lens, {radians(share * edge_deg(p)), -infinity}, 0, 128);
      if (boundary.empty()) continue;
      // The grid covers twice the bounding box of the pupil, so that missed components count.
      constexpr int nodes = 160;
      int passed = 0;
      for (int j = 0; j < nodes; ++j) {
        for (int i = 0; i < nodes; ++i) {
          const double x = boundary.middle[0] + 2 * boundary.half_axes[0] * ((2 * i + 1.0) / nodes - 1);
          const double y = boundary.middle[1] + 2 * boundary.half_axes[1] * ((2 * j + 1.0) / nodes - 1);
          passed += trace(lens, boundary.plane.ray(x, y)).transmitted();
        }
      }
      const double box = 16 * boundary.half_axes[0] * boundary.half_axes[1];
      EXPECT_NEAR(boundary.area() / (box * passed / (nodes * nodes)), 1, 6e-3);
    }
  }
}

// Areas are compared, because the directions of the boundary meet the rotated pupil at other points.
TEST(Extremes, PupilsRotateWithTheAzimuth) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    if (!lens.rotationally_symmetric()) continue;
    const double field = radians(0.8 * edge_deg(p));
    const double area = pupil_boundary(lens, {field, -infinity}, 0, 128).area();
    for (const double azimuth : {0.7, -2.5}) {
      SCOPED_TRACE(p.id + " " + std::to_string(azimuth));
      const PupilBoundary turned = pupil_boundary(lens, {field, -infinity, azimuth}, 0, 128);
      EXPECT_NEAR(turned.area(), area, 2e-3 * area);
    }
    EXPECT_NEAR(pupil_boundary(lens, {-field, -infinity}, 0, 128).area(), area, 1e-9 * area) << p.id;
    EXPECT_NEAR(pupil_boundary(lens, {field, -infinity, std::numbers::pi}, 0, 128).area(), area, 1e-9 * area) << p.id;
  }
}

TEST(Extremes, PupilsAreMirrorImages) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    for (const double share : {0.4, 0.9}) {
      SCOPED_TRACE(p.id + " " + std::to_string(share));
      const PupilBoundary boundary = pupil_boundary(lens, {radians(share * edge_deg(p)), -infinity}, 0, 16);
      EXPECT_NEAR(boundary.middle[0], 0, 1e-8 * boundary.half_axes[0]);  // up to the tolerance of the search
      for (const PupilSpan& span : boundary.spans) {
        const auto mirror = std::find_if(boundary.spans.begin(), boundary.spans.end(), [&](const PupilSpan& s) {
          return s.direction == boundary.directions - 1 - span.direction &&
                 std::abs(s.to_radius - span.to_radius) < 1e-7;
        });
        ASSERT_NE(mirror, boundary.spans.end()) << span.direction;
        EXPECT_EQ(mirror->to.surface, span.to.surface);
        EXPECT_NEAR(mirror->from_radius, span.from_radius, 1e-7);
      }
    }
  }
}

TEST(Extremes, ALensScaledByAPowerOfTwoScalesToTheBit) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p), large = compile(scale(p, 8));
    const double field = radians(0.7 * edge_deg(p));
    const AimedRay ray = aim(lens, {field, -infinity}, {0.3, -0.5}), big = aim(large, {field, -infinity}, {0.3, -0.5});
    EXPECT_EQ(ray.status, big.status);
    EXPECT_EQ(ray.ray.origin * 8.0, big.ray.origin);
    EXPECT_EQ(ray.ray.direction, big.ray.direction);
    EXPECT_EQ(ray.residual, big.residual);
    const PupilBoundary boundary = pupil_boundary(lens, {field, -infinity}, 0, 12);
    const PupilBoundary wide = pupil_boundary(large, {field, -infinity}, 0, 12);
    ASSERT_EQ(boundary.spans.size(), wide.spans.size());
    EXPECT_EQ(boundary.half_axes[1] * 8, wide.half_axes[1]);
    for (std::size_t i = 0; i < boundary.spans.size(); ++i) {
      EXPECT_EQ(boundary.spans[i].to_radius, wide.spans[i].to_radius);
      EXPECT_EQ(boundary.spans[i].to.surface, wide.spans[i].to.surface);
    }
  }
}

// A field outside the field of view has no chief ray, an empty pupil and irradiance 0; all numbers are finite.
TEST(Extremes, FieldsBeyondTheLensAreDark) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    for (const double field : {88.0, 89.5, 91.0, 120.0, 179.9, 180.0}) {
      if (field < 1.3 * edge_deg(p)) continue;
      SCOPED_TRACE(p.id + " at " + std::to_string(field));
      const AimedRay chief = chief_ray(lens, {radians(field), -infinity});
      if (chief) {
        // Vignetted rays that graze a surface have a larger residual.
        EXPECT_LE(chief.residual, chief.status == AimStatus::converged ? 1e-12 : 1e-7);
        EXPECT_TRUE(std::isfinite(chief.end.ray.origin.y) && std::isfinite(chief.end.ray.direction.y));
      }
      const PupilBoundary boundary = pupil_boundary(lens, {radians(field), -infinity}, 0, 16);
      EXPECT_TRUE(std::isfinite(boundary.area()));
      if (chief.status != AimStatus::converged && field > 110) {  // convex fronts accept slightly more than 90
        EXPECT_TRUE(boundary.empty());
      }
      const auto light = relative_illumination(lens, {radians(field), -infinity});
      if (light) {
        EXPECT_TRUE(*light >= 0 && *light < 1.5) << *light;
      }
    }
  }
}

TEST(Extremes, WithoutAMarkedStopTheLimitingApertureServes) {
  for (Prescription p : data_prescriptions()) {
    for (SurfaceRow& row : p.surfaces) row.stop = false;
    const Lens lens = compile(p);
    SCOPED_TRACE(p.id);
    ASSERT_TRUE(pupils(lens).stop_inferred);
    for (const double share : {0.0, 0.3}) {
      const FieldPoint point{radians(share * edge_deg(p)), -infinity};
      const AimedRay edge = aim(lens, point, {0, 1});
      if (edge) {
        EXPECT_LE(edge.residual, 1e-12);
      }
      EXPECT_TRUE(chief_ray(lens, point));
      EXPECT_FALSE(pupil_boundary(lens, point, 0, 8).empty());
    }
  }
}

TEST(Extremes, StopOfRadiusZeroPassesItsCentreOnly) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens open = compile(p);
    const Lens lens = with_semi_diameter(open, *open.stop(), 0);
    const FieldPoint point{radians(0.5 * edge_deg(p)), -infinity};
    const AimedRay chief = chief_ray(lens, point), wide = chief_ray(open, point);
    ASSERT_EQ(static_cast<bool>(chief), static_cast<bool>(wide));
    if (chief) {
      EXPECT_EQ(chief.ray.origin, wide.ray.origin);
    }
    EXPECT_TRUE(pupil_boundary(lens, point, 0, 8).empty());
    EXPECT_FALSE(relative_illumination(lens, point).has_value());
  }
}

TEST(Extremes, StopsOfAnySizeHavePupils) {
  const Lens open = data_lens("double_gauss_100mm_f2.0");
  for (const double semi_diameter : {1e6, infinity, 1.0, 1e-3, 1e-6}) {
    SCOPED_TRACE(semi_diameter);
    const Lens lens = with_any_semi_diameter(open, 5, semi_diameter);
    const FieldPoint point{radians(15), -infinity};
    EXPECT_TRUE(chief_ray(lens, point));
    const PupilBoundary boundary = pupil_boundary(lens, point, 0, 32);
    ASSERT_FALSE(boundary.empty());
    if (semi_diameter > 1) continue;
    // The pupil of a small stop is its image, an ellipse whose area scales with the square of the radius.
    const double unit = pupil_boundary(with_semi_diameter(open, 5, 0.1), point, 0, 32).area() / 0.01;
    EXPECT_NEAR(boundary.area() / (semi_diameter * semi_diameter) / unit, 1, 2e-3);
  }
}

TEST(Extremes, RefusesInvalidPoints) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const std::vector<FieldPoint> bad{{nan, -infinity},
                                    {infinity, -infinity},
                                    {-4, -infinity},
                                    {0.1, nan},
                                    {0.1, infinity},
                                    {0.1, 0},
                                    {0.1, 30},
                                    {0.1, 1e4},
                                    {0.1, -infinity, nan},
                                    {0.1, -1, infinity},
                                    {radians(100), -50}};
  for (const FieldPoint& point : bad) {
    SCOPED_TRACE(std::to_string(point.field_rad) + " " + std::to_string(point.z));
    expect_error([&] { chief_ray(lens, point); }, {lens.name(), "scene point"});
    expect_error([&] { pupil_boundary(lens, point); }, {lens.name(), "scene point"});
    expect_error([&] { aim(lens, point, {0, 1}); }, {lens.name(), "scene point"});
    expect_error([&] { relative_illumination(lens, point); }, {lens.name(), "scene point"});
  }
  for (const FilmPoint& point : {FilmPoint{nan, 0}, FilmPoint{0, -infinity}}) {
    expect_error([&] { exit_pupil_boundary(lens, point); }, {lens.name(), "film point"});
    expect_error([&] { film_irradiance(lens, point); }, {lens.name(), "film point"});
  }
}

TEST(Extremes, RefusesMissingWavelengths) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  expect_error([&] { chief_ray(lens, {0, -infinity}, 1); }, {lens.name(), "wavelength", 1});
  expect_error([&] { pupil_boundary(lens, {0, -infinity}, 1); }, {lens.name(), "wavelength", 1});
  expect_error([&] { exit_pupil_boundary(lens, {0, 0}, 1); }, {lens.name(), "wavelength", 1});
  expect_error([&] { relative_illumination(lens, {0, -infinity}, 1); }, {lens.name(), "wavelength", 1});
}

TEST(Extremes, InvalidTargetsGetNoRay) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  for (const Vec2<double>& target :
       {Vec2<double>{nan, 0}, Vec2<double>{0, infinity}, Vec2<double>{1e300, 0}, Vec2<double>{0, -1e3}}) {
    EXPECT_EQ(aim(lens, {0.1, -infinity}, target).status, AimStatus::no_ray) << target.x << " " << target.y;
  }
  // A ray reaches a point just outside the rim of the stop, and is vignetted by the stop.
  const AimedRay outside = aim(lens, {0, -infinity}, {0, 1.05});
  EXPECT_EQ(outside.status, AimStatus::vignetted);
}

TEST(Extremes, TelecentricLensIsRefusedFromTheSceneOnly) {
  Prescription p;
  p.name = "telecentric";
  p.surfaces = {{.radius = 60, .thickness = 5, .medium = {.nd = 1.6}, .semi_diameter = 12},
                {.radius = -80, .semi_diameter = 12}};
  p.surfaces[1].thickness = first_order(compile(p)).back_focal_distance;
  p.surfaces.push_back({.thickness = 40, .semi_diameter = 3, .stop = true});
  const Lens lens = compile(p);
  expect_error([&] { chief_ray(lens, {0, -infinity}); }, {"telecentric", "entrance pupil", "infinity"});
  expect_error([&] { pupil_boundary(lens, {0.1, -100}); }, {"telecentric", "entrance pupil", "infinity"});
  // From the film side the pupil is the stop: 3 mm at a distance of 40 mm.
  EXPECT_NEAR(film_irradiance(lens, {0, 0}), std::numbers::pi * 9 / (9 + 1600), 1e-6);
}

}  // namespace extremes_test
}  // namespace petzval
