// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/pupil/apertures.hpp"

namespace compile_test {

using petzval::compile;
using petzval::Dispersion;
using petzval::GlassCatalogue;
using petzval::IndexPolicy;
using petzval::MissingGlass;
using petzval::Prescription;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
using petzval::testing::message;

constexpr double d = petzval::d_line_nm, f = 486.1327, c = 656.2725;
constexpr std::array<double, 3> visible{f, d, c};

const GlassCatalogue& glasses() {
  static const auto catalogue = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return catalogue;
}

double catalogue_index(const char* name, const char* catalogue, double nm) {
  return petzval::refractive_index(*glasses().find(name, catalogue), nm);
}

/// A cemented doublet: a glass of the tables with a rounded index, and a medium that each test chooses.
Prescription doublet(const petzval::Medium& second) {
  Prescription p;
  p.name = "pair";
  p.surfaces = {
      {.radius = 60, .thickness = 6, .medium = {.glass = "N-BK7", .catalogue = "schott", .nd = 1.517, .vd = 64.2}},
      {.radius = -40, .thickness = 3, .medium = second},
      {.radius = -90, .thickness = 90}};
  return p;
}

const petzval::Medium flint{.glass = "N-SF5", .catalogue = "schott", .nd = 1.673, .vd = 32.2};
const petzval::Medium unknown{.glass = "MYSTERIUM", .catalogue = "atlantis", .nd = 1.673, .vd = 32.2};
const petzval::Medium nameless{.nd = 1.673, .vd = 32.2};
const petzval::Medium bare{.nd = 1.673};

TEST(Compile, PrintedIndexHoldsAtDAndCatalogueAddsDispersion) {
  const auto lens = compile(doublet(flint), visible, {.glasses = &glasses()});
  EXPECT_EQ(lens.index(1, 1), 1.517);
  EXPECT_EQ(lens.index(2, 1), 1.673);
  for (const std::size_t w : {0u, 2u}) {
    EXPECT_EQ(lens.index(0, w), 1);
    EXPECT_EQ(lens.index(3, w), 1);
    EXPECT_DOUBLE_EQ(lens.index(1, w) - 1.517,
                     catalogue_index("N-BK7", "schott", visible[w]) - catalogue_index("N-BK7", "schott", d));
    EXPECT_DOUBLE_EQ(lens.index(2, w) - 1.673,
                     catalogue_index("N-SF5", "schott", visible[w]) - catalogue_index("N-SF5", "schott", d));
  }
  EXPECT_EQ(lens.dispersion(), Dispersion::catalogue);
  EXPECT_TRUE(lens.missing_glasses().empty());
}

TEST(Compile, CataloguePolicyUsesTheCatalogueIndexAtD) {
  const auto lens = compile(doublet(flint), visible, {.glasses = &glasses(), .index_policy = IndexPolicy::catalogue});
  for (std::size_t w = 0; w < 3; ++w) {
    EXPECT_EQ(lens.index(0, w), 1);
    EXPECT_EQ(lens.index(1, w), catalogue_index("N-BK7", "schott", visible[w]));
    EXPECT_EQ(lens.index(2, w), catalogue_index("N-SF5", "schott", visible[w]));
  }
}

TEST(Compile, ReferenceWavelengthIsTheWavelengthOfTheTable) {
  Prescription p = doublet(flint);
  p.reference_wavelength_nm = 546.074;
  const auto lens = compile(p, std::array{546.074, d}, {.glasses = &glasses()});
  EXPECT_EQ(lens.index(1, 0), 1.517);
  EXPECT_DOUBLE_EQ(lens.index(1, 1) - 1.517,
                   catalogue_index("N-BK7", "schott", d) - catalogue_index("N-BK7", "schott", 546.074));
}

TEST(Compile, UnknownGlassIsRefusedByName) {
  const petzval::CompileOptions strict{.glasses = &glasses()};
  expect_error([&] { compile(doublet(unknown), visible, strict); },
               {"pair", "surface 1", "\"MYSTERIUM\"", "\"atlantis\"", "glass", 486.1327, "V_d"});
  expect_error([&] { compile(doublet(nameless), visible, strict); },
               {"pair", "surface 1", "nd", 1.673, 486.1327, "V_d"});
  Prescription immersed = doublet(flint);
  immersed.object_space = {.glass = "SEA WATER", .nd = 1.34};
  expect_error([&] { compile(immersed, visible, strict); }, {"pair", "object space", "\"SEA WATER\""});
  // Without the glass there is no catalogue index, not even at the d line.
  expect_error(
      [&] {
        compile(doublet(unknown), std::array{d}, {.glasses = &glasses(), .index_policy = IndexPolicy::catalogue});
      },
      {"pair", "surface 1", 587.5618});
}

TEST(Compile, MissingGlass_OfAnotherCatalogueOrIndexOrSpelling_IsExplained) {
  const auto said = [](const petzval::Medium& medium) { return message([&] { compile(doublet(medium), visible); }); };
  const std::string other_catalogue = said({.glass = "N-BK7", .catalogue = "hoya", .nd = 1.5168});
  expect_tokens(other_catalogue, {"\"N-BK7\"", "\"hoya\"", "schott"});
  const std::string other_index = said({.glass = "F2", .nd = 1.7});
  expect_tokens(other_index, {"\"F2\"", 1.7, 0.01, "schott", 1.62004, "cdgm", 1.61293});
  for (const std::string& text : {other_catalogue, other_index})
    EXPECT_EQ(text.find("in no glass table"), std::string::npos) << text;
  expect_tokens(said({.glass = "N-BK77", .nd = 1.5168}), {"\"N-BK77\"", "glass", "N-BK7"});
  expect_tokens(said({.glass = "NBK7", .nd = 1.5168}), {"\"NBK7\"", "N-BK7"});
  const auto named = compile(doublet({.glass = "F2", .nd = 1.7}));
  ASSERT_EQ(named.missing_glasses().size(), 1u);
  expect_tokens(named.missing_glasses()[0], {"surface 1", "\"F2\"", 1.7, 1.62004});
}

TEST(Compile, GlassWithoutAnIndex_HasTheFormulaAtEveryWavelength) {
  for (const IndexPolicy policy : {IndexPolicy::printed, IndexPolicy::catalogue}) {
    const auto lens = compile(doublet({.glass = "N-SF5"}), std::array{d, 400.0, 900.0}, {.index_policy = policy});
    for (const std::size_t w : {0u, 1u, 2u}) {
      EXPECT_EQ(lens.index(2, w), catalogue_index("N-SF5", "schott", lens.wavelengths_nm()[w]));
    }
    EXPECT_EQ(lens.dispersion(), Dispersion::catalogue);
  }
  Prescription p = doublet({.glass = "N-SF5"});
  p.reference_wavelength_nm = 546.074;
  EXPECT_EQ(compile(p).index(2), catalogue_index("N-SF5", "schott", 546.074));
}

TEST(Compile, GlassWithoutAnIndex_InNoTable_IsAnErrorAtTheReferenceWavelengthToo) {
  expect_error([&] { compile(doublet({.glass = "N-BK77"})); },
               {"pair", "surface 1", "\"N-BK77\"", "glass", "N-BK7", "n_d"});
  expect_error([&] { compile(doublet({.glass = "N-BK7", .catalogue = "hoya"})); },
               {"pair", "surface 1", "\"N-BK7\"", "\"hoya\"", "schott"});
  EXPECT_NO_THROW(compile(doublet({.glass = "N-SF5"}), std::array{d}, {.missing_glass = MissingGlass::abbe}));
}

TEST(Compile, GlassWithoutAnIndex_OfSeveralMeanings_IsAnErrorThatListsThem) {
  expect_error([&] { compile(doublet({.glass = "F2"})); },
               {"pair", "surface 1", "\"F2\"", "schott", "n_d 1.62004", "cdgm", "n_d 1.61293", "catalogue"});
  EXPECT_EQ(compile(doublet({.glass = "F2", .catalogue = "cdgm"})).index(2), catalogue_index("F2", "cdgm", d));
}

TEST(Compile, TablesOfTheLibrary_AreTheDefault) {
  const auto by_default = compile(doublet(flint), visible);
  const auto given = compile(doublet(flint), visible, {.glasses = &glasses()});
  for (std::size_t w = 0; w < visible.size(); ++w) {
    for (std::size_t space = 0; space <= 3; ++space) EXPECT_EQ(by_default.index(space, w), given.index(space, w));
  }
  EXPECT_EQ(compile(doublet(flint)).dispersion(), Dispersion::catalogue);
  EXPECT_TRUE(compile(doublet(flint)).missing_glasses().empty());
  // Empty tables are not replaced.
  const GlassCatalogue none;
  EXPECT_EQ(compile(doublet(flint), {.glasses = &none}).missing_glasses().size(), 2u);
}

TEST(Compile, ReferenceWavelengthNeedsNoGlass) {
  const auto lens = compile(doublet(unknown));
  EXPECT_EQ(lens.index(2, 0), 1.673);
  EXPECT_EQ(lens.dispersion(), Dispersion::abbe);
  ASSERT_EQ(lens.missing_glasses().size(), 1u);
  expect_tokens(lens.missing_glasses()[0], {"pair", "surface 1", "\"MYSTERIUM\"", "\"atlantis\""});
}

TEST(Compile, MediumOfVd0_HasItsIndexAtEveryWavelength) {
  const petzval::Medium constant{.nd = 1.673, .vd = 0};
  const auto lens = compile(doublet(constant), std::array{d, 320.0, 2300.0});
  for (std::size_t w = 0; w < 3; ++w) EXPECT_EQ(lens.index(2, w), 1.673);
  EXPECT_EQ(lens.index(2, petzval::Wavelength::nm(1000)), 1.673);
  EXPECT_EQ(lens.dispersion(), Dispersion::catalogue);
  EXPECT_TRUE(lens.missing_glasses().empty());
  Prescription plate;
  plate.surfaces = {{.thickness = 5, .medium = constant}, {.thickness = 5}};
  EXPECT_EQ(compile(plate, std::array{10600.0}).index(1), 1.673);
  EXPECT_EQ(compile(plate).dispersion(), Dispersion::none);
  EXPECT_TRUE(compile(plate).missing_glasses().empty());
}

TEST(Compile, AbbeModelReplacesMissingGlassOnRequest) {
  const petzval::CompileOptions options{.glasses = &glasses(), .missing_glass = MissingGlass::abbe};
  for (const auto& medium : {unknown, nameless}) {
    const auto lens = compile(doublet(medium), visible, options);
    EXPECT_EQ(lens.index(2, 1), 1.673);
    EXPECT_NEAR((1.673 - 1) / (lens.index(2, 0) - lens.index(2, 2)), 32.2, 1e-9);
    EXPECT_DOUBLE_EQ(lens.index(2, 0), petzval::abbe_index(1.673, 32.2, f));
    EXPECT_DOUBLE_EQ(lens.index(1, 0) - 1.517,
                     catalogue_index("N-BK7", "schott", f) - catalogue_index("N-BK7", "schott", d));
    EXPECT_EQ(lens.dispersion(), Dispersion::abbe);
    EXPECT_EQ(lens.missing_glasses().size(), 1u);
  }
}

TEST(Compile, MediumWithoutAbbeNumberHasTheReferenceWavelengthOnly) {
  const petzval::CompileOptions options{.glasses = &glasses(), .missing_glass = MissingGlass::abbe};
  expect_error([&] { compile(doublet(bare), visible, options); },
               {"pair", "surface 1", "nd", 1.673, "V_d", 486.1327, 587.5618});
  const auto lens = compile(doublet(bare), std::array{d}, options);
  EXPECT_EQ(lens.index(2, 0), 1.673);
  EXPECT_EQ(lens.dispersion(), Dispersion::none);
}

TEST(Compile, ReferenceLineMatchesWithOneDecimal) {
  const petzval::CompileOptions options{.glasses = &glasses(), .missing_glass = MissingGlass::abbe};
  EXPECT_EQ(compile(doublet(bare), std::array{587.6}, options).index(2, 0), 1.673);
  expect_error([&] { compile(doublet(bare), std::array{587.7}, options); }, {"pair", "surface 1", 587.7});
}

TEST(Compile, AbbeModelHasThePrintedIndexAtTheReferenceWavelength) {
  for (const auto& medium : {unknown, nameless, bare}) {
    const auto lens =
        compile(doublet(medium), std::array{d},
                {.glasses = &glasses(), .index_policy = IndexPolicy::catalogue, .missing_glass = MissingGlass::abbe});
    EXPECT_EQ(lens.index(2, 0), 1.673);
    EXPECT_EQ(lens.index(1, 0), catalogue_index("N-BK7", "schott", d));
  }
}

TEST(Compile, GlassWithoutCatalogueHasTheNearestIndex) {
  petzval::Medium medium{.glass = "F2", .nd = 1.62};
  const petzval::CompileOptions options{.glasses = &glasses(), .index_policy = IndexPolicy::catalogue};
  EXPECT_NEAR(compile(doublet(medium), std::array{d}, options).index(2, 0), 1.62004, 1e-5);
  medium.nd = 1.613;
  EXPECT_NEAR(compile(doublet(medium), std::array{d}, options).index(2, 0), 1.61293, 1e-5);
  medium.nd = 1.7;  // another glass with the same name
  expect_error([&] { compile(doublet(medium), std::array{d}, options); }, {"\"F2\"", 1.7});
}

TEST(Compile, RefusesWavelengthsOutsideTheRangeOfAGlass) {
  const petzval::CompileOptions options{.glasses = &glasses()};
  EXPECT_NO_THROW(compile(doublet(flint), std::array{d, 2400.0}, options));
  expect_error(
      [&] {
        compile(doublet(flint), std::array{d, 310.0}, options);
      },
      {"pair", "surface 1", "schott N-SF5", "wavelength", 310});
  expect_error(
      [&] {
        compile(doublet(nameless), std::array{350.0}, {.glasses = &glasses(), .missing_glass = MissingGlass::abbe});
      },
      {"pair", "surface 1", "n_d 1.673", "V_d 32.2", "wavelength", 350});
}

TEST(Compile, RefusesInvalidWavelengthsForMirrorsToo) {
  Prescription mirror;
  mirror.surfaces = {{.radius = -400, .thickness = -200, .mirror = true}};
  for (const double nm : {std::nan(""), std::numeric_limits<double>::infinity(), 0.0, -d, 0.5876, 587561.8}) {
    expect_error([&] { compile(mirror, std::array{nm}); }, {"lens", "wavelength", nm});
  }
  expect_error([&] { compile(mirror, std::span<const double>{}); }, {"lens", "wavelengths"});
  EXPECT_EQ(compile(mirror, std::array{400.0, 10000.0}).index(1, 1), 1);
}

TEST(Compile, RefusesRepeatedWavelengths) {
  Prescription mirror;
  mirror.surfaces = {{.radius = -400, .thickness = -200, .mirror = true}};
  for (const double twice : {d, d + 1e-7}) {
    expect_error([&] { compile(mirror, std::array{f, d, c, twice}); }, {"lens", "wavelength", 3, twice, 1});
  }
  EXPECT_EQ(compile(mirror, std::array{d, d + 1e-5}).wavelengths_nm().size(), 2u);
}

TEST(Compile, RefusesIndicesOutOfRange) {
  petzval::Glass heavy;
  heavy.catalogue = "atlantis", heavy.name = "MYSTERIUM";
  heavy.shortest_nm = 300, heavy.longest_nm = 900;
  heavy.coefficients = {6};
  const GlassCatalogue odd({heavy});
  expect_error(
      [&] {
        compile(doublet(unknown), std::array{d},
                {.glasses = &odd, .index_policy = IndexPolicy::catalogue, .missing_glass = MissingGlass::abbe});
      },
      {"pair", "surface 1", "index", 587.5618, 6});
}

TEST(Compile, DispersionHasAName) {
  EXPECT_EQ(petzval::name(Dispersion::catalogue), "catalogue");
  EXPECT_EQ(petzval::name(Dispersion::abbe), "abbe");
  EXPECT_EQ(petzval::name(Dispersion::none), "none");
}

// Most of the 75 lenses have a medium that is in no table: the n_d/V_d model is the normal case.
TEST(Compile, LensesOfTheDataCompileIfTheirGlassesAreKnown) {
  int by_catalogue = 0, by_abbe = 0, at_d_only = 0;
  for (const Prescription& p : petzval::testing::data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const auto lens = compile(p, std::array{p.reference_wavelength_nm}, {.glasses = &glasses()});
    const std::string strict = message([&] { compile(p, visible, {.glasses = &glasses()}); });
    const std::string relaxed =
        message([&] { compile(p, visible, {.glasses = &glasses(), .missing_glass = MissingGlass::abbe}); });
    switch (lens.dispersion()) {
      case Dispersion::catalogue:
        ++by_catalogue;
        EXPECT_EQ(strict, "no error");
        break;
      case Dispersion::abbe:
        ++by_abbe;
        expect_tokens(strict, {"V_d"});
        EXPECT_EQ(relaxed, "no error");
        break;
      case Dispersion::none:
        ++at_d_only;
        EXPECT_EQ(relaxed == "no error", lens.missing_glasses().empty()) << relaxed;
        break;
    }
  }
  EXPECT_EQ(by_catalogue, 25);
  EXPECT_EQ(by_abbe, 39);
  EXPECT_EQ(at_d_only, 11);
}

TEST(Compile, RefusesMissingIndices) {
  const auto lens = compile(doublet(bare));
  expect_error([&] { lens.index(0, 1); }, {"pair", "wavelength 1"});
  expect_error([&] { lens.index(lens.surface_count() + 1, 0); }, {"pair", "space 4"});
}

TEST(Compile, PrimaryWavelengthIsNearestToTheDLine) {
  EXPECT_EQ(compile(doublet(flint), std::array{f, c, d}, {.glasses = &glasses()}).primary_wavelength(), 2u);
}

}  // namespace compile_test
