// SPDX-License-Identifier: Apache-2.0
// Ray fans, field curvature, distortion, MTF, encircled energy and longitudinal aberration.
#include "petzval/analysis/aberrations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

constexpr double far = -std::numeric_limits<double>::infinity();

Lens double_gauss() {
  return compile(testing::data_prescription("double_gauss_100mm_f2.0"), std::array{486.1327, 587.5618, 656.2725});
}

TEST(RayFans, OnTheAxisBothSectionsAreEqualAndOdd) {
  const std::array fields{0.0};
  for (const RayFan& fan : ray_fans(double_gauss(), far, fields, 21).values) {
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
  const auto at = [&](double dz) { return ray_fans(with_film(lens, lens.film_z() + dz), far, fields, 9).values; };
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
  for (const auto& point : fans[1][1].points) missing += !point.tangential_mm;
  EXPECT_GT(missing, 0);
  testing::expect_error([&] { ray_fans(double_gauss(), far, fields, 1); }, {"count", 1, 2});
}

// In the film of the tangential focus the tangential fan begins with slope 0, and likewise the sagittal fan.
// The fans have steps of 0.001, with slopes of third order of 4e-8.
TEST(FieldCurvature, IsTheFocusOfTheFans) {
  const Lens lens = testing::data_lens("cooke_triplet_50mm_f5");
  const std::array fields{radians(3.0), radians(12.0), radians(18.0)};
  for (const FieldFocus& focus : field_curvature(lens, far, fields)) {
    ASSERT_TRUE(focus.tangential_mm && focus.sagittal_mm);
    const std::array own{focus.field_rad};
    const auto slope = [&](double dz, auto member) {
      const auto fan = ray_fans(with_film(lens, lens.film_z() + dz), far, own, 2001)[0][0];
      return (*(fan.points[1001].*member) - *(fan.points[999].*member)) / 0.002;
    };
    EXPECT_NEAR(slope(*focus.tangential_mm, &RayFan::Point::tangential_mm), 0, 1e-7);
    EXPECT_NEAR(slope(*focus.sagittal_mm, &RayFan::Point::sagittal_mm), 0, 1e-7);
    EXPECT_GT(std::abs(slope(*focus.tangential_mm + 1, &RayFan::Point::tangential_mm)), 0.01);
  }
}

// Aspheres with r^3 have slopes of first order in the aperture: foci and heights approach their limits slowly.
TEST(FieldCurvature, OfACubicAsphereIsTheParaxialFocus) {
  const Lens lens = testing::data_lens("phone_5.6mm_f3.5");
  const std::array fields{0.0, radians(1e-3)};
  const auto foci = field_curvature(lens, far, fields);
  const double paraxial = paraxial_image_z(lens, far) - lens.film_z();
  ASSERT_TRUE(foci[0].tangential_mm && foci[0].sagittal_mm);
  EXPECT_NEAR(*foci[0].tangential_mm, paraxial, 1e-6 * std::abs(paraxial));
  EXPECT_NEAR(*foci[0].sagittal_mm, paraxial, 1e-6 * std::abs(paraxial));
}

// The height of the paraxial chief ray, in air: focal length times the field.
TEST(DistortionPercent, ScaleIsTheLimitOfSmallFields) {
  for (const char* name : {"phone_5.6mm_f3.5", "mirror_ritchey_chretien_57.6m_f24"}) {
    const Lens open = testing::data_lens(name), lens = with_film(open, paraxial_image_z(open, far));
    const std::array fields{radians(0.08)};
    const auto found = distortion_percent(lens, far, fields);
    const double height = first_order(lens).effective_focal_length * std::tan(fields[0]);
    EXPECT_NEAR(*found[0].f_tan_theta_percent, 100 * (std::abs(*found[0].height_mm / height) - 1), 1e-5) << name;
    const auto by_nm = distortion_percent(lens, far, fields, Wavelength::nm(lens.wavelengths_nm()[0]));
    EXPECT_EQ(by_nm[0].height_mm, found[0].height_mm) << name;
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
    EXPECT_NEAR(film - *focus.tangential_mm, z, 2e-4);
    EXPECT_NEAR(film - *focus.sagittal_mm, z, 2e-4);
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
  const auto found = geometric_mtf(spot_diagram(blurred, far, fields, 16384), frequencies).values;
  const auto ideal = geometric_mtf(spot_diagram(sharp, far, fields, 1024), frequencies).values;
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
    return geometric_mtf(spot_diagram(lens, far, fields, rays), frequencies).values;
  };
  const auto coarse = at(32768), fine = at(327680);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_NEAR(coarse[i].tangential, fine[i].tangential, 1e-3) << i;
    EXPECT_NEAR(coarse[i].sagittal, fine[i].sagittal, 1e-3) << i;
  }
  const auto spots = spot_diagram(lens, far, fields, 4096);
  const std::array green{0.0, 1.0, 0.0};
  const auto one = geometric_mtf(spots, frequencies, green);
  const auto same = geometric_mtf({{spots[0][1]}, 1}, frequencies);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(one[0][i].tangential, same[0][i].tangential, 1e-12);
  testing::expect_error([&] { geometric_mtf({spots.values, 4}, frequencies); }, {6, 4});
  testing::expect_error([&] { geometric_mtf(spots, frequencies, std::array{1.0}); }, {6, 3, 1});
}

// Frequencies in an even ladder share their phases; a single frequency has its own.
TEST(GeometricMtf, OfALadderEqualsSingleFrequencies) {
  const Lens lens = double_gauss();
  const auto spots = spot_diagram(lens, far, std::array{0.0, radians(10.0)}, 1024);
  const std::array ladder{0.0, 5.0, 10.0, 15.0, 40.0, 100.0};
  const std::array mixed{10.0, 33.3, 0.0, 71.7};
  for (const std::span<const double> frequencies : {std::span<const double>(ladder), std::span<const double>(mixed)}) {
    const auto all = geometric_mtf(spots, frequencies).values;
    ASSERT_EQ(all.size(), 2 * frequencies.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      std::complex<double> sum = 0;
      double rays = 0;
      for (const Spot& spot : spots[i / frequencies.size()]) {
        for (const double y : spot.y)
          sum += std::polar(1.0, 2 * std::numbers::pi * all[i].frequency_per_mm * y), ++rays;
      }
      EXPECT_EQ(all[i].frequency_per_mm, frequencies[i % frequencies.size()]);
      EXPECT_NEAR(all[i].tangential, std::abs(sum) / rays, 1e-11) << i;
    }
  }
  EXPECT_TRUE(geometric_mtf(spots, {}).values.empty());
}

// The figures print the largest sampling error. It must be at least the difference from 16 times as many rays.
TEST(GeometricMtf, OfManyFieldsBoundsItsError) {
  const std::array frequencies{10.0, 20.0, 40.0}, weights{1.0, 2.0, 1.0};
  for (const char* id : {"double_gauss_100mm_f1.35", "double_gauss_100mm_f2.0", "cooke_triplet_50mm_f5",
                         "retrofocus_100mm_f2.8", "telephoto_100mm_f5.6"}) {
    const Lens lens = compile(testing::data_prescription(id), std::array{486.1327, 587.5618, 656.2725},
                              {.missing_glass = MissingGlass::abbe});
    std::vector<double> fields;
    for (int k = 0; k <= 6; ++k) fields.push_back(radians(2.0 * k));
    const auto found = geometric_mtf(spot_diagram(lens, far, fields, 4096), frequencies, weights).values;
    const auto fine = geometric_mtf(spot_diagram(lens, far, fields, 65536), frequencies, weights).values;
    ASSERT_EQ(found.size(), fields.size() * frequencies.size());
    double stated = 0, error = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].field_rad, fields[i / 3]);
      EXPECT_EQ(found[i].frequency_per_mm, frequencies[i % 3]);
      stated = std::max(stated, found[i].sampling_error);
      error = std::max(
          {error, std::abs(found[i].tangential - fine[i].tangential), std::abs(found[i].sagittal - fine[i].sagittal)});
    }
    EXPECT_LT(error, stated) << id;
    EXPECT_LT(error, 0.01) << id;
  }
}

// A defocused parabolic mirror has a uniform disc of rays: a radius r holds the fraction (r / R)^2.
TEST(EncircledEnergy, OfADiscIsTheSquareOfTheRadius) {
  Prescription p;
  p.name = "parabola";
  p.surfaces = {{.thickness = 900, .semi_diameter = 5, .stop = true},
                {.radius = -2000, .thickness = -1000, .semi_diameter = 8, .conic = -1, .mirror = true}};
  const Lens sharp = compile(p), blurred = with_film(sharp, sharp.film_z() - 2);
  const std::array fractions{0.0, 0.1, 0.25, 0.5, 0.81, 1.0};
  const auto found = encircled_energy(spot_diagram(blurred, far, std::array{0.0}, 16384), fractions).values;
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    EXPECT_EQ(found[i].fraction, fractions[i]);
    EXPECT_NEAR(*found[i].radius_mm, 0.01 * std::sqrt(fractions[i]), 1e-5) << fractions[i];
    EXPECT_LT(found[i].sampling_error_mm, 5e-5);
  }
  testing::expect_error([&] { encircled_energy({{}, 1}, std::array{1.5}); }, {"fraction", 1.5});
}

TEST(EncircledEnergy, ScalesWithTheLensAndFollowsWeights) {
  const Prescription prescription = testing::data_prescription("double_gauss_100mm_f2.0");
  const std::array wavelengths{486.1327, 587.5618, 656.2725};
  const std::array fractions{0.5, 0.9}, fields{0.0, radians(12.0)};
  const auto at = [&](double factor, std::span<const double> weights) {
    const Lens lens = compile(scale(prescription, factor), wavelengths);
    return encircled_energy(spot_diagram(lens, far, fields, 2048), fractions, weights, 2).values;
  };
  const auto one = at(1, {}), two = at(2, {});
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(*two[i].radius_mm, 2 * *one[i].radius_mm, 1e-9);
  EXPECT_LT(*one[2].radius_mm, *one[3].radius_mm);
  // With one wavelength of weight 1, half of its rays are within the radius of 0.5.
  const auto green = at(1, std::array{0.0, 1.0, 0.0});
  const Spot spot = spot_diagram(compile(prescription, wavelengths), far, fields, 2048)[1][1];
  double inside = 0;
  for (std::size_t i = 0; i < spot.x.size(); ++i) {
    inside +=
        std::hypot(spot.x[i] - spot.size.centroid.x, spot.y[i] - spot.size.centroid.y) <= *green[2].radius_mm + 1e-12;
  }
  EXPECT_NEAR(inside / static_cast<double>(spot.x.size()), 0.5, 1e-3);
}

TEST(EncircledEnergy, BoundsItsErrorAndHasNoRadiusWithoutRays) {
  const Lens lens = double_gauss();
  const std::array fractions{0.5, 0.8, 0.9, 0.95};
  const std::array fields{0.0, radians(8.0), radians(12.0)};
  const auto found = encircled_energy(spot_diagram(lens, far, fields, 4096), fractions).values;
  const auto fine = encircled_energy(spot_diagram(lens, far, fields, 65536), fractions).values;
  double stated = 0, error = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    stated = std::max(stated, found[i].sampling_error_mm);
    error = std::max(error, std::abs(*found[i].radius_mm - *fine[i].radius_mm));
  }
  EXPECT_LT(error, stated);
  const Lens closed = with_semi_diameter(lens, *lens.stop(), 0);
  EXPECT_FALSE(encircled_energy(spot_diagram(closed, far, fields, 64), fractions)[0][0].radius_mm);
}

// The fan of the axial point is 0 on the film in which its ray crosses the axis.
TEST(LongitudinalAberration, IsWhereTheAxialFanVanishes) {
  const Lens lens = double_gauss();
  const auto foci = longitudinal_aberration(lens, far, 5);
  ASSERT_EQ(foci.values.size(), 15u);
  for (const AxialRayFocus& focus : foci.values) {
    ASSERT_TRUE(focus.tangential_mm || focus.pupil == 1);
    if (!focus.tangential_mm || focus.pupil == 0) continue;
    EXPECT_NEAR(*focus.tangential_mm, *focus.sagittal_mm, 1e-10);
    const Lens moved = with_film(lens, lens.film_z() + *focus.tangential_mm);
    const auto fan = ray_fans(moved, far, std::array{0.0}, 9)[0][focus.wavelength];
    const auto at = static_cast<std::size_t>(4 + std::lround(4 * focus.pupil));
    EXPECT_NEAR(*fan.points[at].tangential_mm, 0, 1e-10);
  }
  // Near the axis the focus is paraxial.
  const double paraxial = paraxial_image_z(lens, far, 0, Meridian::y) - lens.film_z();
  EXPECT_NEAR(*foci[0][0].tangential_mm, paraxial, 1e-4);
  testing::expect_error([&] { longitudinal_aberration(lens, far, 1); }, {"count", 1, 2});
}

TEST(LongitudinalAberration, ScalesWithTheLensAndIsZeroForAPerfectMirror) {
  const Prescription prescription = testing::data_prescription("cooke_triplet_50mm_f5");
  const auto one = longitudinal_aberration(compile(prescription), far, 4).values;
  const auto two = longitudinal_aberration(compile(scale(prescription, 2)), far, 4).values;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(*two[i].tangential_mm, 2 * *one[i].tangential_mm, 1e-8);
  for (const AxialRayFocus& focus :
       longitudinal_aberration(testing::data_lens("mirror_newton_200mm_f8"), far, 5).values) {
    EXPECT_NEAR(focus.tangential_mm.value_or(1), 0, 1e-6);
  }
}

TEST(LongitudinalAberration, LeavesOutClippedRays) {
  Prescription p;
  p.name = "parabola with a hole";
  p.surfaces = {{.thickness = 900, .semi_diameter = 5, .stop = true},
                {.radius = -2000, .thickness = -1000, .semi_diameter = 4, .conic = -1, .mirror = true}};
  p.surfaces[1].obscuration_semi_diameter = 2;
  const auto found = longitudinal_aberration(compile(p), far, 11);
  for (const AxialRayFocus& focus : found.values) {
    EXPECT_EQ(focus.tangential_mm.has_value(), 5 * focus.pupil > 2.1 && 5 * focus.pupil < 4.1) << focus.pupil;
  }
}

TEST(DiffractionLimitedMtf, HasTheClosedForm) {
  EXPECT_NEAR(diffraction_limited_mtf(0, 550, 8), 1, 1e-15);
  EXPECT_NEAR(diffraction_limited_mtf(0.5 / (550e-6 * 8), 550, 8), 0.391002218955771, 1e-12);
  EXPECT_NEAR(diffraction_limited_mtf(1 / (550e-6 * 8), 550, 8), 0, 1e-9);
}

}  // namespace
}  // namespace petzval
