// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lint.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace match_glasses_test {

using petzval::testing::expect_error;

using petzval::GlassCatalogue;
using petzval::match_glasses;
using petzval::Prescription;

const GlassCatalogue& glasses() {
  static const auto tables = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return tables;
}

Prescription doublet() {
  Prescription p;
  p.name = "doublet";
  p.surfaces = {{.radius = 60, .thickness = 6, .medium = {.nd = 1.5168, .vd = 64.2}, .stop = true},
                {.radius = -50, .thickness = 3, .medium = {.nd = 1.62004, .vd = 36.4}},
                {.radius = -200, .thickness = 2},
                {.radius = 100, .thickness = 3, .medium = {.nd = 1.5168, .vd = 64.2}},
                {.radius = -300, .thickness = 90}};
  return p;
}

// The printed index is kept, and the glass gives the dispersion.
TEST(MatchGlasses, MediaGetTheNearestGlassAndKeepTheirNumbers) {
  const auto matched = match_glasses(doublet(), glasses());
  const auto& rows = matched.prescription.surfaces;
  for (const std::size_t i : {0u, 1u, 3u}) {
    const petzval::Medium &medium = rows[i].medium, &before = doublet().surfaces[i].medium;
    EXPECT_EQ(medium.nd, before.nd);
    EXPECT_EQ(medium.vd, before.vd);
    EXPECT_EQ(medium.glass_origin, "matched");
    const petzval::Glass* glass = glasses().find(medium.glass.value(), medium.catalogue.value());
    ASSERT_NE(glass, nullptr);
    EXPECT_NEAR(glass->nd, before.nd.value(), 1e-3);
    EXPECT_NEAR(glass->vd, before.vd.value(), 0.5);
  }
  EXPECT_EQ(rows[2].medium, petzval::Medium{});
  EXPECT_EQ(rows[0].medium, rows[3].medium);
  ASSERT_EQ(matched.matched.size(), 2u);
  EXPECT_EQ(matched.matched[0].command, "surface 0, surface 3");
  EXPECT_NE(matched.matched[0].message.find(rows[0].medium.glass.value()), std::string::npos);
  EXPECT_TRUE(matched.unmatched.empty());
  // At d nothing changes; at F the glass gives the indices.
  const std::array wavelengths{587.5618, 486.1327};
  const auto lens = compile(matched.prescription, wavelengths, {.glasses = &glasses()});
  EXPECT_EQ(lens.dispersion(), petzval::Dispersion::catalogue);
  EXPECT_NEAR(petzval::first_order(lens).effective_focal_length,
              petzval::first_order(compile(doublet())).effective_focal_length, 1e-9);
}

TEST(MatchGlasses, MediaFarFromEveryGlassAreKept) {
  Prescription p = doublet();
  p.surfaces[0].medium = {.nd = 1.5168, .vd = 30};
  p.surfaces[1].medium = {.nd = 1.62004};
  p.surfaces[3].medium = {.glass = "mine", .nd = 1.5168, .vd = 64.2};
  const auto matched = match_glasses(p, glasses());
  EXPECT_EQ(matched.prescription, p);
  EXPECT_TRUE(matched.matched.empty());
  ASSERT_EQ(matched.unmatched.size(), 2u);
  EXPECT_EQ(matched.unmatched[0].command, "surface 0");
  EXPECT_EQ(matched.unmatched[1].command, "surface 1");
  // With a wide tolerance the first medium has a match.
  EXPECT_EQ(match_glasses(p, glasses(), 0.1, 100).matched.size(), 1u);
  EXPECT_LE(match_glasses(doublet(), glasses(), 0, 0).matched.size(), 2u);
  EXPECT_EQ(match_glasses(doublet(), GlassCatalogue()).unmatched.size(), 2u);
  expect_error([&] { match_glasses(p, glasses(), -1); }, {"nd", -1});
  p = doublet();
  p.reference_wavelength_nm = 546.074;
  EXPECT_EQ(match_glasses(p, glasses()).unmatched.size(), 2u);
}

TEST(MatchGlasses, ConfigurationsAndMirrorsKeepTheirMedia) {
  Prescription p = doublet();
  p.surfaces.push_back({.radius = 0, .thickness = -1, .mirror = true});
  p.surfaces.insert(p.surfaces.begin() + 4,
                    {.radius = 0, .thickness = 1, .medium = {.nd = 1.5168, .vd = 64.2}, .mirror = true});
  p.configurations = {{.name = "a"},
                      {.name = "b", .changes = {{.surface = 1, .medium = petzval::Medium{.nd = 1.5168, .vd = 64.2}}}}};
  const auto matched = match_glasses(p, glasses()).prescription;
  petzval::validate(matched, "lens");
  EXPECT_EQ(matched.configurations[1].changes[0].medium, matched.surfaces[0].medium);
}

// Most media of data/lenses with n_d and V_d have a glass within the tolerance.
TEST(MatchGlasses, EveryLensOfTheDataKeepsItsFocalLengthAtItsReference) {
  std::size_t matches = 0, rest = 0;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    const auto matched = match_glasses(p, glasses());
    matches += matched.matched.size(), rest += matched.unmatched.size();
    const auto focal_length = [](const Prescription& lens) {
      return petzval::first_order(compile(lens)).effective_focal_length;
    };
    EXPECT_EQ(focal_length(matched.prescription), focal_length(p)) << p.id;
  }
  EXPECT_GT(matches, rest);
}

}  // namespace match_glasses_test
