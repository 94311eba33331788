// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/colour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "../expect_error.hpp"
#include "../message.hpp"

namespace petzval {
namespace colour_test {

using testing::expect_error;
using testing::expect_tokens;
using testing::message;
const std::filesystem::path glass = std::filesystem::path(PETZVAL_TEST_DATA) / "glass";
const std::filesystem::path table_file = glass / "cie1931_2deg_5nm.csv", daylight = glass / "cie_daylight_10nm.csv";

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

const std::array<Spectrum, 4>& lights() {
  static const std::array all{illuminant("D65", daylight), illuminant("D50", daylight), illuminant("A", daylight),
                              illuminant("E", daylight)};
  return all;
}

Weights weights_of(const std::vector<double>& set, const Spectrum& light = lights()[0],
                   const Spectrum& white = lights()[0]) {
  return rgb_weights(set, table(), light, white);
}

std::array<double, 3> sum(const Weights& weights) {
  std::array<double, 3> result{};
  for (const auto& weight : weights) {
    for (std::size_t k = 0; k < 3; ++k) result[k] += weight[k];
  }
  return result;
}

std::array<double, 3> times(const std::array<std::array<double, 3>, 3>& matrix, const std::array<double, 3>& v) {
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) result[i] += matrix[i][k] * v[k];
  }
  return result;
}

const std::vector<double> f_d_c{486.1, 587.6, 656.3}, coarse{420, 680}, fine{430, 470, 510, 550, 590, 630, 670};

// Chromaticities of the illuminants in CIE 15, with five digits, from sums in steps of 5 nm.
TEST(Illuminant, HasThePublishedChromaticity) {
  constexpr std::array<std::array<double, 2>, 4> printed{
      {{0.31272, 0.32903}, {0.34567, 0.35851}, {0.44758, 0.40745}, {1 / 3.0, 1 / 3.0}}};
  for (std::size_t i = 0; i < lights().size(); ++i) {
    const auto [x, y, z] = tristimulus(lights()[i], table());
    EXPECT_NEAR(x / (x + y + z), printed[i][0], 5e-5) << i;
    EXPECT_NEAR(y / (x + y + z), printed[i][1], 5e-5) << i;
  }
}

TEST(Illuminant, HasThePublishedPower) {
  const auto at = [&](const Spectrum& light, double nm) {
    const auto& list = light.wavelengths_nm;
    return light.power[static_cast<std::size_t>(std::find(list.begin(), list.end(), nm) - list.begin())];
  };
  const auto& [d65, d50, a, e] = lights();
  for (const auto& [nm, power] : {std::pair{400.0, 82.7549}, {450.0, 117.008}, {560.0, 100.0}, {600.0, 90.0062}}) {
    EXPECT_NEAR(at(d65, nm), power, 5e-4) << nm;
  }
  EXPECT_NEAR(at(d50, 450), 87.2472, 5e-4);
  EXPECT_NEAR(at(a, 400), 14.7080, 5e-4);
  EXPECT_NEAR(at(a, 700), 198.261, 5e-4);
  expect_error([] { illuminant("D66", daylight); }, {"illuminant", "\"D66\""});
}

TEST(Tristimulus, IsLinearInTheLight) {
  const auto& [d65, d50, a, e] = lights();
  Spectrum mixed = d65;  // the lamp is resampled at the wavelengths of daylight
  Spectrum lamp{d65.wavelengths_nm, {}};
  for (std::size_t i = 0; i < mixed.power.size(); ++i) {
    lamp.power.push_back(a.power[2 * i]);
    mixed.power[i] = 2 * d65.power[i] + 3 * lamp.power[i];
  }
  const auto one = tristimulus(d65, table()), other = tristimulus(lamp, table()), both = tristimulus(mixed, table());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(both[k] / (2 * one[k] + 3 * other[k]), 1, 1e-13);
}

TEST(Tristimulus, IsTheMatchingFunctionOfANarrowBand) {
  const auto xyz = tristimulus({{549.999, 550, 550.001}, {0, 1000, 0}}, table());
  EXPECT_NEAR(xyz[0], 0.4334499, 1e-4);
  EXPECT_NEAR(xyz[1], 0.9949501, 1e-4);
  EXPECT_NEAR(xyz[2], 0.0087499, 1e-4);
}

std::array<double, 2> xy_of(const Spectrum& light) {
  const auto xyz = tristimulus(light, table());
  const double sum = xyz[0] + xyz[1] + xyz[2];
  return {xyz[0] / sum, xyz[1] / sum};
}

TEST(CorrelatedColourTemperature, OfABlackBodyIsItsTemperature) {
  for (const double kelvin : {2000.0, 2856.0, 4000.0, 6504.0, 10000.0, 15000.0}) {
    Spectrum light;
    for (int nm = 360; nm <= 830; ++nm) {
      light.wavelengths_nm.push_back(nm);
      light.power.push_back(std::pow(nm / 560.0, -5) / std::expm1(1.438776877e7 / (nm * kelvin)));
    }
    EXPECT_NEAR(correlated_colour_temperature(xy_of(light), table()).value(), kelvin, 2e-4 * kelvin);
  }
}

// CIE 15: D65 has 6504 K, D50 has 5003 K, A has 2856 K. E: 5455 K.
TEST(CorrelatedColourTemperature, OfIlluminantsIsThePublishedValue) {
  constexpr std::array kelvin{6504.0, 5003.0, 2856.0, 5455.0};
  for (std::size_t i = 0; i < kelvin.size(); ++i) {
    EXPECT_NEAR(correlated_colour_temperature(xy_of(lights()[i]), table()).value(), kelvin[i], 5) << i;
  }
}

TEST(CorrelatedColourTemperature, IsAbsentFarFromBlackBodies) {
  EXPECT_FALSE(correlated_colour_temperature({0.3, 0.6}, table()));    // green
  EXPECT_FALSE(correlated_colour_temperature({0.15, 0.06}, table()));  // blue
  EXPECT_FALSE(correlated_colour_temperature({0.7, 0.3}, table()));    // red
}

TEST(RgbWeights, OneWavelengthIsWhite) {
  for (const double nm : {587.5618, 435.8, 1000.0}) EXPECT_EQ(weights_of({nm}), (Weights{{1, 1, 1}}));
}

TEST(RgbWeights, LightIsItsWhitePoint) {
  const Spectrum led{{440, 455, 470, 560, 700}, {0, 10, 2, 6, 0}};
  for (const auto& set : {f_d_c, coarse, fine}) {
    for (const Spectrum& light : {lights()[0], lights()[1], lights()[2], lights()[3], led}) {
      for (const double channel : sum(weights_of(set, light, light))) EXPECT_NEAR(channel, 1, 1e-14);
    }
  }
}

TEST(RgbWeights, IndependentOfTheUnitOfPower) {
  Spectrum bright = lights()[2];
  for (double& power : bright.power) power *= 1024;
  EXPECT_EQ(weights_of(fine, bright, lights()[0]), weights_of(fine, lights()[2], lights()[0]));
  EXPECT_EQ(weights_of(fine, lights()[0], bright), weights_of(fine, lights()[0], lights()[2]));
}

// The weights of a set add up to the colour of the light: linear sRGB of its chromaticity at luminance 1.
TEST(RgbWeights, ShowTheColourOfALight) {
  constexpr std::array<std::array<double, 3>, 3> srgb{
      {{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}}};
  const auto expected = times(srgb, {0.44758 / 0.40745, 1, 0.14497 / 0.40745});
  for (const auto& set : {f_d_c, coarse, fine}) {
    const auto lamp = sum(weights_of(set, lights()[2], lights()[0]));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(lamp[k], expected[k], 5e-4);
    EXPECT_GT(sum(weights_of(set, lights()[0], lights()[2]))[2], 1.5);  // daylight is blue relative to a lamp
  }
}

// D50 of ICC profiles, adapted to D65 by the Bradford transform; matrix published by Lindbloom.
TEST(RgbWeights, AdaptColoursByTheBradfordTransform) {
  constexpr std::array<std::array<double, 3>, 3> d50_to_d65{
      {{0.9555766, -0.0230393, 0.0631636}, {-0.0282895, 1.0099416, 0.0210077}, {0.0122982, -0.0204830, 1.3299098}}};
  constexpr std::array<std::array<double, 3>, 3> srgb{
      {{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}}};
  for (const Spectrum& light : {lights()[0], lights()[2]}) {
    auto xyz = tristimulus(light, table());
    const double level = xyz[1];
    for (double& value : xyz) value /= level;
    const auto expected = times(srgb, times(d50_to_d65, xyz)), found = sum(weights_of(fine, light, lights()[1]));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-3);
  }
}

TEST(RgbWeights, FollowTheOrderOfTheSet) {
  const Weights rising = weights_of({460, 540, 620}), mixed = weights_of({620, 460, 540});
  EXPECT_EQ(mixed, (Weights{rising[2], rising[0], rising[1]}));
  EXPECT_GT(rising[0][2], 0.8);  // blue, green, red
  EXPECT_GT(rising[1][1], 0.6);
  EXPECT_GT(rising[2][0], 0.6);
}

TEST(RgbWeights, BandsEndHalfWayBetweenWavelengths) {
  // Trapezoidal sums over the 5 nm table for the bands 360-500, 500-580 and 580-830 nm, in light of equal power. A
  // white point of daylight applies one colour transform to all weights.
  constexpr std::array<double, 4> edges{360, 500, 580, 830};
  std::array<double, 3> luminance{};
  for (std::size_t band = 0; band < 3; ++band) {
    for (std::size_t i = 0; i < table().wavelengths_nm.size(); ++i) {
      const double nm = table().wavelengths_nm[i];
      if (nm < edges[band] || nm > edges[band + 1]) continue;
      luminance[band] += (nm == edges[band] || nm == edges[band + 1] ? 2.5 : 5.0) * table().xyz[i][1];
    }
  }
  const Weights weights = weights_of({460, 540, 620}, lights()[3], lights()[0]);
  const double all = luminance[0] + luminance[1] + luminance[2];
  for (std::size_t band = 0; band < 3; ++band) {
    const auto [r, g, b] = weights[band];
    EXPECT_NEAR(0.2126 * r + 0.7152 * g + 0.0722 * b, luminance[band] / all, 3e-4);  // Y of linear sRGB
  }
}

TEST(RgbWeights, RefusesInvalidSets) {
  const auto of = [](const std::vector<double>& set) { return message([&] { weights_of(set); }); };
  expect_tokens(of({}), {"rgb_weights", "no wavelength"});
  expect_tokens(of({486.1, 700}), {"rgb_weights", "wavelength", 700});
  expect_tokens(of({486.1, std::nan("")}), {"rgb_weights", "wavelength", "nan"});
  expect_tokens(of({486.1, 550, 486.1}), {"rgb_weights", "wavelength", 486.1});
}

TEST(RgbWeights, RefusesLightsWithoutLuminance) {
  const auto of = [](const Spectrum& light) { return message([&] { weights_of(fine, light); }); };
  expect_tokens(of({{900, 1000}, {1, 1}}), {"rgb_weights", "luminance", 0});
  expect_tokens(of({{400, 700}, {1, std::nan("")}}), {"Spectrum", "power", 1, "nan"});
  expect_tokens(of({{400, 400}, {1, 1}}), {"Spectrum", "wavelength", 1, 400});
  expect_tokens(of({{400, 700}, {1}}), {"Spectrum", "number", 2, "powers", 1});
}

TEST(Tristimulus, RefusesInvalidTables) {
  const auto refusal = [](const ColourMatching& bad) {
    const std::array set{500.0, 600.0};
    const std::string said = message([&] { tristimulus(lights()[3], bad); });
    EXPECT_EQ(message([&] { rgb_weights(set, bad, lights()[0], lights()[0]); }), said);
    return said;
  };
  expect_tokens(refusal({}), {"ColourMatching", "number", 0, "triples", 0});
  expect_tokens(refusal({{400, 700}, {{1, 1, 1}}}), {"ColourMatching", "number", 2, "triples", 1});
  expect_tokens(refusal({{700, 400}, {{1, 1, 1}, {1, 1, 1}}}), {"ColourMatching", "wavelength", 1, 400});
  expect_tokens(refusal({{400, 700}, {{1, 1, 1}, {1, std::nan(""), 1}}}), {"ColourMatching", "value", 1, "nan"});
  EXPECT_DOUBLE_EQ(tristimulus({{400, 700}, {1, 1}}, {{500, 600}, {{1, 2, 3}, {1, 2, 3}}})[1], 200);
}

TEST(RgbTriple, GivesEachChannelAWavelength) {
  EXPECT_EQ(rgb_triple_nm, (std::array<double, 3>{650, 510, 475}));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(rgb_triple_weights[i][k], i == k ? 1 : 0);
  }
}

/// The error message for a file with this text, without the file name.
template <class Load>
std::string complaint(const std::string& text, const Load& load) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_colour_test.csv";
  std::ofstream(file) << text;
  const std::string found = message([&] { load(file); });
  std::filesystem::remove(file);
  return found.rfind(file.string() + ": ", 0) == 0 ? found.substr(file.string().size() + 2) : found;
}

TEST(Spectrum, RefusesInvalidFiles) {
  const auto of = [](const std::string& text) { return complaint(text, [](const auto& f) { Spectrum::load(f); }); };
  const std::string header = "wavelength_nm,power\n";
  EXPECT_EQ(of(header + "400,1\r\n700,0\r\n"), "no error");
  expect_tokens(of("nm,power\n"), {"line 1", "\"nm,power\""});
  expect_tokens(of(""), {"number", 0});
  expect_tokens(of(header + "400,1\n"), {"number", 1});
  expect_tokens(of(header + "400,1\n500,-1\n"), {"line 3", "power", -1});
  expect_tokens(of(header + "400,nan\n"), {"line 2", "\"400,nan\""});
  expect_tokens(of(header + "400,1,2\n"), {"line 2", "\"400,1,2\""});
  expect_tokens(of(header + "400\n"), {"line 2", "\"400\""});
  expect_tokens(of(header + "500,1\n400,1\n"), {"line 3", "wavelength", 400});
  expect_tokens(of(header + "-5,1\n"), {"line 2", "wavelength", -5});
  const std::filesystem::path folder = ::testing::TempDir();
  expect_error([&] { Spectrum::load(folder); }, {folder, "folder"});
  expect_error([] { Spectrum::load("no/such.csv"); }, {"no/such.csv", "No such file"});
}

TEST(ColourMatching, RefusesInvalidTables) {
  const auto of = [](const std::string& text) {
    return complaint(text, [](const auto& file) { ColourMatching::load(file); });
  };
  const std::string header = "wavelength_nm,xbar,ybar,zbar\n";
  expect_tokens(of("a,b\n"), {"line 1", "\"a,b\""});
  expect_tokens(of(header + "400,1,2\n"), {"line 2", "\"400,1,2\""});
  expect_tokens(of(header + "400,1,2,3,4\n"), {"line 2", "\"400,1,2,3,4\""});
  expect_tokens(of(header + "400,1,nan,3\n"), {"line 2", "\"400,1,nan,3\""});
  expect_tokens(of(header + "400,1,2,3\r\n400,1,2,3\r\n"), {"line 3", "wavelength", 400});
  expect_tokens(of(header + "430,1,2,3\n700,1,2,3\n"), {"table"});
  expect_tokens(of(header), {"table"});
  expect_tokens(of(""), {"table"});  // an empty file has no header
  expect_error([] { ColourMatching::load("no/such.csv"); }, {"no/such.csv", "No such file"});
}

}  // namespace colour_test
}  // namespace petzval
