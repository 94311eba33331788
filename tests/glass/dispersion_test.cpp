// SPDX-License-Identifier: Apache-2.0
#include "petzval/glass/glass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"

namespace dispersion_test {

using petzval::DispersionFormula;
using petzval::Glass;
using petzval::refractive_index;
using petzval::spectral_line_nm;
using petzval::testing::expect_error;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

const petzval::GlassCatalogue& glasses() {
  static const auto catalogue = petzval::GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  return catalogue;
}

Glass made_up(DispersionFormula formula, std::vector<double> coefficients) {
  Glass glass;
  glass.catalogue = "test";
  glass.name = "X";
  glass.formula = formula;
  glass.shortest_nm = 200;
  glass.longest_nm = 2000;
  glass.coefficients = std::move(coefficients);
  return glass;
}

TEST(Dispersion, EveryGlassGivesItsPrintedIndexAndAbbeNumber) {
  ASSERT_GE(glasses().glasses().size(), 2600u);
  for (const Glass& glass : glasses().glasses()) {
    // Infrared materials that are opaque at the d line have their index at 10.6 um, and no Abbe number.
    const bool opaque = glass.shortest_nm > petzval::d_line_nm;
    const double nd = refractive_index(glass, opaque ? 10600 : petzval::d_line_nm);
    EXPECT_NEAR(nd, glass.nd, 3e-5) << glass.catalogue << ' ' << glass.name;
    if (glass.vd == 0 && glass.catalogue == "infrared") continue;
    const double vd =
        (nd - 1) / (refractive_index(glass, spectral_line_nm("F")) - refractive_index(glass, spectral_line_nm("C")));
    EXPECT_NEAR(vd, glass.vd, 0.05) << glass.catalogue << ' ' << glass.name;
  }
}

TEST(Dispersion, EveryGlassBendsBlueMoreThanRed) {
  for (const Glass& glass : glasses().glasses()) {
    double before = infinity;
    for (double nm = std::max(400.0, glass.shortest_nm); nm <= std::min(700.0, glass.longest_nm); nm += 5) {
      const double n = refractive_index(glass, nm);
      ASSERT_LT(n, before) << glass.catalogue << ' ' << glass.name << " at " << nm << " nm";
      before = n;
    }
  }
}

// Numbers that makers of infrared optics print, with three decimals or more; crystals of makers differ by 1e-3.
TEST(Dispersion, InfraredMaterialsHaveTheIndicesOfMakers) {
  for (const auto& [name, um, index] : {std::tuple{"GERMANIUM", 4.0, 4.0246},
                                        {"GERMANIUM", 10.6, 4.0036},
                                        {"SILICON", 4.0, 3.4255},
                                        {"ZNSE", 10.6, 2.4028},
                                        {"ZNS", 10.0, 2.2005},
                                        {"GAAS", 10.6, 3.2706},
                                        {"IG6", 10.0, 2.7775},
                                        {"BD-2", 5.0, 2.6173}}) {
    EXPECT_NEAR(refractive_index(*glasses().find(name, "infrared"), um * 1000), index, 1e-3) << name << ' ' << um;
  }
}

// The data sheet of N-BK7 prints these five decimals, from the near ultraviolet to the infrared.
TEST(Dispersion, BoroCrownHasTheIndicesOfItsDataSheet) {
  const Glass* glass = glasses().find("N-BK7", "schott");
  ASSERT_NE(glass, nullptr);
  const std::vector<std::pair<double, double>> sheet = {{2325.4, 1.48921},
                                                        {1970.1, 1.49495},
                                                        {1529.6, 1.50091},
                                                        {1060.0, 1.50669},
                                                        {spectral_line_nm("t"), 1.50731},
                                                        {spectral_line_nm("s"), 1.50980},
                                                        {spectral_line_nm("r"), 1.51289},
                                                        {spectral_line_nm("C"), 1.51432},
                                                        {spectral_line_nm("C'"), 1.51472},
                                                        {632.8, 1.51509},
                                                        {spectral_line_nm("D"), 1.51673},
                                                        {spectral_line_nm("d"), 1.51680},
                                                        {spectral_line_nm("e"), 1.51872},
                                                        {spectral_line_nm("F"), 1.52238},
                                                        {spectral_line_nm("F'"), 1.52283},
                                                        {spectral_line_nm("g"), 1.52668},
                                                        {spectral_line_nm("h"), 1.53024},
                                                        {spectral_line_nm("i"), 1.53627}};
  for (const auto& [nm, n] : sheet) EXPECT_NEAR(refractive_index(*glass, nm), n, 5.5e-6) << nm;
}

// One glass per formula, computed by hand at a wavelength that gives round numbers.
TEST(Dispersion, FormulasEqualTheirDefinitions) {
  using enum DispersionFormula;
  EXPECT_DOUBLE_EQ(refractive_index(made_up(sellmeier, {0.5, 1, 0.5}), 1000), std::sqrt(1 + 0.5 + 1 / (1 - 0.5)));
  EXPECT_DOUBLE_EQ(refractive_index(made_up(sellmeier_squared, {0.5, 1, 0.5}), 1000),
                   std::sqrt(1 + 0.5 + 1 / (1 - 0.25)));
  EXPECT_DOUBLE_EQ(refractive_index(made_up(polynomial, {2, 0.25, 2, 0.5, -2}), 500), std::sqrt(2 + 0.0625 + 2.0));
  EXPECT_DOUBLE_EQ(refractive_index(made_up(cauchy, {1.5, 0.25, -2}), 500), 2.5);
  EXPECT_DOUBLE_EQ(refractive_index(made_up(buchdahl, {1.5, -0.0625, 0.125}), 974), 1.5 - 0.0625 * 0.2 + 0.125 * 0.04);
  EXPECT_DOUBLE_EQ(refractive_index(made_up(rational, {2, 0.25, 2, 0.5, 0.125, 0, -1}), 1000),
                   std::sqrt(2 + 0.25 / 0.5 + 0.125 / 2));
  EXPECT_DOUBLE_EQ(refractive_index(made_up(rational, {2, 4, 4, 0}), 500), std::sqrt(2 + 4 * 0.25));
  const double pole = 1 / (0.25 - 0.028);
  EXPECT_DOUBLE_EQ(refractive_index(made_up(herzberger, {1.5, 0.25, 0.125, 0.5, 0.25, 0.125}), 500),
                   1.5 + 0.25 * pole + 0.125 * pole * pole + 0.5 * 0.25 + 0.25 * 0.0625 + 0.125 * 0.015625);
}

Glass table_of(const Glass& glass, const std::vector<double>& wavelengths_nm) {
  Glass table = made_up(DispersionFormula::tabulated, {});
  for (const double nm : wavelengths_nm) {
    table.coefficients.insert(table.coefficients.end(), {nm * 1e-3, refractive_index(glass, nm)});
  }
  table.shortest_nm = wavelengths_nm.front();
  table.longest_nm = wavelengths_nm.back();
  return table;
}

TEST(Dispersion, TableIsExactAtItsIndicesAndMonotonicBetween) {
  const Glass& flint = *glasses().find("SF6", "schott");
  const std::vector<double> lines = {404.6561, 435.8343, 486.1327, 587.5618, 656.2725, 706.5188};
  const Glass table = table_of(flint, lines);
  for (const double nm : lines) EXPECT_NEAR(refractive_index(table, nm), refractive_index(flint, nm), 1e-15);
  double before = infinity;
  for (double nm = 405; nm <= 706; ++nm) {
    const double n = refractive_index(table, nm);
    EXPECT_LT(n, before) << nm;
    before = n;
  }
}

// Halving the step divides the error by more than 4, because cubics are more accurate than chords.
TEST(Dispersion, FinerTablesAreMoreAccurate) {
  const Glass& flint = *glasses().find("SF6", "schott");
  const auto worst = [&](double step) {
    std::vector<double> nodes;
    for (double nm = 400; nm <= 720; nm += step) nodes.push_back(nm);
    const Glass table = table_of(flint, nodes);
    double error = 0;
    for (double nm = 440; nm <= 680; nm += 1) {
      error = std::max(error, std::abs(refractive_index(table, nm) - refractive_index(flint, nm)));
    }
    return error;
  };
  EXPECT_LT(worst(40), 2e-4);
  EXPECT_LT(worst(20), worst(40) / 5);
  EXPECT_LT(worst(10), worst(20) / 5);
}

TEST(Dispersion, TableOfTwoIndicesIsALineOverTheInverseSquare) {
  const Glass table = made_up(DispersionFormula::tabulated, {0.5, 1.75, 1, 1.5});
  EXPECT_NEAR(refractive_index(table, 1000 / std::sqrt(2.5)), 1.625, 1e-15);
}

TEST(Dispersion, TableStaysWithinItsIndices) {
  const Glass table = made_up(DispersionFormula::tabulated, {0.4, 1.5, 0.5, 1.75, 0.6, 1.5, 0.7, 1.5});
  for (double nm = 400; nm <= 700; ++nm) {
    const double n = refractive_index(table, nm);
    EXPECT_GE(n, 1.5 - 1e-15) << nm;
    EXPECT_LE(n, 1.75 + 1e-15) << nm;
  }
}

TEST(Dispersion, SpectralLinesEqualTheTable) {
  std::ifstream table(std::filesystem::path(PETZVAL_TEST_DATA) / "glass" / "spectral_lines.csv");
  std::string line;
  std::getline(table, line);
  int count = 0;
  for (; std::getline(table, line); ++count) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    EXPECT_EQ(spectral_line_nm(line.substr(0, first)), std::stod(line.substr(first + 1, second - first - 1))) << line;
  }
  EXPECT_EQ(count, 14);
  EXPECT_EQ(spectral_line_nm("d"), petzval::d_line_nm);
  expect_error([] { spectral_line_nm("z"); }, {"spectral line \"z\"", "unknown"});
}

TEST(Dispersion, WavelengthsOutsideTheRangeAreRefusedWithTheRange) {
  const Glass& glass = *glasses().find("N-BK7", "schott");
  for (const double nm : {nan, infinity, -infinity, 0.0, -587.5618, 0.5875618, 299.9, 2500.1, 150000.0}) {
    expect_error([&] { refractive_index(glass, nm); }, {"schott N-BK7", "wavelength", nm});
  }
}

TEST(Dispersion, TheEndsOfTheRangeBelongToIt) {
  for (const Glass& glass : glasses().glasses()) {
    EXPECT_GT(refractive_index(glass, glass.shortest_nm), 1) << glass.name;
    EXPECT_GT(refractive_index(glass, glass.longest_nm), 1) << glass.name;
  }
  // The t line, 1013.98 nm, is the printed end of ranges; converted from micrometres it becomes 1013.9799999999999.
  EXPECT_GT(refractive_index(*glasses().find("BAC4", "hoya"), spectral_line_nm("t")), 1.5);
}

TEST(Dispersion, NoIndexBeyondAPole) {
  using enum DispersionFormula;
  const std::string at = "test X: square of the index at 500 nm = ";
  expect_error([] { refractive_index(made_up(sellmeier, {0, 1, 0.25}), 500); }, {at, "inf"});
  expect_error([] { refractive_index(made_up(sellmeier, {0, 1, 0.5}), 500); }, {at, 0});
  expect_error([] { refractive_index(made_up(polynomial, {1e-6}), 500); }, {at, "1e-06"});
  expect_error([] { refractive_index(made_up(cauchy, {-1.5}), 500); }, {at, -2.25});
  expect_error([] { refractive_index(made_up(cauchy, {nan}), 500); }, {at, "nan"});
}

TEST(Dispersion, IncompleteFormulasAreRefused) {
  using enum DispersionFormula;
  expect_error([] { refractive_index(made_up(sellmeier, {0, 1}), 500); }, {"test X", "formula", 2});
  expect_error([] { refractive_index(made_up(cauchy, {}), 500); }, {"test X", "formula", 0});
  expect_error([] { refractive_index(made_up(buchdahl, {1.5}), 500); }, {"test X", "formula", 1});
  expect_error([] { refractive_index(made_up(rational, {1.5, 1, 2}), 500); }, {"test X", "formula", 3});
  expect_error([] { refractive_index(made_up(herzberger, {1.5}), 500); }, {"test X", "formula", 1});
  expect_error([] { refractive_index(made_up(tabulated, {0.5, 1.5, 1}), 500); }, {"test X", "formula", 3});
}

TEST(Dispersion, TheAbbeModelKeepsIndexAndAbbeNumber) {
  for (const auto& [nd, vd] :
       {std::pair{1.5168, 64.17}, std::pair{1.80518, 25.4}, std::pair{0.9, 30.0}, std::pair{4.0, 100.0}}) {
    const double n_f = petzval::abbe_index(nd, vd, spectral_line_nm("F")),
                 n_c = petzval::abbe_index(nd, vd, spectral_line_nm("C"));
    EXPECT_EQ(petzval::abbe_index(nd, vd, petzval::d_line_nm), nd);
    EXPECT_NEAR((nd - 1) / (n_f - n_c), vd, 1e-11 * vd);
  }
}

TEST(Dispersion, AbbeModelHasTheStatedError) {
  std::vector<double> errors;
  for (const Glass& glass : glasses().glasses()) {
    if (glass.catalogue == "infrared") continue;
    double worst = 0;
    for (double nm = std::max(420.0, glass.shortest_nm); nm <= std::min(680.0, glass.longest_nm); nm += 10) {
      worst = std::max(worst, std::abs(petzval::abbe_index(glass.nd, glass.vd, nm) - refractive_index(glass, nm)));
    }
    errors.push_back(worst);
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 5e-4);
  EXPECT_LT(errors[errors.size() * 95 / 100], 5e-3);
  EXPECT_LT(errors.back(), 0.0165);
}

TEST(Dispersion, AbbeModelRefusesInvalidNumbers) {
  expect_error([] { petzval::abbe_index(1.5, 0, 500); }, {"n_d 1.5", "V_d 0", "V_d", 0});
  expect_error([] { petzval::abbe_index(1.5, nan, 500); }, {"n_d 1.5", "V_d nan", "V_d", "nan"});
  expect_error([] { petzval::abbe_index(-1, 60, 500); }, {"n_d -1", "V_d 60", "n_d", -1});
  expect_error([] { petzval::abbe_index(1.5, 60, 0.5); }, {"n_d 1.5", "V_d 60", "wavelength", 0.5});
}

}  // namespace dispersion_test
