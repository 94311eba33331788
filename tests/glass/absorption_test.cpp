// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "../expect_error.hpp"
#include "petzval/glass/glass.hpp"

namespace glass_absorption_test {

using petzval::absorption;
using petzval::Glass;
using petzval::testing::expect_error;

Glass glass(std::vector<petzval::AbsorptionEntry> table) {
  return {.catalogue = "made-up", .name = "GREY", .coefficients = {1.5}, .absorption = std::move(table)};
}

TEST(Absorption, TwiceTheThickness_SquaresTheTransmittance) {
  const Glass grey = glass({{400, 0.02}, {500, 0.004}, {700, 0.001}});
  for (double nm = 350; nm <= 800; nm += 12.5) {
    const double per_mm = absorption(grey, nm).value();
    EXPECT_NEAR(std::exp(-per_mm * 20), std::pow(std::exp(-per_mm * 10), 2), 1e-15) << nm;
    EXPECT_GE(per_mm, 0.001) << nm;
    EXPECT_LE(per_mm, 0.02) << nm;
  }
}

TEST(Absorption, BetweenEntries_IsLinear) {
  const Glass grey = glass({{400, 0.02}, {500, 0.004}, {700, 0.001}});
  EXPECT_EQ(absorption(grey, 400), 0.02);
  EXPECT_EQ(absorption(grey, 500), 0.004);
  EXPECT_EQ(absorption(grey, 700), 0.001);
  EXPECT_NEAR(absorption(grey, 425).value(), 0.016, 1e-16);
  EXPECT_NEAR(absorption(grey, 600).value(), 0.0025, 1e-16);
}

TEST(Absorption, OutsideTheTable_IsTheValueAtItsEnd) {
  const Glass grey = glass({{400, 0.02}, {700, 0.001}});
  EXPECT_EQ(absorption(grey, 1), 0.02);
  EXPECT_EQ(absorption(grey, 1e5), 0.001);
}

TEST(Absorption, TableOfOneEntry_IsConstant) {
  for (const double nm : {100.0, 550.0, 2000.0}) EXPECT_EQ(absorption(glass({{550, 0.01}}), nm), 0.01);
}

TEST(Absorption, GlassWithoutATable_IsUnknown) { EXPECT_EQ(absorption(glass({}), 550), std::nullopt); }

TEST(Absorption, InvalidWavelength_IsRefused) {
  for (const double nm : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    expect_error([&] { return absorption(glass({{550, 0.01}}), nm); }, {"GREY", "wavelength", nm});
    expect_error([&] { return absorption(glass({}), nm); }, {"GREY", "wavelength", nm});
  }
  expect_error([&] { return absorption(glass({}), std::nan("")); }, {"GREY", "wavelength"});
}

}  // namespace glass_absorption_test
