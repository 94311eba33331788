// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/apertures.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/core/error.hpp"
#include "petzval/trace/trace.hpp"

namespace lens_test {

using petzval::testing::expect_error;

petzval::Prescription singlet() {
  petzval::Prescription p;
  p.name = "singlet";
  p.surfaces = {{.radius = 50, .thickness = 5, .medium = {.nd = 1.5168}, .semi_diameter = 12, .stop = true},
                {.radius = -50, .thickness = 48, .semi_diameter = 12}};
  return p;
}

TEST(Lens, HasTheValuesOfThePrescription) {
  const petzval::Lens lens = petzval::compile(singlet());
  EXPECT_EQ(lens.name(), "singlet");
  EXPECT_EQ(lens.surface_count(), 2u);
  EXPECT_EQ(lens.stop(), 0u);
  EXPECT_EQ(lens.film_z(), 53);
  EXPECT_EQ(lens.surfaces()[1].vertex_z, 5);
  EXPECT_EQ(lens.surfaces()[1].curvature, -0.02);
  EXPECT_EQ(lens.index(0, 0), 1);
  EXPECT_EQ(lens.index(1, 0), 1.5168);
  EXPECT_EQ(lens.index(2, 0), 1);
  EXPECT_TRUE(lens.rotationally_symmetric());
}

// A term with a slope of 4 at 5 mm and of 1800 at 12 mm.
TEST(Lens, AsphericRimsEndAtASlopeOf4) {
  petzval::Prescription p = singlet();
  p.surfaces[1].aspheric = {{8, -std::pow(5, -7) / 2}};
  const petzval::Lens lens = petzval::compile(p);
  const double rim = lens.surfaces()[1].semi_diameter, step = 1e-4;
  EXPECT_GT(rim, 4.9);
  EXPECT_LT((petzval::sag(lens, 1, 0, rim - 2 * step) - petzval::sag(lens, 1, 0, rim - step)) / step, 4);
  EXPECT_GT((petzval::sag(lens, 1, 0, rim - step) - petzval::sag(lens, 1, 0, rim)) / step, 3.8);
  const auto fate_at = [&](double y) {
    return petzval::trace(lens, petzval::Ray<double>{{0, y, 60}, {0, 0, -1}}, {.travel = petzval::Travel::to_scene})
        .fate;
  };
  EXPECT_EQ(fate_at(rim + 1e-9), petzval::RayFate::vignetted);
  EXPECT_NE(fate_at(rim - 1e-9), petzval::RayFate::vignetted);  // the ray may still be lost by total reflection
  EXPECT_EQ(petzval::with_semi_diameter(lens, 1, 12).surfaces()[1].semi_diameter, rim);
  EXPECT_EQ(petzval::with_semi_diameter(lens, 1, 3).surfaces()[1].semi_diameter, 3);
  p.surfaces[0].thickness = 0;  // no edge
  const petzval::Lens endless = petzval::with_any_semi_diameter(petzval::compile(p), 1, HUGE_VAL);
  EXPECT_TRUE(std::isinf(endless.surfaces()[1].semi_diameter));
  p.surfaces[1].curved_in = petzval::Section::y;
  EXPECT_EQ(petzval::compile(p).surfaces()[1].semi_diameter, 12);
}

TEST(Lens, FindsWavelengthsOrNamesThem) {
  petzval::Prescription p = singlet();
  p.surfaces[0].medium.vd = 64.2;
  const petzval::Lens lens =
      petzval::compile(p, std::array{486.1327, petzval::d_line_nm}, {.missing_glass = petzval::MissingGlass::abbe});
  EXPECT_EQ(lens.wavelength_index(petzval::Wavelength::nm(petzval::d_line_nm)), 1u);
  EXPECT_EQ(lens.wavelength_index(petzval::Wavelength::nm(486.1327 + 5e-7)), 0u);
  EXPECT_GT(lens.index(1, 0), lens.index(1, 1));
  expect_error([&] { return lens.wavelength_index(petzval::Wavelength::nm(500)); }, {"singlet", "wavelength", 500});
}

TEST(Lens, PrimaryWavelengthIsTheReferenceOrNearestToTheDLine) {
  petzval::Prescription p = singlet();
  p.surfaces[0].medium.vd = 64.2;
  const auto primary = [&](std::vector<double> wavelengths_nm) {
    return petzval::compile(p, wavelengths_nm, {.missing_glass = petzval::MissingGlass::abbe}).primary_wavelength();
  };
  EXPECT_EQ(primary({656.2725, 486.1327, petzval::d_line_nm}), 2u);
  EXPECT_EQ(primary({656.2725, 600, 486.1327}), 1u);
  p.reference_wavelength_nm = 546.0740;
  EXPECT_EQ(primary({petzval::d_line_nm, 546.0740 + 5e-7}), 1u);
  EXPECT_EQ(primary({480, 656.2725, petzval::d_line_nm}), 2u);
  const auto chosen = [&](double nm) {
    return petzval::compile(p, std::array{480.0, 656.2725},
                            {.missing_glass = petzval::MissingGlass::abbe, .primary_nm = nm});
  };
  EXPECT_EQ(chosen(480).primary_wavelength(), 0u);
  EXPECT_EQ(chosen(656.2725).primary_wavelength(), 1u);
  expect_error([&] { chosen(500); }, {"primary_nm", 500});
}

TEST(Lens, FindsWavelengthsByIndexByNmAndByDefault) {
  petzval::Prescription p = singlet();
  p.surfaces[0].medium.vd = 64.2;
  const petzval::Lens lens = petzval::compile(p, std::array{486.1327, petzval::d_line_nm, 656.2725},
                                              {.missing_glass = petzval::MissingGlass::abbe});
  EXPECT_EQ(lens.wavelength_index({}), 1u);
  EXPECT_EQ(lens.wavelength_index(2), 2u);
  EXPECT_THROW(lens.wavelength_index(static_cast<std::size_t>(-1)), petzval::Error);
  EXPECT_EQ(lens.index(1), lens.index(1, 1));
  EXPECT_EQ(lens.nearest_wavelength(540), 1u);
  EXPECT_EQ(lens.nearest_wavelength(530), 0u);
  EXPECT_EQ(lens.nearest_wavelength(2000), 2u);
  expect_error([&] { lens.nearest_wavelength(std::numeric_limits<double>::quiet_NaN()); },
               {"singlet", "wavelength", "nan"});
}

TEST(Lens, LightRunsTowardsMinusZBehindAnOddNumberOfMirrors) {
  petzval::Prescription p;
  p.name = "two mirrors";
  p.surfaces = {{.thickness = 10},
                {.radius = -200, .thickness = -50, .mirror = true},
                {.radius = -100, .thickness = 70, .mirror = true}};
  const petzval::Lens lens = petzval::compile(p);
  const double wanted[] = {1, 1, -1, 1};
  for (std::size_t space = 0; space < 4; ++space) EXPECT_EQ(lens.light_direction(space), wanted[space]);
  expect_error([&] { lens.light_direction(4); }, {"two mirrors", "space 4"});
}

TEST(Lens, ChangesMakeANewLens) {
  const petzval::Lens lens = petzval::compile(singlet());
  const petzval::Lens stopped = petzval::with_semi_diameter(lens, 0, 3), moved = petzval::with_film(lens, 60);
  const petzval::Ray<float> ray{{0, 5, -10}, {0, 0, 1}};
  EXPECT_TRUE(petzval::trace(lens, ray).transmitted());
  EXPECT_EQ(petzval::trace(stopped, ray).fate, petzval::RayFate::vignetted);
  EXPECT_EQ(lens.surfaces()[0].semi_diameter, 12);
  EXPECT_EQ(lens.film_z(), 53);
  EXPECT_EQ(moved.film_z(), 60);
}

TEST(Lens, TinyRimsAreClosedAndHugeRimsAreIgnored) {
  petzval::Prescription p = singlet();
  for (const auto& [wanted, found] : {std::pair{1e-160, 0.0}, {1e-12, 1e-12}, {1e15, 1e15}, {1e160, HUGE_VAL}}) {
    p.surfaces[0].semi_diameter = wanted;
    EXPECT_EQ(petzval::compile(p).surfaces()[0].semi_diameter, found);
    EXPECT_EQ(petzval::with_any_semi_diameter(petzval::compile(singlet()), 0, wanted).surfaces()[0].semi_diameter,
              found);
  }
}

TEST(Lens, RimsOpenUpToThePrescription) {
  const petzval::Lens lens = petzval::compile(singlet());
  EXPECT_EQ(lens.surfaces()[0].widest_semi_diameter, 12);
  const petzval::Lens stopped = petzval::with_semi_diameter(lens, 0, 3);
  EXPECT_EQ(stopped.surfaces()[0].widest_semi_diameter, 12);
  EXPECT_EQ(petzval::with_semi_diameter(stopped, 0, 12).surfaces()[0].semi_diameter, 12);
  for (const double beyond : {12.001, 1e3, HUGE_VAL}) {
    expect_error([&] { petzval::with_semi_diameter(lens, 0, beyond); }, {"singlet", "surface 0", beyond, 12});
    EXPECT_EQ(petzval::with_any_semi_diameter(lens, 0, beyond).surfaces()[0].semi_diameter, beyond);
  }
  petzval::Prescription p = singlet();
  p.surfaces[0].semi_diameter.reset();
  EXPECT_EQ(petzval::with_semi_diameter(petzval::compile(p), 0, 20).surfaces()[0].semi_diameter, 20);
}

TEST(Sag, IsNanOutsideTheSurface) {
  const petzval::Lens lens = petzval::compile(singlet());
  EXPECT_EQ(petzval::sag(lens, 1, 0, 0), 0);
  EXPECT_TRUE(std::isnan(petzval::sag(lens, 0, 1e9, 0)));
  for (const std::size_t beyond : {std::size_t{2}, std::size_t{99}, std::numeric_limits<std::size_t>::max()}) {
    EXPECT_TRUE(std::isnan(petzval::sag(lens, beyond, 0, 0)));
  }
}

TEST(Lens, RefusesInvalidChanges) {
  const petzval::Lens lens = petzval::compile(singlet());
  expect_error([&] { petzval::with_semi_diameter(lens, 2, 3); }, {"singlet", "surface 2"});
  expect_error([&] { petzval::with_semi_diameter(lens, 1, -3); }, {"singlet", "surface 1", "semi_diameter", -3});
  expect_error([&] { petzval::with_semi_diameter(lens, 1, std::nan("")); },
               {"singlet", "surface 1", "semi_diameter", "nan"});
  const double last_z = lens.surfaces().back().vertex_z;
  for (const double inside : {last_z, last_z - 1, -10.0}) {
    expect_error([&] { petzval::with_film(lens, inside); }, {"singlet", "film_z", inside, last_z});
  }
  // Behind one mirror light runs towards -z.
  const petzval::Lens mirror = petzval::testing::data_lens("mirror_newton_200mm_f8");
  EXPECT_EQ(petzval::with_film(mirror, -100).film_z(), -100);
  expect_error([&] { petzval::with_film(mirror, 100); }, {mirror.name(), "film_z", 100});
  expect_error([&] { petzval::with_film(lens, std::numeric_limits<double>::infinity()); },
               {"singlet", "film_z", "inf"});
}

TEST(Lens, TheStopOfAnAsphericSurfaceMayBeClosed) {
  petzval::Prescription p = singlet();
  p.surfaces[0].aspheric = {{4, -1e-6}};
  const petzval::Lens lens = petzval::compile(p);
  for (const double radius : {6.0, 1e-3, 0.0}) {
    const petzval::Lens closed = petzval::with_semi_diameter(lens, 0, radius);
    EXPECT_TRUE(petzval::trace(closed, petzval::Ray<double>{{0, 0, -10}, {0, 0, 1}}).transmitted()) << radius;
    EXPECT_EQ(petzval::trace(closed, petzval::Ray<double>{{0, 6.1, -10}, {0, 0, 1}}).fate, petzval::RayFate::vignetted)
        << radius;
  }
}

}  // namespace lens_test
