// SPDX-License-Identifier: Apache-2.0
// The edges at which surfaces of an element meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace edges_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two spheres of radius `radius` that meet at the height where their sags add up to the thickness.
Prescription biconvex(double radius, double thickness, double rim = infinity) {
  Prescription p;
  p.name = "biconvex";
  p.surfaces = {{.radius = radius, .thickness = thickness, .medium = {.nd = 1.5168}, .semi_diameter = rim},
                {.radius = -radius, .thickness = 48, .semi_diameter = rim}};
  return p;
}

double meeting_height(double radius, double thickness) {
  const double sag = thickness / 2;
  return std::sqrt(sag * (2 * radius - sag));
}

RayFate fate_at(const Lens& lens, double y, Travel travel) {
  const bool to_film = travel == Travel::to_film;
  const double z = to_film ? -50 : lens.surfaces().back().vertex_z + 50;
  return trace(lens, Ray<double>{{0, y, z}, {0, 0, to_film ? 1.0 : -1.0}}, {.travel = travel}).fate;
}

TEST(Edges, LimitTheAperturesOfBothSurfacesOfAnElement) {
  for (const double rim : {infinity, 25.0}) {
    const Lens lens = compile(biconvex(50, 4, rim));
    const double height = meeting_height(50, 4);
    for (const LensSurface& s : lens.surfaces()) {
      EXPECT_NEAR(s.semi_diameter, height, 1e-12 * height);
      EXPECT_EQ(s.semi_diameter, s.edge);
    }
    for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
      EXPECT_EQ(fate_at(lens, 0.999 * height, travel), RayFate::transmitted);
      EXPECT_EQ(fate_at(lens, 1.001 * height, travel), RayFate::vignetted);
    }
  }
}

TEST(Edges, LimitAirSpaces) {
  // A plane and a concave surface that bends towards it through 2 mm of air.
  Prescription p;
  p.surfaces = {{.radius = 60, .thickness = 8, .medium = {.nd = 1.6}, .semi_diameter = 30},
                {.radius = 0, .thickness = 2, .semi_diameter = 30},
                {.radius = -50, .thickness = 3, .medium = {.nd = 1.7}, .semi_diameter = 30},
                {.radius = 80, .thickness = 60, .semi_diameter = 30}};
  const Lens lens = compile(p);
  const double height = std::sqrt(2 * (100 - 2.0));
  EXPECT_NEAR(lens.surfaces()[1].semi_diameter, height, 1e-12 * height);
  EXPECT_NEAR(lens.surfaces()[2].semi_diameter, height, 1e-12 * height);
  EXPECT_EQ(lens.surfaces()[3].semi_diameter, 30);
}

// A stop bends no ray, so that the surfaces on both sides of it bound one air space.
TEST(Edges, IgnoreSurfacesThatBendNoRay) {
  Prescription p;
  p.surfaces = {{.radius = 60, .thickness = 8, .medium = {.nd = 1.6}, .semi_diameter = 30},
                {.radius = 0, .thickness = 1, .semi_diameter = 30},
                {.radius = 0, .thickness = 1, .semi_diameter = 28, .stop = true},
                {.radius = -50, .thickness = 3, .medium = {.nd = 1.7}, .semi_diameter = 30},
                {.radius = 80, .thickness = 60, .semi_diameter = 30}};
  const Lens lens = compile(p);
  EXPECT_NEAR(lens.surfaces()[3].semi_diameter, std::sqrt(2 * (100 - 2.0)), 1e-11);
  EXPECT_EQ(lens.surfaces()[2].semi_diameter, 28);
}

TEST(Edges, DoNotLimitSurfacesNextToSmallerSurfaces) {
  Prescription p = biconvex(50, 4, 25);
  p.surfaces[1].semi_diameter = 0.9 * meeting_height(50, 4);
  const Lens lens = compile(p);
  EXPECT_EQ(lens.surfaces()[0].semi_diameter, 25);
  EXPECT_EQ(lens.surfaces()[0].edge, infinity);
}

// Elements of thickness 0 are ideal and have no edge.
TEST(Edges, AreMissingOnElementsWithoutThickness) {
  for (const double thickness : {0.0, -1.0}) {
    EXPECT_EQ(compile(biconvex(50, thickness, 10)).surfaces()[0].semi_diameter, 10);
  }
}

TEST(Edges, FollowMovingGroups) {
  Prescription p;
  p.surfaces = {{.radius = 60, .thickness = 8, .medium = {.nd = 1.6}, .semi_diameter = 30},
                {.radius = 0, .thickness = 2, .semi_diameter = 30},
                {.radius = -50, .thickness = 3, .medium = {.nd = 1.7}, .semi_diameter = 30},
                {.radius = 80, .thickness = 60, .semi_diameter = 30}};
  p.configurations = {{.name = "far"},
                      {.name = "near", .focus_of = "far", .subject_distance_mm = 1000, .changes = {{1, 4.0}}}};
  const Lens lens = compile(p);
  EXPECT_NEAR(lens.surfaces()[2].semi_diameter, std::sqrt(2 * (100 - 2.0)), 1e-11);
  EXPECT_NEAR(with_groups_at(lens, 1e-3).surfaces()[2].semi_diameter, std::sqrt(4 * (100 - 4.0)), 1e-11);
}

TEST(Edges, ScaleWithTheLens) {
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p), larger = compile(scale(p, 4));
    for (std::size_t i = 0; i < lens.surface_count(); ++i) {
      EXPECT_EQ(larger.surfaces()[i].semi_diameter, 4 * lens.surfaces()[i].semi_diameter) << p.id << ' ' << i;
      EXPECT_EQ(larger.surfaces()[i].edge, 4 * lens.surfaces()[i].edge) << p.id << ' ' << i;
    }
  }
}

// Transmitted rays meet refracting surfaces in the order of the prescription, for apertures of any size. Rays nearly
// parallel to a surface may meet the next surface first: 1 in 4000 of one lens.
TEST(Edges, RaysMeetSurfacesInOrder) {
  for (Prescription p : testing::data_prescriptions()) {
    double size = 0;
    for (SurfaceRow& row : p.surfaces) {
      size = std::max(size, 1.5 * row.semi_diameter.value_or(0));
      row.semi_diameter = infinity;
    }
    const Lens lens = compile(p);
    int passed = 0, out_of_order = 0;
    for (int k = 0; k < 4000; ++k) {
      const auto part = [k](double step) { return 2 * (k * step - std::floor(k * step)) - 1; };
      const double x = 0.6 * part(0.8191725134), y = 0.6 * part(0.6710436067);
      const double beyond = k % 4 == 0 ? 0.1 : 1;  // some near the axis
      const Ray<double> ray{{beyond * size * part(0.7548776662), beyond * size * part(0.5698402910), -size},
                            {beyond * x, beyond * y, std::sqrt(1 - beyond * beyond * (x * x + y * y))}};
      struct Hit {
        std::size_t surface;
        Vec3<double> point;
      };
      std::vector<Hit> hits;
      const auto end = trace<double>(lens, ray, {}, [&](int surface, const Vec3<double>& point) {
        const auto i = static_cast<std::size_t>(surface);
        if (lens.surfaces()[i].mirror || lens.index(i) != lens.index(i + 1)) hits.push_back({i, point});
      });
      if (!end.transmitted()) continue;
      ++passed;
      for (std::size_t i = 1; i < hits.size(); ++i) {
        const double way = (hits[i].point.z - hits[i - 1].point.z) * lens.light_direction(hits[i].surface);
        out_of_order += way < -1e-12 * size;
      }
    }
    EXPECT_GT(passed, 0) << p.id;
    EXPECT_LE(out_of_order, passed / 1000) << p.id;
  }
}

}  // namespace edges_test
}  // namespace petzval
