// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "../data_lenses.hpp"
#include "../message.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/trace/trace.hpp"

namespace {

using petzval::Prescription;
using petzval::Ray;
using petzval::Travel;

/// A ray of the lens in the frame of the reversed lens.
Ray<double> turned(const petzval::Lens& lens, const Ray<double>& ray) {
  const auto surfaces = lens.surfaces();
  const auto mirrors = std::count_if(surfaces.begin(), surfaces.end(), [](const auto& s) { return s.mirror; });
  const double sign = mirrors % 2 == 0 ? -1 : 1, z_last = surfaces.back().vertex_z;
  return {{ray.origin.x, ray.origin.y, sign * (ray.origin.z - z_last)},
          {ray.direction.x, ray.direction.y, sign * ray.direction.z}};
}

/// Traces a ray from the film side through the lens and, seen from the other side, through the reversed lens.
/// Returns whether it got through.
bool expect_same_way(const petzval::Lens& lens, const petzval::Lens& reversed, const Ray<double>& ray) {
  const auto there = petzval::trace(lens, ray, {.travel = Travel::to_scene});
  const auto back = petzval::trace(reversed, turned(lens, ray));
  EXPECT_EQ(there.fate, back.fate);
  EXPECT_EQ(there.surface, static_cast<int>(lens.surface_count()) - 1 - back.surface);
  const Ray<double> expected = turned(lens, there.ray);
  const double size = 1 + std::abs(lens.surfaces().back().vertex_z) + std::abs(ray.origin.z);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(back.ray.origin[axis], expected.origin[axis], 1e-12 * size) << "axis " << axis;
    EXPECT_NEAR(back.ray.direction[axis], expected.direction[axis], 1e-12) << "axis " << axis;
  }
  return there.transmitted();
}

// Light that retraces its way through the lens is light that runs forward through the reversed one: refracting lenses,
// even and odd numbers of mirrors, aspheres, cylinders, an eye with water behind it.
TEST(Reverse, LightTakesTheSameWay) {
  std::mt19937 random(20);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const petzval::Lens lens = petzval::compile(p), reversed = petzval::compile(petzval::reverse(p));
    ASSERT_EQ(lens.surface_count(), reversed.surface_count());
    const double height = p.f_number ? *p.focal_length_mm / (2 * *p.f_number) : 0.2 * lens.surfaces()[0].semi_diameter;
    int through = 0;
    for (int i = 0; i < 200 && !HasFatalFailure(); ++i) {
      const double slope_x = 0.005 * uniform(random), slope_y = 0.005 * uniform(random);
      const double length = std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
      const Ray<double> entering{{height * uniform(random), height * uniform(random), -1},
                                 {slope_x / length, slope_y / length, 1 / length}};
      const auto exit = petzval::trace(lens, entering);
      if (!exit.transmitted()) continue;
      const auto& d = exit.ray.direction;
      through += expect_same_way(lens, reversed, {exit.ray.origin, {-d.x, -d.y, -d.z}});
      // And one that has no reason to get through.
      const double bend = 0.1 * uniform(random), norm = std::sqrt(1 + 2 * bend * d.x + bend * bend);
      expect_same_way(lens, reversed, {exit.ray.origin, {-(d.x + bend) / norm, -d.y / norm, -d.z / norm}});
    }
    EXPECT_GT(through, 5);
  }
}

TEST(Reverse, TwiceGivesTheLensBackButForWhatOneSideHas) {
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    Prescription expected = p;
    expected.surfaces.back().thickness = 0;
    expected.f_number.reset();
    expected.half_field_deg.reset();
    expected.image_diagonal_mm.reset();
    expected.image_distance.reset();
    if (expected.zoom) expected.zoom->variable_gaps.erase(static_cast<int>(p.surfaces.size()) - 1);
    EXPECT_EQ(petzval::reverse(petzval::reverse(p)), expected) << p.id;
  }
}

TEST(Reverse, MediaAndTheStopMoveWithTheirSurfaces) {
  Prescription p;
  p.name = "immersed";
  p.object_space = {.nd = 1.333, .vd = 55};
  p.surfaces = {{.radius = 30, .thickness = 4, .medium = {.glass = "N-BK7", .nd = 1.5168}, .stop = true},
                {.radius = 0, .thickness = 2, .medium = {.nd = 1.4}, .aspheric = {{4, 1e-5}}},
                {.radius = -40, .thickness = 55, .medium = {.nd = 1.1}, .conic = -0.5}};
  const Prescription r = petzval::reverse(p);
  EXPECT_EQ(r.object_space, p.surfaces[2].medium);
  EXPECT_EQ(r.surfaces[0].medium, p.surfaces[1].medium);
  EXPECT_EQ(r.surfaces[1].medium, p.surfaces[0].medium);
  EXPECT_EQ(r.surfaces[2].medium, p.object_space);
  EXPECT_EQ(r.surfaces[0].radius, 40);
  EXPECT_EQ(r.surfaces[0].conic, -0.5);
  EXPECT_EQ(r.surfaces[0].thickness, 2);
  EXPECT_FALSE(std::signbit(r.surfaces[1].radius));
  EXPECT_EQ(r.surfaces[1].aspheric[0].coefficient, -1e-5);
  EXPECT_EQ(r.surfaces[1].thickness, 4);
  EXPECT_EQ(r.surfaces[2].thickness, 0);
  EXPECT_TRUE(r.surfaces[2].stop);
  EXPECT_EQ(petzval::testing::message([] { petzval::reverse({}); }),
            "lens: no surfaces to reverse, wanted one at least");
}

}  // namespace
