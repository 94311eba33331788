// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/trace/trace.hpp"

namespace reverse_test {

using petzval::testing::expect_error;

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

/// Traces a ray to the scene through the lens and the same ray to the film through the reversed lens. Returns true
/// if the ray passed.
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

// A ray to the scene through a lens equals a ray to the film through the reversed lens: refracting lenses, even and odd
// numbers of mirrors, aspheres, cylinders, an eye with water as image medium.
TEST(Reverse, LightTakesTheReversedPath) {
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
      // Also traces a random ray; most random rays do not pass.
      const double bend = 0.1 * uniform(random), norm = std::sqrt(1 + 2 * bend * d.x + bend * bend);
      expect_same_way(lens, reversed, {exit.ray.origin, {-(d.x + bend) / norm, -d.y / norm, -d.z / norm}});
    }
    EXPECT_GT(through, 5);
  }
}

/// True if the signed index in front of a reversed lens is positive: false for an odd number of mirrors.
bool ends_forwards(const petzval::Lens& lens) { return petzval::signed_index(lens, lens.surface_count()) > 0; }

TEST(Reverse, SwapsPrincipalPlanesAndPupils) {
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    const petzval::Lens lens = petzval::compile(p), reversed = petzval::compile(petzval::reverse(p));
    if (!ends_forwards(lens)) continue;
    const double z_last = lens.surfaces().back().vertex_z;
    for (const auto meridian : {petzval::Meridian::y, petzval::Meridian::x}) {
      SCOPED_TRACE(p.id + (meridian == petzval::Meridian::y ? " y" : " x"));
      const auto before = petzval::pupils(lens, 0, meridian), after = petzval::pupils(reversed, 0, meridian);
      EXPECT_EQ(after.stop, lens.surface_count() - 1 - before.stop);
      const auto expect_swapped = [&](const petzval::Pupil& was, const petzval::Pupil& is) {
        EXPECT_NEAR(is.z, z_last - was.z, 1e-12 * (1 + std::abs(z_last) + std::abs(was.z)));
        EXPECT_NEAR(is.diameter, was.diameter, 1e-12 * was.diameter);
      };
      expect_swapped(before.entrance, after.exit);
      expect_swapped(before.exit, after.entrance);

      const auto there = petzval::first_order(lens, 0, meridian), back = petzval::first_order(reversed, 0, meridian);
      ASSERT_EQ(there.afocal, back.afocal);
      if (there.afocal) continue;
      const double size = std::abs(z_last) + std::abs(there.effective_focal_length) +
                          std::abs(there.front_principal_z) + std::abs(there.rear_principal_z);
      EXPECT_NEAR(back.effective_focal_length, there.effective_focal_length, 1e-12 * size);
      EXPECT_NEAR(back.front_principal_z, z_last - there.rear_principal_z, 1e-12 * size);
      EXPECT_NEAR(back.rear_principal_z, z_last - there.front_principal_z, 1e-12 * size);
      EXPECT_NEAR(back.front_nodal_z, z_last - there.rear_nodal_z, 1e-12 * size);
    }
  }
}

// A chief ray is the same line in both directions: aimed from a point behind the lens through the reversed lens, it
// leaves along the original line.
TEST(Reverse, ChiefRaysKeepTheirLines) {
  int compared = 0;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    const petzval::Lens lens = petzval::compile(p), reversed = petzval::compile(petzval::reverse(p));
    if (!ends_forwards(lens)) continue;
    const double pupil_z = petzval::pupils(reversed).entrance.z;
    for (const double share : {0.2, 0.6, 1.0}) {
      SCOPED_TRACE(p.id + " " + std::to_string(share));
      const double field = share * petzval::radians(p.half_field_deg.value_or(1));
      const auto chief = petzval::chief_ray(lens, {field, -std::numeric_limits<double>::infinity()});
      if (!chief || !chief.end.transmitted()) continue;
      // A point of the ray behind the lens, in the reversed frame. Farther out, chief rays of the phone lens cross:
      // a point has two chief rays.
      const Ray<double> behind = turned(lens, chief.end.ray);
      const double focal_length = std::abs(*p.focal_length_mm);
      const double t = (std::min(0.0, pupil_z) - 2 * focal_length - behind.origin.z) / behind.direction.z;
      const double z = behind.origin.z + t * behind.direction.z, y = behind.origin.y + t * behind.direction.y;
      const auto back = petzval::chief_ray(reversed, {std::atan2(y, pupil_z - z), z});
      ASSERT_TRUE(back);
      EXPECT_LE(back.residual, 1e-12);
      const Ray<double> entered = turned(lens, chief.ray), left = back.end.ray;
      const auto offset = left.origin - entered.origin;
      const double sine = left.direction.y * entered.direction.z - left.direction.z * entered.direction.y;
      const double miss = offset.y * entered.direction.z - offset.z * entered.direction.y;
      EXPECT_GT(left.direction.y * -entered.direction.y + left.direction.z * -entered.direction.z, 0);
      EXPECT_NEAR(sine, 0, 1e-12);
      EXPECT_NEAR(miss, 0, 1e-12 * (focal_length + std::abs(offset.z)));
      ++compared;
    }
  }
  EXPECT_GT(compared, 150);
}

TEST(Reverse, TwiceRestoresTheLensExceptOneSidedData) {
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    Prescription expected = p;
    expected.surfaces.back().thickness = 0;
    expected.f_number.reset();
    expected.half_field_deg.reset();
    expected.image_diagonal_mm.reset();
    expected.image_distance.reset();
    for (petzval::Configuration& c : expected.configurations) {
      c.f_number = c.half_field_deg = c.image_diagonal_mm = std::nullopt;
    }
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
  expect_error([] { petzval::reverse({}); }, {"lens", "surfaces"});
}

}  // namespace reverse_test
