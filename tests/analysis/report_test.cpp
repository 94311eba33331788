// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/report.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace report_test {

constexpr double far = -std::numeric_limits<double>::infinity();

Lens double_gauss() {
  return compile(testing::data_prescription("double_gauss_100mm_f2.0"), std::array{486.1327, 587.5618, 656.2725});
}

TEST(LensReport, IndicesAreFieldAndWavelength) {
  const Lens lens = double_gauss();
  const LensReport r = lens_report(lens, {.fields_deg = {0, 12}, .threads = 2});
  const std::array off_axis{radians(12.0)}, frequencies{40.0}, fractions{0.9};
  const std::array tens{10.0, 20.0, 30.0, 40.0};
  const auto spots = spot_diagram(lens, far, off_axis, 32768);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ((*r.spots)[1][k].y, spots[0][k].y);
    EXPECT_EQ((*r.ray_fans)[1][k].wavelength, k);
    EXPECT_EQ((*r.longitudinal_aberration)[k][5].wavelength, k);
    EXPECT_EQ((*r.lateral_colour)[1][k], chromatic_aberration(lens, far, off_axis).lateral[0][k]);
    EXPECT_EQ((*r.wavefront)[1][k]->rms_waves, wavefront(lens, {off_axis[0], far}, k)->rms_waves);
  }
  EXPECT_EQ((*r.mtf)[1][8].tangential, geometric_mtf(spots, frequencies)[0][0].tangential);
  EXPECT_NEAR((*r.mtf_over_field)[10][2].tangential,
              geometric_mtf(spot_diagram(lens, far, off_axis, 4096), frequencies)[0][0].tangential, 1e-12);
  EXPECT_NEAR((*r.mtf_diffraction)[1][5].sagittal, diffraction_mtf(lens, far, off_axis, frequencies)[0][0].sagittal,
              1e-3);
  // The middle of 21 films is the film of the lens.
  EXPECT_NEAR((*r.mtf_through_focus)[1][10].sagittal, diffraction_mtf(lens, far, off_axis, tens)[0][2].sagittal, 1e-3);
  ASSERT_EQ(r.mtf_chart->size(), 2u);
  EXPECT_EQ(r.mtf_chart->at(0).second[10][3].sagittal, diffraction_mtf(lens, far, off_axis, tens)[0][3].sagittal);
  EXPECT_EQ(r.mtf_chart->at(1).second[10][3].tangential,
            diffraction_mtf(with_f_number(lens, 8), far, off_axis, tens)[0][3].tangential);
  EXPECT_EQ((*r.encircled_energy)[1][2].radius_mm, encircled_energy(spots, fractions)[0][0].radius_mm);
  const double step = through_focus_step(lens, *r.spots).value();
  EXPECT_EQ((*r.through_focus)[1][4].film_shift_mm, 2 * step);
  EXPECT_EQ((*r.through_focus)[1][3].rms_radius_mm, through_focus(spots, std::array{step})[0][0].rms_radius_mm);
  EXPECT_EQ((*r.distortion)[1].height_mm, distortion_percent(lens, far, off_axis)[0].height_mm);
  EXPECT_EQ(*r.f_number, real_f_number(lens));
  EXPECT_EQ(r.seidel->sums.c1, seidel_sums(lens, {.field_rad = off_axis[0]}, {}, 0, 2).sums.c1);
  EXPECT_EQ(to_json(r), to_json(lens_report(lens, {.fields_deg = {0, 12}})));  // with another number of threads
}

TEST(LensReport, QuantitiesThatFailLeaveTheOthers) {
  const LensReport squeezed = lens_report(testing::data_lens("anamorphic_60mm_2x"), {.fields_deg = {0, 3}});
  EXPECT_EQ(squeezed.sections.size(), 2u);
  EXPECT_FALSE(squeezed.seidel);
  EXPECT_NE(squeezed.seidel.failure, "");
  EXPECT_TRUE(squeezed.mtf);
  testing::expect_error([&] { *squeezed.seidel; }, {squeezed.seidel.failure});

  Prescription cubic = testing::data_prescription("singlet_50mm_biconvex");
  cubic.surfaces[0].aspheric.push_back({.order = 3, .coefficient = 1e-7});
  const LensReport third_order = lens_report(compile(cubic), {.fields_deg = {2}});
  EXPECT_TRUE(third_order.paraxial_rays);
  EXPECT_FALSE(third_order.seidel);
  EXPECT_NE(to_json(third_order).find("\"failures\": {\"seidel\": "), std::string::npos) << to_json(third_order);
  EXPECT_TRUE(third_order.wavefront);

  Prescription window;
  window.surfaces = {{.thickness = 5, .medium = {.nd = 1.5}}, {.thickness = 50}};
  const LensReport without_rims = lens_report(compile(window), {.fields_deg = {0, 2}});
  EXPECT_FALSE(without_rims.sections[0].pupils);
  EXPECT_TRUE(without_rims.sections[0].first_order.afocal);
  EXPECT_FALSE(without_rims.spots);
  EXPECT_EQ(without_rims.encircled_energy.failure, without_rims.spots.failure);
  const std::string json = to_json(without_rims);
  EXPECT_NE(json.find("\"mtf\": null"), std::string::npos) << json;
}

TEST(LensReport, TelescopeHasSpotsButNoImage) {
  Prescription telescope;
  telescope.surfaces = {{.radius = 103.36, .thickness = 2, .medium = {.nd = 1.5168}, .semi_diameter = 10, .stop = true},
                        {.thickness = 0, .semi_diameter = 10},
                        {.thickness = 2, .medium = {.nd = 1.5168}, .semi_diameter = 10},
                        {.radius = -25.84, .thickness = 20, .semi_diameter = 10}};
  // The power is linear in the gap.
  const auto power = [&](double gap) {
    telescope.surfaces[1].thickness = gap;
    return 1 / first_order(compile(telescope)).effective_focal_length;
  };
  const double at_100 = power(100), gap = 100 - 100 * at_100 / (power(200) - at_100);
  telescope.surfaces[1].thickness = gap;
  const LensReport report = lens_report(compile(telescope), {.fields_deg = {0, 1}});
  ASSERT_TRUE(report.sections[0].first_order.afocal);
  EXPECT_TRUE(report.spots);
  EXPECT_TRUE(report.ray_fans);
  for (const bool has_value :
       {bool(report.field_curvature), bool(report.distortion), bool(report.mtf), bool(report.through_focus),
        bool(report.longitudinal_aberration), bool(report.wavefront)}) {
    EXPECT_FALSE(has_value);
  }
  // A near subject has an image.
  EXPECT_TRUE(lens_report(compile(telescope), {.subject_z = -500, .fields_deg = {0, 1}}).field_curvature);
}

TEST(LensReport, NeedsAWeightForEachWavelengthAndAThread) {
  const Lens lens = double_gauss();
  testing::expect_error([&] { lens_report(lens, {.wavelength_weights = {1, 1}}); }, {"wavelength_weights", 2, 3});
  testing::expect_error([&] { lens_report(lens, {.threads = 0}); }, {"threads", 0});
  testing::expect_error([&] { lens_report(lens, {.wavelength_weights = {1, -1, 1}}); }, {"wavelength_weights", -1});
  testing::expect_error([&] { lens_report(lens, {.fields_deg = {1, NAN}}); }, {"fields_deg", "nan"});
}

}  // namespace report_test
}  // namespace petzval
