// SPDX-License-Identifier: Apache-2.0
#include "petzval/paraxial/first_order.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "../data_lenses.hpp"
#include "paraxial/ray_matrix.hpp"

namespace petzval {
namespace first_order_test {

using testing::data_lens;
using testing::data_prescriptions;
constexpr double infinity = std::numeric_limits<double>::infinity();

RayMatrix transfer(double distance, double n) { return {1, distance / n, 0, 1}; }

/// The matrix from the plane at z_object to the plane at z_image.
RayMatrix between(const Lens& lens, double z_object, double z_image, Meridian meridian = Meridian::y) {
  const std::size_t count = lens.surface_count();
  return transfer(-z_object, signed_index(lens, 0))
      .then(ray_matrix(lens, 0, count, 0, meridian))
      .then(transfer(z_image - lens.surfaces().back().vertex_z, signed_index(lens, count)));
}

Prescription element(double n, double r1, double r2, double thickness) {
  Prescription p;
  p.name = "element";
  p.surfaces = {{.radius = r1, .thickness = thickness, .medium = {.nd = n}}, {.radius = r2}};
  return p;
}

std::array<double, 11> numbers(const FirstOrder& d) {
  return {d.power,
          d.effective_focal_length,
          d.front_focal_z,
          d.rear_focal_z,
          d.front_principal_z,
          d.rear_principal_z,
          d.front_nodal_z,
          d.rear_nodal_z,
          d.front_focal_distance,
          d.back_focal_distance,
          d.petzval_sum};
}

void expect_no_nan(const FirstOrder& data) {
  for (const double value : numbers(data)) EXPECT_FALSE(std::isnan(value));
}

TEST(FirstOrder, SqueezeEqualsTheDeclaredSqueeze) {
  EXPECT_NEAR(squeeze(data_lens("anamorphic_60mm_2x")), 60.55 / 31.49, 1e-3);  // as declared
  EXPECT_EQ(squeeze(data_lens("double_gauss_100mm_f2.0")), 1);
  EXPECT_EQ(squeeze(data_lens("cylinder_3.9mm")), 0);  // power in one section only
}

TEST(RayMatrix, FollowedByItsInverseIsTheIdentity) {
  const RayMatrix matrix = ray_matrix(data_lens("double_gauss_100mm_f2.0"), 0, 4).on_slopes(1, 1.5);
  const RayMatrix identity = matrix.then(matrix.inverse());
  EXPECT_NEAR(identity.a, 1, 1e-14);
  EXPECT_NEAR(identity.b, 0, 1e-13);
  EXPECT_NEAR(identity.c, 0, 1e-15);
  EXPECT_NEAR(identity.d, 1, 1e-14);
}

TEST(RayMatrix, ProductOfSectionsIsTheMatrixOfTheLens) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const RayMatrix whole = ray_matrix(lens, 0, lens.surface_count());
  const auto all = ray_matrices_to(lens);
  ASSERT_EQ(all.size(), lens.surface_count());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const RayMatrix one = ray_matrix_to(lens, i);
    EXPECT_TRUE(all[i].a == one.a && all[i].b == one.b && all[i].c == one.c && all[i].d == one.d) << i;
  }
  const RayMatrix parts = ray_matrix_to(lens, 5).then(ray_matrix(lens, 5, 99));
  EXPECT_NEAR(parts.a, whole.a, 1e-14);
  EXPECT_NEAR(parts.b, whole.b, 1e-12);
  EXPECT_NEAR(parts.c, whole.c, 1e-16);
  EXPECT_NEAR(parts.d, whole.d, 1e-14);
}

TEST(FirstOrder, EveryLensIsWithinTwoPercentOfTheDeclaredFocalLength) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens, 0, main_meridian(lens));
    ASSERT_FALSE(data.afocal);
    for (const double value : numbers(data)) EXPECT_TRUE(std::isfinite(value));
    ASSERT_TRUE(p.focal_length_mm.has_value());
    EXPECT_NEAR(data.effective_focal_length, *p.focal_length_mm, 0.02 * *p.focal_length_mm);
  }
}

TEST(FirstOrder, ReversedLensHasEqualPower) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    for (const Meridian meridian : {Meridian::y, Meridian::x}) {
      const FirstOrder ahead = first_order(compile(p), 0, meridian);
      const FirstOrder back = first_order(compile(reverse(p)), 0, meridian);
      EXPECT_EQ(ahead.afocal, back.afocal);
      if (ahead.afocal) continue;
      const double f = std::abs(ahead.effective_focal_length);
      EXPECT_NEAR(std::abs(back.effective_focal_length), f, 1e-12 * f);
      EXPECT_NEAR(std::abs(back.petzval_sum), std::abs(ahead.petzval_sum),
                  1e-13 * (1 / f + std::abs(ahead.petzval_sum)));
      if (ahead.image_index < 0) continue;  // reversed, light would start towards -z
      const double size = f + std::abs(ahead.front_focal_distance) + std::abs(ahead.back_focal_distance);
      EXPECT_NEAR(back.back_focal_distance, -ahead.front_focal_distance, 1e-12 * size);
      EXPECT_NEAR(back.front_focal_distance, -ahead.back_focal_distance, 1e-12 * size);
    }
  }
}

TEST(FirstOrder, ScalesWithTheLensToTheBit) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const auto small = numbers(first_order(compile(p)));
    const auto large = numbers(first_order(compile(scale(p, 8))));
    for (std::size_t i = 0; i < small.size(); ++i) {
      const bool reciprocal = i == 0 || i == small.size() - 1;
      EXPECT_EQ(large[i], reciprocal ? small[i] / 8 : small[i] * 8) << i;
    }
  }
}

TEST(FirstOrder, PrincipalPlanesImageEachOtherAtMagnificationOne) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens);
    const RayMatrix m = between(lens, data.front_principal_z, data.rear_principal_z);
    const RayMatrix whole = ray_matrix(lens, 0, lens.surface_count());
    const double rounding =
        1e-13 * (1 + std::abs(whole.a) + std::abs(whole.d)) * (1 + std::abs(whole.a) + std::abs(whole.d));
    EXPECT_NEAR(m.a, 1, rounding);
    EXPECT_NEAR(m.d, 1, rounding);
    EXPECT_NEAR(m.b, 0, rounding * std::abs(data.effective_focal_length));
  }
}

TEST(FirstOrder, RaysThroughTheNodalPointsKeepTheirSlope) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens);
    const RayMatrix m = between(lens, data.front_nodal_z, data.rear_nodal_z);
    const RayMatrix whole = ray_matrix(lens, 0, lens.surface_count());
    const double rounding =
        1e-13 * (1 + std::abs(whole.a) + std::abs(whole.d)) * (1 + std::abs(whole.a) + std::abs(whole.d));
    EXPECT_NEAR(m.b, 0, rounding * std::abs(data.effective_focal_length));
    EXPECT_NEAR(m.d * data.object_index / data.image_index, 1, rounding);
  }
}

TEST(FirstOrder, EyeIncludesTheVitreous) {
  const FirstOrder data = first_order(data_lens("eye_gullstrand_le_grand"));
  EXPECT_NEAR(data.power * 1000, 59.94, 0.005);  // dioptres, from the note of the file
  EXPECT_NEAR(data.rear_focal_z - data.rear_principal_z, 1.336 * data.effective_focal_length, 1e-12);
  EXPECT_NEAR(data.front_principal_z - data.front_focal_z, data.effective_focal_length, 1e-12);
}

TEST(FirstOrder, MirrorFocusesInFront) {
  const FirstOrder data = first_order(data_lens("mirror_newton_200mm_f8"));
  EXPECT_EQ(data.effective_focal_length, 200);
  EXPECT_EQ(data.back_focal_distance, -200);
  EXPECT_EQ(data.image_index, -1);
  EXPECT_EQ(data.front_nodal_z, -400);  // the centre of curvature
  EXPECT_EQ(data.petzval_sum, -1.0 / 200);
}

TEST(FirstOrder, SquareTermOfAnAsphereAddsToTheCurvature) {
  Prescription sphere = element(1.5, 40, -60, 7), asphere = sphere;
  asphere.surfaces[0].radius = 0;
  asphere.surfaces[0].aspheric = {{.order = 2, .coefficient = 1.0 / 80}};
  EXPECT_NEAR(first_order(compile(asphere)).power, first_order(compile(sphere)).power, 1e-17);
}

TEST(FirstOrder, CylinderHasPowerInItsMeridianOnly) {
  const Lens lens = data_lens("cylinder_3.9mm");
  EXPECT_FALSE(first_order(lens, 0, Meridian::y).afocal);
  EXPECT_TRUE(first_order(lens, 0, Meridian::x).afocal);
  EXPECT_EQ(main_meridian(lens), Meridian::y);
  Prescription turned = testing::data_prescription("cylinder_3.9mm");
  turned.surfaces[0].curved_in = Section::x;
  EXPECT_EQ(main_meridian(compile(turned)), Meridian::x);
  EXPECT_EQ(first_order(compile(turned), 0, Meridian::x).power, first_order(lens).power);
}

TEST(FirstOrder, ReportsAfocalLenses) {
  std::vector<Prescription> afocal{element(1.5, 0, 0, 10), element(1.0, 30, -30, 5)};
  Prescription plane;
  plane.name = "plane";
  plane.surfaces = {{.medium = {.nd = 1.7}}};
  afocal.push_back(plane);
  // Keplerian and Galilean telescopes: the foci of both lenses coincide.
  for (const double r : {20.0, -12.0}) {
    Prescription telescope = element(1.6, 90, -70, 6), eyepiece = element(1.7, r, -1.3 * r, 3);
    telescope.surfaces.back().thickness =
        first_order(compile(telescope)).back_focal_distance - first_order(compile(eyepiece)).front_focal_distance;
    telescope.surfaces.insert(telescope.surfaces.end(), eyepiece.surfaces.begin(), eyepiece.surfaces.end());
    afocal.push_back(telescope);
  }
  for (const Prescription& p : afocal) {
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens);
    EXPECT_TRUE(data.afocal);
    EXPECT_EQ(data.power, 0);
    EXPECT_EQ(data.effective_focal_length, infinity);
    EXPECT_EQ(data.front_focal_z, -infinity);
    EXPECT_EQ(data.rear_principal_z, infinity);
    expect_no_nan(data);
    EXPECT_EQ(paraxial_image_z(lens, -infinity), infinity);
    EXPECT_TRUE(std::isfinite(paraxial_image_z(lens, -1000)));
  }
}

TEST(FirstOrder, WeakLensIsNotAfocal) {
  const FirstOrder data = first_order(compile(element(1.5, 1e9, 0, 1)));
  EXPECT_FALSE(data.afocal);
  EXPECT_NEAR(data.effective_focal_length, 2e9, 1e-3);
}

TEST(FirstOrder, FocalLengthsBeyondTheRangeAreAfocal) {
  for (const double r : {1e101, 1.7e308}) EXPECT_TRUE(first_order(compile(element(1.5, r, -r, 5))).afocal) << r;
  EXPECT_FALSE(first_order(compile(element(1.5, 1e99, -1e99, 5))).afocal);

  Prescription steep;  // alternates powers of 1e12 and distances of 1e9
  steep.name = "steep";
  steep.surfaces.assign(40, {.radius = 1e-12, .thickness = 1e9, .medium = {.nd = 1.5}});
  for (std::size_t i = 0; i < 40; i += 2) steep.surfaces[i].medium.nd = 1;
  const FirstOrder data = first_order(compile(steep));
  EXPECT_TRUE(data.afocal);
  expect_no_nan(data);
}

TEST(FirstOrder, IsNeverNaN) {
  for (const double r : {1e-12, 1e-9, 1e12, 1e300, 1e308}) {
    for (const double t : {0.0, 1e-9, 1e9}) {
      SCOPED_TRACE(std::to_string(r) + " " + std::to_string(t));
      expect_no_nan(first_order(compile(element(1.5, r, -r, t))));
    }
  }
}

TEST(FirstOrder, ConcentricSurfacesHavePrincipalPlanesAtTheCentre) {
  const FirstOrder shell = first_order(compile(element(1.5, 50, 40, 10)));
  EXPECT_NEAR(shell.front_nodal_z, 50, 1e-12);
  EXPECT_NEAR(shell.rear_nodal_z, 50, 1e-12);
  const FirstOrder ball = first_order(compile(element(1.5168, 5, -5, 10)));
  EXPECT_NEAR(ball.effective_focal_length, 1.5168 * 10 / (4 * 0.5168), 1e-14 * 10);
  EXPECT_NEAR(ball.front_principal_z, 5, 1e-13);
}

TEST(Lensmaker, AgreesWithTheMatrices) {
  for (const double thickness : {0.0, 3.0, 40.0}) {
    for (const auto& [r1, r2] : {std::pair{50.0, -50.0}, {50.0, 50.0}, {0.0, -30.0}, {-20.0, 35.0}}) {
      const double c1 = r1 == 0 ? 0 : 1 / r1, c2 = r2 == 0 ? 0 : 1 / r2;
      const FirstOrder data = first_order(compile(element(1.7, r1, r2, thickness)));
      const double f = lensmaker_focal_length(1.7, c1, c2, thickness);
      if (data.afocal) {
        EXPECT_EQ(f, infinity);
      } else {
        EXPECT_NEAR(f, data.effective_focal_length, 1e-12 * std::abs(f));
      }
    }
  }
  EXPECT_EQ(lensmaker_focal_length(1.5, 0, 0, 5), infinity);
}

TEST(ParaxialImage, FollowsNewtonsEquation) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens);
    const double f = data.effective_focal_length;
    for (const double x : {-1e6, -30.0, -1.0, -0.1, 0.4, 2.0}) {
      const double image = paraxial_image_z(lens, data.front_focal_z + x * std::abs(f));
      const double extension = -data.object_index * data.image_index * std::abs(f) / x;
      const double size = std::abs(f) + std::abs(data.front_focal_z) + std::abs(data.rear_focal_z);
      EXPECT_NEAR(
          image - data.rear_focal_z, extension,
          1e-12 * (size + std::abs(extension)) * (1 + 1 / std::abs(x)) * (1 + std::abs(data.front_focal_z / f)));
    }
  }
}

TEST(ParaxialImage, IsInfiniteAtTheFrontFocusAndTheRearFocusOfInfinity) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const FirstOrder data = first_order(lens);
    EXPECT_EQ(paraxial_image_z(lens, data.front_focal_z), infinity);
    EXPECT_NEAR(paraxial_image_z(lens, -infinity), data.rear_focal_z, 1e-14 * std::abs(data.rear_focal_z));
    EXPECT_EQ(paraxial_image_z(lens, -1e300), paraxial_image_z(lens, -infinity));
  }
}

}  // namespace first_order_test
}  // namespace petzval
