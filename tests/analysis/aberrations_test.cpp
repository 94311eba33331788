// SPDX-License-Identifier: Apache-2.0
// Ray fans, field curvature and distortion.
#include "petzval/analysis/aberrations.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"

namespace petzval {
namespace {

constexpr double far = -std::numeric_limits<double>::infinity();

Lens double_gauss() {
  return compile(testing::data_prescription("double_gauss_100mm_f2.0"), std::array{486.1327, 587.5618, 656.2725});
}

TEST(RayFans, OnTheAxisBothSectionsAreEqualAndOdd) {
  const std::array fields{0.0};
  for (const RayFan& fan : ray_fans(double_gauss(), far, fields, 21)) {
    for (std::size_t i = 0; i < fan.points.size(); ++i) {
      const RayFan::Point &p = fan.points[i], &q = fan.points[fan.points.size() - 1 - i];
      EXPECT_TRUE(p.tangential_mm || std::abs(p.pupil) > 0.95);
      if (!p.tangential_mm) continue;
      EXPECT_NEAR(*p.tangential_mm, *p.sagittal_mm, 1e-12);
      EXPECT_NEAR(*p.tangential_mm, -*q.tangential_mm, 1e-12);
    }
  }
}

// A film that moves by dz changes a fan by dz times the slope of the ray relative to the chief ray.
TEST(RayFans, AreLinearInTheFilmPosition) {
  const Lens lens = double_gauss();
  const std::array fields{radians(10.0)};
  const auto at = [&](double dz) { return ray_fans(with_film(lens, lens.film_z() + dz), far, fields, 9); };
  const auto before = at(-0.1), here = at(0), behind = at(0.1);
  EXPECT_NEAR(*here[lens.primary_wavelength()].points[4].tangential_mm, 0, 1e-12);  // the chief ray itself
  int seen = 0;
  for (std::size_t f = 0; f < here.size(); ++f) {
    for (std::size_t i = 0; i < here[f].points.size(); ++i) {
      const auto &a = before[f].points[i], &b = here[f].points[i], &c = behind[f].points[i];
      if (!b.tangential_mm) continue;
      ++seen;
      EXPECT_NEAR(*a.tangential_mm + *c.tangential_mm, 2 * *b.tangential_mm, 1e-12);
      EXPECT_NEAR(*a.sagittal_mm + *c.sagittal_mm, 2 * *b.sagittal_mm, 1e-12);
    }
  }
  EXPECT_GT(seen, 15);
}

TEST(RayFans, VignettedRaysAreMissing) {
  const std::array fields{0.0, radians(14.0)};
  const auto fans = ray_fans(double_gauss(), far, fields);
  int missing = 0;
  for (const auto& point : fans[4].points) missing += !point.tangential_mm;
  EXPECT_GT(missing, 0);
  testing::expect_error([&] { ray_fans(double_gauss(), far, fields, 1); }, {"count", 1, 2});
}

// In the film of the tangential focus the tangential fan begins with slope 0, and likewise the sagittal fan.
TEST(FieldCurvature, IsTheFocusOfTheFans) {
  const Lens lens = testing::data_lens("cooke_triplet_50mm_f5");
  const std::array fields{radians(3.0), radians(12.0), radians(18.0)};
  for (const FieldFocus& focus : field_curvature(lens, far, fields)) {
    ASSERT_TRUE(focus.tangential_mm && focus.sagittal_mm);
    const std::array own{focus.field_rad};
    const auto slope = [&](double dz, auto member) {
      const auto fan = ray_fans(with_film(lens, lens.film_z() + dz), far, own, 2001)[0];
      return (*(fan.points[1001].*member) - *(fan.points[999].*member)) / 0.002;
    };
    EXPECT_NEAR(slope(*focus.tangential_mm, &RayFan::Point::tangential_mm), 0, 1e-9);
    EXPECT_NEAR(slope(*focus.sagittal_mm, &RayFan::Point::sagittal_mm), 0, 1e-9);
    EXPECT_GT(std::abs(slope(*focus.tangential_mm + 1, &RayFan::Point::tangential_mm)), 0.01);
  }
}

// A concentric lens has no astigmatism, and foci on a sphere about the common centre.
TEST(FieldCurvature, OfAConcentricMirrorIsASphere) {
  Prescription p;
  p.name = "Schmidt without plate";
  p.surfaces = {{.thickness = 200, .semi_diameter = 2, .stop = true},
                {.radius = -200, .thickness = -100, .semi_diameter = 150, .mirror = true}};
  const Lens lens = compile(p);
  const std::array fields{radians(5.0), radians(20.0)};
  for (const FieldFocus& focus : field_curvature(lens, far, fields)) {
    const double film = lens.film_z(), z = 100 * std::cos(focus.field_rad);  // on the sphere about the stop
    ASSERT_TRUE(focus.tangential_mm && focus.sagittal_mm);
    EXPECT_NEAR(film + *focus.tangential_mm, z, 2e-4);
    EXPECT_NEAR(film + *focus.sagittal_mm, z, 2e-4);
  }
}

TEST(DistortionPercent, IsZeroInTheLimitAndScalesWithNothing) {
  const Prescription prescription = testing::data_prescription("retrofocus_100mm_f2.8");
  const Lens lens = compile(prescription), twice = compile(scale(prescription, 2));
  const std::array fields{0.0, radians(0.05), radians(20.0)};
  const auto one = distortion_percent(lens, far, fields), two = distortion_percent(twice, far, fields);
  EXPECT_EQ(*one[0].f_tan_theta_percent, 0);
  EXPECT_NEAR(*one[1].f_tan_theta_percent, 0, 1e-4);
  EXPECT_LT(*one[2].f_tan_theta_percent, -0.01);
  EXPECT_NEAR(*one[2].f_tan_theta_percent, *two[2].f_tan_theta_percent, 1e-6);
  EXPECT_NEAR(2 * *one[2].height_mm, *two[2].height_mm, 1e-9);
}

TEST(DistortionPercent, OfAFisheyeIsSmallForFTheta) {
  const Lens lens = testing::data_lens("fisheye_8mm_f2.8");
  const std::array fields{radians(60.0), radians(90.0)};
  const auto found = distortion_percent(lens, far, fields);
  EXPECT_LT(std::abs(*found[0].f_theta_percent), 12);
  EXPECT_LT(*found[0].f_tan_theta_percent, -30);
  EXPECT_FALSE(found[1].f_tan_theta_percent);
  EXPECT_TRUE(found[1].f_theta_percent);
}

// A defocused parabolic mirror has a uniform disc of rays to first order: MTF = 2 J1(a) / a, a = 2 pi frequency radius.
TEST(GeometricMtf, OfADiscIsABesselFunction) {
  Prescription p;
  p.name = "parabola";
  p.surfaces = {{.thickness = 900, .semi_diameter = 5, .stop = true},
                {.radius = -2000, .thickness = -1000, .semi_diameter = 8, .conic = -1, .mirror = true}};
  const Lens sharp = compile(p), blurred = with_film(sharp, sharp.film_z() - 2);  // radius 5 / 1000 * 2 = 0.01 mm
  const std::array fields{0.0};
  const std::array frequencies{0.0, 10.0, 25.0, 40.0};
  const auto found = geometric_mtf(spot_diagram(blurred, far, fields, 16384), 1, frequencies);
  const auto ideal = geometric_mtf(spot_diagram(sharp, far, fields, 1024), 1, frequencies);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const double a = 2 * std::numbers::pi * frequencies[i] * 0.01;
    const double wanted = a > 0 ? std::abs(2 * std::cyl_bessel_j(1, a) / a) : 1;
    EXPECT_NEAR(found[i].tangential, wanted, 1e-3);
    EXPECT_NEAR(found[i].sagittal, wanted, 1e-3);
    EXPECT_NEAR(ideal[i].tangential, 1, 1e-9);
  }
}

TEST(GeometricMtf, ConvergesAndFollowsWeights) {
  const Lens lens = double_gauss();
  const std::array fields{0.0, radians(12.0)};
  const std::array frequencies{10.0, 30.0, 50.0};
  const auto at = [&](std::uint32_t rays) {
    return geometric_mtf(spot_diagram(lens, far, fields, rays), 3, frequencies);
  };
  const auto coarse = at(32768), fine = at(327680);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_NEAR(coarse[i].tangential, fine[i].tangential, 1e-3) << i;
    EXPECT_NEAR(coarse[i].sagittal, fine[i].sagittal, 1e-3) << i;
  }
  const auto spots = spot_diagram(lens, far, fields, 4096);
  const std::array green{0.0, 1.0, 0.0};
  const auto one = geometric_mtf(spots, 3, frequencies, green);
  const auto same = geometric_mtf(std::span(spots).subspan(1, 1), 1, frequencies);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(one[i].tangential, same[i].tangential, 1e-12);
  testing::expect_error([&] { geometric_mtf(spots, 4, frequencies); }, {6, 4});
}

TEST(DiffractionLimitedMtf, HasTheClosedForm) {
  EXPECT_NEAR(diffraction_limited_mtf(0, 550, 8), 1, 1e-15);
  EXPECT_NEAR(diffraction_limited_mtf(0.5 / (550e-6 * 8), 550, 8), 0.391002218955771, 1e-12);
  EXPECT_NEAR(diffraction_limited_mtf(1 / (550e-6 * 8), 550, 8), 0, 1e-9);
}

}  // namespace
}  // namespace petzval
