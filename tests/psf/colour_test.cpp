// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/colour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "../message.hpp"

namespace petzval {
namespace {

using testing::message;
const std::filesystem::path table_file = std::filesystem::path(PETZVAL_TEST_DATA) / "glass" / "cie1931_2deg_5nm.csv";

const ColourMatching& table() {
  static const ColourMatching loaded = ColourMatching::load(table_file);
  return loaded;
}

using Weights = std::vector<std::array<double, 3>>;

TEST(ColourMatching, ReadsTheTable) {
  ASSERT_EQ(table().wavelengths_nm.size(), table().xyz.size());
  const auto at = [&](double nm) {
    const auto& list = table().wavelengths_nm;
    return table().xyz[static_cast<std::size_t>(std::find(list.begin(), list.end(), nm) - list.begin())];
  };
  EXPECT_EQ(table().wavelengths_nm.front(), 360);
  EXPECT_EQ(at(555)[1], 1.0);     // the peak of luminous efficiency
  EXPECT_EQ(at(600)[0], 1.0622);  // CIE 15, table T.4
  EXPECT_EQ(at(450)[2], 1.77211);
}

TEST(RgbWeights, OneWavelengthIsWhite) {
  for (const double nm : {587.5618, 435.8, 1000.0}) {
    EXPECT_EQ(rgb_weights(std::array{nm}, table()), (Weights{{1, 1, 1}}));
  }
}

TEST(RgbWeights, SetsSumToWhite) {
  for (const std::vector<double>& set :
       {std::vector{486.1, 587.6, 656.3}, {420.0, 680.0}, {430.0, 470.0, 510.0, 550.0, 590.0, 630.0, 670.0}}) {
    std::array<double, 3> sum{};
    for (const auto& weight : rgb_weights(set, table())) {
      for (std::size_t k = 0; k < 3; ++k) sum[k] += weight[k];
    }
    for (const double channel : sum) EXPECT_NEAR(channel, 1, 1e-14);
  }
}

TEST(RgbWeights, FollowTheOrderOfTheSet) {
  const Weights rising = rgb_weights(std::array{460.0, 540.0, 620.0}, table());
  const Weights mixed = rgb_weights(std::array{620.0, 460.0, 540.0}, table());
  EXPECT_EQ(mixed, (Weights{rising[2], rising[0], rising[1]}));
  EXPECT_GT(rising[0][2], 0.8);  // blue, green, red
  EXPECT_GT(rising[1][1], 0.6);
  EXPECT_GT(rising[2][0], 0.6);
}

TEST(RgbWeights, BandsEndHalfWayBetweenWavelengths) {
  // Trapezoidal sums over the 5 nm table for the bands 420-500, 500-580 and 580-680 nm.
  constexpr std::array<double, 4> edges{420, 500, 580, 680};
  std::array<std::array<double, 3>, 3> expected{};
  std::array<double, 3> white{};
  for (std::size_t band = 0; band < 3; ++band) {
    for (std::size_t i = 0; i < table().wavelengths_nm.size(); ++i) {
      const double nm = table().wavelengths_nm[i];
      if (nm < edges[band] || nm > edges[band + 1]) continue;
      const double w = nm == edges[band] || nm == edges[band + 1] ? 2.5 : 5.0;
      const auto& [x, y, z] = table().xyz[i];
      const std::array<double, 3> rgb{3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                                      0.0557 * x - 0.2040 * y + 1.0570 * z};
      for (std::size_t k = 0; k < 3; ++k) expected[band][k] += w * rgb[k], white[k] += w * rgb[k];
    }
  }
  const Weights weights = rgb_weights(std::array{460.0, 540.0, 620.0}, table());
  for (std::size_t band = 0; band < 3; ++band) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(weights[band][k], expected[band][k] / white[k], 1e-12);
  }
}

TEST(RgbWeights, RefusesSetsWithoutAMeaning) {
  const auto of = [](const std::vector<double>& set) { return message([&] { rgb_weights(set, table()); }); };
  EXPECT_EQ(of({}), "rgb_weights: no wavelength, wanted one at least");
  EXPECT_EQ(of({486.1, 700}), "rgb_weights: wavelength is 700 nm, wanted 420 to 680");
  EXPECT_EQ(of({486.1, std::nan("")}), "rgb_weights: wavelength is nan nm, wanted 420 to 680");
  EXPECT_EQ(of({486.1, 550, 486.1}), "rgb_weights: wavelength 486.1 nm stands twice, wanted once");
}

TEST(ColourMatching, SaysWhatIsWrongWithATable) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_colour_test.csv";
  const auto of = [&](const std::string& text) {
    std::ofstream(file) << text;
    const std::string found = message([&] { ColourMatching::load(file); });
    return found.rfind(file.string() + ": ", 0) == 0 ? found.substr(file.string().size() + 2) : found;
  };
  const std::string header = "wavelength_nm,xbar,ybar,zbar\n";
  EXPECT_EQ(of("a,b\n"), "line 1: found \"a,b\", wanted \"wavelength_nm,xbar,ybar,zbar\"");
  EXPECT_EQ(of(header + "400,1,2\n"), "line 2: found \"400,1,2\", wanted four finite numbers with commas between them");
  EXPECT_EQ(of(header + "400,1,2,3,4\n"),
            "line 2: found \"400,1,2,3,4\", wanted four finite numbers with commas between them");
  EXPECT_EQ(of(header + "400,1,nan,3\n"),
            "line 2: found \"400,1,nan,3\", wanted four finite numbers with commas between them");
  EXPECT_EQ(of(header + "400,1,2,3\r\n400,1,2,3\r\n"),
            "line 3: wavelength is 400 nm, wanted more than the 400 of the line before");
  EXPECT_EQ(of(header + "430,1,2,3\n700,1,2,3\n"),
            "the table ends early, wanted one from 420 nm or less to 680 or more");
  EXPECT_EQ(of(header), "the table ends early, wanted one from 420 nm or less to 680 or more");
  std::filesystem::remove(file);
  EXPECT_EQ(of("") /* an empty file has no header */,
            "the table ends early, wanted one from 420 nm or less to 680 or more");
  std::filesystem::remove(file);
  EXPECT_NE(message([&] { ColourMatching::load(file); }).find(file.string() + ": cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace petzval
