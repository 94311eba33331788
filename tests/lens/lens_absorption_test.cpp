// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>

#include "../expect_error.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/pupil/apertures.hpp"

namespace lens_absorption_test {

using petzval::Lens;
using petzval::Wavelength;
using petzval::testing::expect_error;

constexpr std::array wavelengths_nm{450.0, 550.0, 650.0};

/// GREY absorbs, CLEAR has no table of absorption.
petzval::GlassCatalogue glasses() {
  const petzval::Glass clear{
      .catalogue = "made-up", .name = "CLEAR", .nd = 1.5, .shortest_nm = 400, .longest_nm = 700, .coefficients = {1.5}};
  petzval::Glass grey = clear;
  grey.name = "GREY";
  grey.absorption = {{450, 0.03}, {500, 0.01}, {700, 0.002}};
  return petzval::GlassCatalogue({clear, grey});
}

/// A cemented pair of GREY and CLEAR, and a plate without a known glass.
petzval::Prescription pair() {
  petzval::Prescription p;
  p.name = "pair";
  p.surfaces = {{.radius = 60, .thickness = 6, .medium = {.glass = "GREY"}},
                {.radius = -40, .thickness = 3, .medium = {.glass = "CLEAR"}},
                {.radius = -90, .thickness = 5},
                {.radius = 0, .thickness = 2, .medium = {.nd = 1.6, .vd = 50}},
                {.radius = 0, .thickness = 90}};
  return p;
}

Lens compiled(const petzval::Prescription& prescription) {
  const auto catalogue = glasses();
  return petzval::compile(prescription, wavelengths_nm,
                          {.glasses = &catalogue, .missing_glass = petzval::MissingGlass::abbe});
}

TEST(LensAbsorption, Media_HaveTheAbsorptionOfTheirGlass) {
  const Lens lens = compiled(pair());
  for (const std::size_t space : {0, 2, 3, 4, 5}) {
    for (std::size_t w = 0; w < 3; ++w) EXPECT_EQ(lens.absorption(space, w), 0) << space;
  }
  EXPECT_EQ(lens.absorption(1, 0), 0.03);
  EXPECT_EQ(lens.absorption(1), *absorption(*glasses().find("GREY"), 550));
  EXPECT_EQ(lens.absorption(1, Wavelength::nm(650)), lens.absorption(1, 2));
}

// Absorption bends at 500 nm, which is not a compiled wavelength.
TEST(LensAbsorption, WavelengthInNm_IsReadFromTheTableOfTheGlass) {
  const Lens lens = compiled(pair());
  EXPECT_EQ(lens.absorption(1, Wavelength::nm(500)), 0.01);
  EXPECT_NEAR(lens.absorption(1, Wavelength::nm(475)), 0.02, 1e-16);
}

TEST(LensAbsorption, ReversedAndChangedLens_KeepIt) {
  const Lens lens = compiled(pair()), reversed = compiled(reverse(pair()));
  for (std::size_t space = 0; space < 6; ++space) {
    EXPECT_EQ(reversed.absorption(5 - space), lens.absorption(space)) << space;
    EXPECT_EQ(with_film(lens, 130).absorption(space), lens.absorption(space)) << space;
  }
  EXPECT_GT(reversed.absorption(4), 0);
}

// Shipped lenses name catalogues without absorption; a glass file of the user has another catalogue name.
TEST(LensAbsorption, AddedGlassOfTheSameName_HasTheAbsorptionOfANamedCatalogue) {
  const petzval::Glass grey = *glasses().find("GREY");
  petzval::Glass table = grey, other = grey;
  table.absorption.clear();
  other.catalogue = "rii";
  petzval::Prescription p = pair();
  p.surfaces[0].medium.catalogue = "made-up";
  p.surfaces[1].medium = {.nd = 1.5, .vd = 50};
  const auto absorption_with = [&](const petzval::Glass& added) {
    const auto catalogue = with_glasses(petzval::GlassCatalogue({table}), {added});
    return petzval::compile(p, wavelengths_nm, {.glasses = &catalogue, .missing_glass = petzval::MissingGlass::abbe})
        .absorption(1, 0);
  };
  EXPECT_EQ(absorption_with(other), 0.03);
  other.nd = 1.5019;
  EXPECT_EQ(absorption_with(other), 0.03);
  other.nd = 1.5021;  // another glass of this name
  EXPECT_EQ(absorption_with(other), 0);
}

TEST(LensAbsorption, Configurations_HaveTheAbsorptionOfTheirGlass) {
  petzval::Prescription p = pair();
  p.configurations = {{.name = "grey"}, {.name = "clear"}};
  p.configurations[1].changes = {{.surface = 0, .medium = petzval::Medium{.glass = "CLEAR"}}};
  const auto grey = compiled(configured(p, 0)), clear = compiled(configured(p, 1));
  EXPECT_GT(grey.absorption(1), 0);
  EXPECT_EQ(clear.absorption(1), 0);
}

TEST(LensAbsorption, InvalidSpaceOrWavelength_IsRefusedLikeForTheIndex) {
  const Lens lens = compiled(pair());
  expect_error([&] { return lens.absorption(6); }, {"pair", "space", 6});
  expect_error([&] { return lens.absorption(1, 3); }, {"pair", "wavelength", 3});
  expect_error([&] { return lens.absorption(1, Wavelength::nm(660)); }, {"pair", "wavelength", 660, 450, 650});
}

}  // namespace lens_absorption_test
