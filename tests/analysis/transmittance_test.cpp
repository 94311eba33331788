// SPDX-License-Identifier: Apache-2.0
// Light that coated and uncoated lenses pass.
#include "petzval/analysis/transmittance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "analysis/pupil_nodes.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace transmittance_test {

constexpr double far = -std::numeric_limits<double>::infinity();

Lens window(double index) {
  Prescription p;
  p.name = "window";
  p.surfaces = {{.thickness = 5, .medium = {.nd = index}, .semi_diameter = 10}, {.thickness = 50, .semi_diameter = 10}};
  return compile(p);
}

TEST(Transmittance, OfAWindowIsTheSquareOfItsSurface) {
  const Lens lens = window(1.5);
  for (const double degrees : {0.0, 30.0, 70.0}) {
    const Ray<double> ray{{0, -1, -2}, {0, std::sin(radians(degrees)), std::cos(radians(degrees))}};
    const double one = surface_light({}, 1, 1.5, std::cos(radians(degrees)), d_line_nm).transmittance();
    EXPECT_NEAR(transmittance(lens, ray).value(),
                one * surface_light({}, 1.5, 1, std::sqrt(1 - std::pow(std::sin(radians(degrees)) / 1.5, 2)), d_line_nm)
                          .transmittance(),
                1e-12)
        << degrees;
  }
  EXPECT_NEAR(transmittance(lens, Ray<double>{{0, 0, -2}, {0, 0, 1}}).value(), 0.96 * 0.96, 1e-12);
}

TEST(Transmittance, OfAReversedRayIsTheSame) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f1.35");
  const Coating stack{
      .layers = {{.index = 1.38, .thickness_nm = 90}, {.index = 2.1, .absorption = 0.01, .thickness_nm = 130}}};
  for (const Coating& coating : {Coating{}, Coating::quarter_wave(), stack}) {
    const Lens coated = with_coating(lens, coating);
    for (const double y : {0.0, 5.0, 20.0}) {
      const Ray<double> ray{{1, y, -20}, {0, 0.05, std::sqrt(1 - 0.0025)}};
      const auto end = trace(lens, ray, {.apertures = false});
      ASSERT_TRUE(end.transmitted());
      const Ray<double> back{end.ray.origin, -end.ray.direction};
      EXPECT_NEAR(transmittance(coated, ray).value(), transmittance(coated, back, {}, Travel::to_scene).value(), 1e-12);
    }
  }
}

// Eight surfaces between air and glass of about 1.6 reflect 5 to 7 % each.
TEST(Transmittance, OfAnUncoatedLensIsThatOfItsAirSurfaces) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f1.35");
  double product = 1;
  for (std::size_t i = 0; i < lens.surface_count(); ++i) {
    const double a = lens.index(i), b = lens.index(i + 1);
    product *= 1 - std::pow((a - b) / (a + b), 2);
  }
  const double axis = transmittance(lens, Ray<double>{{0, 0, -20}, {0, 0, 1}}).value();
  EXPECT_NEAR(axis, product, 1e-12);
  EXPECT_LT(axis, 0.65);
  const double coated = transmittance(with_coating(lens, Coating::quarter_wave()), {.z = far}).value();
  EXPECT_GT(coated, 0.85);
  EXPECT_LT(coated, 1);
  // Angles of incidence up to 40 degrees change little.
  for (const double degrees : {0.0, 12.0}) {
    EXPECT_NEAR(transmittance(lens, {.field_rad = radians(degrees), .z = far}).value(), axis, 0.03) << degrees;
  }
}

TEST(Transmittance, OfMirrorsIsTheirReflectance) {
  Prescription p = testing::data_prescription("mirror_ritchey_chretien_57.6m_f24");
  EXPECT_EQ(transmittance(compile(p), {.z = far}).value(), 1);
  int mirrors = 0;
  for (SurfaceRow& row : p.surfaces) {
    if (!row.mirror) continue;
    ++mirrors;
    row.coating = Coating{.table = {{400, 0.9}, {700, 0.9}}};
  }
  EXPECT_NEAR(transmittance(compile(p), {.z = far}).value(), std::pow(0.9, mirrors), 1e-12);
}

// A coating in air acts at the angle of the ray.
TEST(Transmittance, OfAPellicleDependsOnTheAngle) {
  Prescription p;
  p.name = "pellicle";
  const Coating film{.layers = {{.index = 2.2, .thickness_nm = 180}}};
  p.surfaces = {{.thickness = 50, .semi_diameter = 10, .coating = film}};
  const Lens lens = compile(p);
  for (const double degrees : {0.0, 40.0}) {
    const double sine = std::sin(radians(degrees)), cosine = std::cos(radians(degrees));
    EXPECT_NEAR(transmittance(lens, Ray<double>{{0, 0, -2}, {0, sine, cosine}}).value(),
                surface_light(film, 1, 1, cosine, d_line_nm).transmittance(), 1e-12);
  }
}

TEST(LensColour, NeedsLight) {
  const ColourMatching table =
      ColourMatching::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass" / "cie1931_2deg_5nm.csv");
  const Lens lens = window(1.5);
  EXPECT_THROW(lens_colour(lens, far, Spectrum{}, table), Error);
  EXPECT_THROW(lens_colour(lens, far, Spectrum{{400, 700}, {0, 0}}, table), Error);
  Prescription p = testing::data_prescription("double_gauss_100mm_f1.35");
  p.surfaces[0].coating = Coating{.table = {{100, 1}, {2000, 1}}};
  EXPECT_FALSE(lens_colour(compile(p), far, Spectrum{{400, 700}, {1, 1}}, table));
}

TEST(Transmittance, OfAReversedPrescriptionIsTheSame) {
  Prescription p = testing::data_prescription("double_gauss_100mm_f1.35");
  int layers = 0;
  for (SurfaceRow& row : p.surfaces) {
    row.coating = Coating{.layers = {{.index = 1.38, .thickness_nm = 90.0 + 5 * layers++},
                                     {.index = 2.1, .absorption = 0.01, .thickness_nm = 130}}};
  }
  const Ray<double> axis{{0, 0, -20}, {0, 0, 1}};
  EXPECT_NEAR(transmittance(compile(p), axis).value(), transmittance(compile(reverse(p)), axis).value(), 1e-12);
}

/// A window of a glass that absorbs, without light lost at its surfaces.
Lens grey_window(double thickness, Coating coating = {.table = {{300, 0}, {900, 0}}}) {
  const GlassCatalogue glasses({Glass{.catalogue = "test",
                                      .name = "GREY",
                                      .nd = 1.5,
                                      .shortest_nm = 300,
                                      .longest_nm = 900,
                                      .coefficients = {1.5},
                                      .absorption = {{400, 0.04}, {700, 0.01}}}});
  Prescription p;
  p.name = "grey window";
  p.surfaces = {{.thickness = thickness, .medium = {.glass = "GREY"}, .semi_diameter = 20, .coating = coating},
                {.thickness = 50, .semi_diameter = 20, .coating = coating}};
  constexpr std::array wavelengths{400.0, 550.0, 700.0};
  return compile(p, wavelengths, {.glasses = &glasses});
}

TEST(Transmittance, OfAThickWindowIsAPowerOfAThinOne) {
  for (const double degrees : {0.0, 40.0}) {
    const Ray<double> ray{{0, -3, -2}, {0, std::sin(radians(degrees)), std::cos(radians(degrees))}};
    for (const std::size_t w : {0, 1, 2}) {
      const double one = transmittance(grey_window(4), ray, w).value(),
                   two = transmittance(grey_window(8), ray, w).value();
      EXPECT_NEAR(two, one * one, 1e-12);
      EXPECT_LT(one, 0.97);
      const Lens lens = grey_window(4, {});  // uncoated: the surfaces and the glass act independently
      const double surfaces = transmittance(window(grey_window(4).index(1, w)), ray).value();
      EXPECT_NEAR(transmittance(lens, ray, w).value(), one * surfaces, 1e-9);
    }
  }
  EXPECT_NEAR(transmittance(grey_window(4), Ray<double>{{0, 0, -2}, {0, 0, 1}}, 0).value(), std::exp(-4 * 0.04), 1e-12);
  const Ray<double> back{{0, 0, 60}, {0, 0, -1}};
  EXPECT_NEAR(transmittance(grey_window(4), back, 2, Travel::to_scene).value(), std::exp(-4 * 0.01), 1e-12);
}

// Mean over 5120 rays of the pupil; at 14 degrees the pupil of the double Gauss is vignetted.
TEST(Transmittance, OfAPupilIsTheMeanOverItsRays) {
  for (const char* id : {"double_gauss_100mm_f1.35", "fisheye_8mm_f2.8", "anamorphic_60mm_2x"}) {
    const Lens lens = with_coating(testing::data_lens(id), Coating::quarter_wave());
    for (const double degrees : {0.0, 8.0, 14.0}) {
      const FieldPoint point{.field_rad = radians(degrees), .z = far};
      const PupilBoundary pupil = pupil_boundary(lens, point, {}, 512);
      double light = 0, area = 0;
      for (const analysis_detail::PupilNode& node : analysis_detail::pupil_nodes<10>(pupil)) {
        light += node.area * transmittance(lens, pupil.plane.ray(node.position.x, node.position.y)).value();
        area += node.area;
      }
      EXPECT_NEAR(transmittance(lens, point).value(), light / area, 1e-5) << id << ' ' << degrees;
    }
  }
}

TEST(Transmittance, OfFieldsIsThatOfEachPoint) {
  const Lens lens = grey_window(4);
  constexpr std::array fields{0.0, 0.2};
  for (const int threads : {1, 2}) {
    const auto points = transmittance(lens, far, fields, threads);
    ASSERT_EQ(points.values.size(), 6u);
    EXPECT_EQ(points[1][2].value(), transmittance(lens, {.field_rad = 0.2, .z = far}, 2).value());
  }
}

TEST(StatesCoatings, IsTrueForOneSurface) {
  Prescription p = testing::data_prescription("double_gauss_100mm_f1.35");
  EXPECT_FALSE(states_coatings(compile(p)));
  EXPECT_EQ(uncoated_surfaces(compile(p)).size(), 8u);  // air on one side
  p.surfaces[0].coating = Coating{};
  EXPECT_TRUE(states_coatings(compile(p)));
  EXPECT_EQ(uncoated_surfaces(compile(p)).size(), 7u);
  EXPECT_TRUE(uncoated_surfaces(with_coating(compile(p), Coating::quarter_wave())).empty());
  EXPECT_TRUE(states_coatings(with_coating(testing::data_lens("mirror_ritchey_chretien_57.6m_f24"), {})));
}

TEST(LensColour, OfAWholeTransmittanceIsTheLight) {
  std::vector<double> visible;
  for (int nm = 430; nm <= 670; nm += 20) visible.push_back(nm);
  Prescription p = testing::data_prescription("double_gauss_100mm_f1.35");
  const Lens lens = compile(p, visible);
  for (SurfaceRow& row : p.surfaces) row.coating = Coating{.table = {{300, 0}, {900, 0}}};
  const auto data = std::filesystem::path(PETZVAL_TEST_DATA) / "glass";
  const ColourMatching table = ColourMatching::load(data / "cie1931_2deg_5nm.csv");
  const Spectrum light = illuminant("D65", data / "cie_daylight_10nm.csv");
  const LensColour whole = lens_colour(compile(p, visible), far, light, table).value();
  EXPECT_NEAR(whole.luminous_transmittance, 1, 1e-6);
  EXPECT_NEAR(whole.xy[0], 0.3127, 1e-4);
  EXPECT_NEAR(whole.xy[1], 0.3290, 1e-4);

  const LensColour bare = lens_colour(lens, far, light, table).value();
  EXPECT_LT(bare.luminous_transmittance, 0.7);
  EXPECT_GT(bare.xy[0], whole.xy[0]);  // blue light meets higher indices
  EXPECT_NEAR(whole.light_cct_k.value(), 6504, 5);
  EXPECT_NEAR(whole.cct_k.value(), whole.light_cct_k.value(), 1);
  EXPECT_LT(bare.cct_k.value(), whole.cct_k.value());
}

TEST(Transmittance, RefusesInvalidCoatings) {
  const Lens lens = window(1.5);
  const Coating invalid{.layers = {{.index = -1}}};
  testing::expect_error([&] { with_coating(lens, invalid); }, {"window", "index", -1});
  Prescription p = testing::data_prescription("double_gauss_100mm_f1.35");
  p.surfaces[3].coating = invalid;
  testing::expect_error([&] { compile(p); }, {"surface 3", "index", -1});
  EXPECT_FALSE(transmittance(lens, Ray<double>{{0, 0, 0}, {0, 1, 0}}));
}

}  // namespace transmittance_test
}  // namespace petzval
