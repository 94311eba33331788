// SPDX-License-Identifier: Apache-2.0
#include "petzval/formats/lens_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/apertures.hpp"
#include "said.hpp"

namespace glass_files_test {

namespace fs = std::filesystem;
using petzval::Glass;
using petzval::GlassFile;
using petzval::read_glasses;
using petzval::refractive_index;
using petzval::testing::expect_error;
using petzval::testing::expect_said;
using petzval::testing::expect_tokens;
using petzval::testing::message;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const std::string every_formula = bytes_of(fs::path(PETZVAL_TEST_SAMPLES) / "every_formula.agf");

class GlassFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::path(::testing::TempDir()) / (std::string("petzval_") + test->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  fs::path written(const std::string& name, std::string_view bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }
  GlassFile read(std::string_view bytes, const std::string& name = "Made-Up.agf") const {
    return read_glasses(written(name, bytes));
  }
  /// The error message for the file, without the name of the folder.
  std::string refusal(std::string_view bytes, const std::string& name = "x.agf") const {
    const std::string all = message([&] { read(bytes, name); });
    const std::string prefix = (folder / name).string();
    return all.starts_with(prefix) ? all.substr(prefix.size()) : all;
  }

  fs::path folder;
};

std::vector<std::string> said(const GlassFile& file) { return petzval::testing::said(file.warnings); }

const Glass& only(const GlassFile& file) {
  EXPECT_EQ(file.glasses.size(), 1u);
  return file.glasses.at(0);
}

void expect_index(const Glass& glass, const std::function<double(double)>& formula) {
  for (const double l : {0.45, 0.55, 0.65}) {
    EXPECT_NEAR(refractive_index(glass, l * 1000), formula(l), 1e-12) << glass.name << " at " << l;
  }
}

// n^2 or n by the published formula of each maker, with the numbers of the sample.
TEST_F(GlassFiles, EveryFormulaOfACatalogueGivesItsIndex) {
  const auto file = read(every_formula);
  ASSERT_EQ(file.glasses.size(), 15u);
  const auto glass = [&](std::size_t i) -> const Glass& { return file.glasses[i]; };
  const auto p = [](double l, double e) { return std::pow(l, e); };
  const auto pole = [](double l, double k, double c) { return k * l * l / (l * l - c); };
  expect_index(glass(0), [&](double l) {
    return std::sqrt(2.2716 - 0.0097 * p(l, 2) + 0.0111 * p(l, -2) + 4.6e-5 * p(l, -4) + 1.6e-5 * p(l, -6) -
                     8e-7 * p(l, -8));
  });
  expect_index(glass(1), [&](double l) {
    return std::sqrt(1 + pole(l, 1.03961212, 0.00600069867) + pole(l, 0.231792344, 0.0200179144) +
                     pole(l, 1.01046945, 103.560653));
  });
  expect_index(glass(2), [&](double l) {
    const double s = 1 / (l * l - 0.028);
    return 1.5 + 0.01 * s + 0.0004 * s * s - 0.002 * p(l, 2) + 0.0001 * p(l, 4) - 0.00001 * p(l, 6);
  });
  expect_index(glass(3), [&](double l) { return std::sqrt(1.25 + pole(l, 1, 0.01) + 0.006 / (l * l - 0.0081)); });
  expect_index(glass(4), [&](double l) { return std::sqrt(1.25 + pole(l, 1, 0.01) + pole(l, 0.006, 0.0081)); });
  expect_index(glass(5), [&](double l) { return 1.5 + 0.008 / l + 0.0004 / p(l, 3.5); });
  expect_index(glass(6), [&](double l) {
    return std::sqrt(1 + pole(l, 0.8559, 0.00345744) + pole(l, 0.8391, 0.019881) + pole(l, 0.0009, 0.038809) +
                     pole(l, 0.6845, 49.070025));
  });
  expect_index(glass(7), [&](double l) { return std::sqrt(2.7405 + 0.0184 / (l * l - 0.0179) - 0.0155 * l * l); });
  expect_index(glass(8), [&](double l) { return std::sqrt(1.3 + pole(l, 1.45, 0.0135) - 0.015 * l * l); });
  expect_index(glass(9),
               [&](double l) { return std::sqrt(3.1399 + pole(l, 1.3786, 0.02941) + pole(l, 3.861, 225.9009)); });
  expect_index(glass(10), [&](double l) {
    return std::sqrt(2.27 - 0.0097 * p(l, 2) + 0.011 * p(l, -2) + 5e-5 * p(l, -4) + 1e-5 * p(l, -6) - 5e-7 * p(l, -8) +
                     1e-8 * p(l, -10) + 2e-9 * p(l, -12));
  });
  expect_index(glass(11), [&](double l) {
    return std::sqrt(1 + pole(l, 0.4, 0.003) + pole(l, 0.5, 0.01) + pole(l, 0.2, 0.02) + pole(l, 0.1, 0.03) +
                     pole(l, 0.9, 95));
  });
  expect_index(glass(12), [&](double l) {
    return std::sqrt(2.27 - 0.0097 * p(l, 2) + 0.011 * p(l, -2) + 5e-5 * p(l, -4) + 1e-5 * p(l, -6) - 5e-7 * p(l, -8) -
                     0.0002 * p(l, 4) - 0.00003 * p(l, 6));
  });
  expect_index(glass(13), [&](double l) {
    return std::sqrt(2.27 - 0.0097 * p(l, 2) - 0.0002 * p(l, 4) + 0.011 * p(l, -2) + 5e-5 * p(l, -4) + 1e-5 * p(l, -6) -
                     5e-7 * p(l, -8) + 1e-8 * p(l, -10) + 2e-9 * p(l, -12));
  });
  const double s = 1 / (25 - 0.028);
  EXPECT_NEAR(refractive_index(glass(14), 5000),
              2.51253618 + 0.0686942636 * s + 0.0211563734 * s * s - 0.000155048679 * 25 - 4.35296121e-8 * 625 +
                  1.99858193e-10 * 15625,
              1e-12);
}

// n_d and V_d of calcite, beta barium borate and aluminium nitride come from public catalogues.
TEST_F(GlassFiles, CatalogueKeepsItsPrintedValues) {
  const auto file = read(every_formula);
  for (const Glass& glass : file.glasses) EXPECT_EQ(glass.catalogue, "made-up");
  EXPECT_EQ(file.glasses[1].name, "F2-SELLMEIER1");
  EXPECT_EQ(file.glasses[1].nd, 1.5168);
  EXPECT_EQ(file.glasses[1].vd, 64.1673);
  EXPECT_DOUBLE_EQ(file.glasses[1].shortest_nm, 300);
  EXPECT_DOUBLE_EQ(file.glasses[1].longest_nm, 2500);
  EXPECT_EQ(file.glasses[6].nd, 1.658643);
  EXPECT_EQ(file.glasses[7].nd, 1.670737);
  EXPECT_EQ(file.glasses[9].nd, 2.154291);
  expect_said(said(file), {{"7 ED", "thermal"},
                           {"9 TD", "thermal", "indices"},
                           {"10 MD", "mechanical"},
                           {"11 OD", "price"},
                           {"145 INFRARED", "n_d", 2.605447, 1000}});
}

std::string utf16(std::string_view latin, bool big, bool mark) {
  std::string bytes = !mark ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : latin) {
    if (big) bytes += '\0';
    bytes += c;
    if (!big) bytes += '\0';
  }
  return bytes;
}

TEST_F(GlassFiles, IndependentOfEncodingAndLineEnds) {
  std::string dos;
  for (const char c : every_formula) dos += c == '\n' ? "\r\n" : std::string(1, c);
  std::string latin = every_formula;
  latin.replace(latin.find("GC a"), 4, "GC \xE9");
  const std::vector<std::string> copies = {dos,
                                           latin,
                                           "\xEF\xBB\xBF" + every_formula,
                                           utf16(dos, false, true),
                                           utf16(every_formula, false, false),
                                           utf16(dos, true, true),
                                           utf16(every_formula, true, false)};
  const auto expected = read(every_formula);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    const auto file = read(copies[i]);
    ASSERT_EQ(file.glasses.size(), expected.glasses.size()) << i;
    for (std::size_t g = 0; g < file.glasses.size(); ++g) {
      EXPECT_EQ(file.glasses[g].name, expected.glasses[g].name) << i;
      EXPECT_EQ(file.glasses[g].coefficients, expected.glasses[g].coefficients) << i;
    }
    EXPECT_EQ(said(file), said(expected)) << i;
  }
}

const std::string crown =
    "NM K 2 0 1.5168 64.17 0 1\nCD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 "
    "103.560653\nLD 0.3 2.5\n";

TEST_F(GlassFiles, ContradictionsWithTheFormulaAreNamed) {
  std::string wrong = crown;
  wrong.replace(wrong.find("1.5168"), 6, "1.5178");
  expect_said(said(read(wrong)), {{"1 K", "formula", "n_d", 1.5168, 1.5178}});
  EXPECT_EQ(only(read(wrong)).nd, 1.5178);
  wrong = crown;
  wrong.replace(wrong.find("64.17"), 5, "61.00");
  expect_said(said(read(wrong)), {{"1 K", "formula", "V_d", 64.17, 61}});
  wrong.replace(wrong.find("61.00"), 5, "-    ");
  EXPECT_TRUE(said(read(wrong)).empty());
  EXPECT_NEAR(only(read(wrong)).vd, 64.167, 1e-3);
}

TEST_F(GlassFiles, EntriesWithoutAnIndexAreSkippedByName) {
  const auto others = [&](std::string_view text) { return said(read(crown + std::string(text))); };
  expect_said(others("NM Y 14 0 1.5 60 0 1\nCD 2\nLD 0.4 0.7\n"), {{"4 Y", "left out", "formula", 14, "known", 1, 13}});
  expect_said(others("NM Y 2.5 0 1.5 60 0 1\nCD 2\nLD 0.4 0.7\n"),
              {{"4 Y", "left out", "formula", 2.5, "known", 1, 13}});
  expect_said(others("NM Y 1 0 1.5 60\nNM Z 1 0 1.5 60\nCD 2.25\nLD 0.4 0.7\n"), {{"4 Y", "left out", "CD"}});
  expect_said(others("NM Y 1 0 1.5 60\nCD 2.25\nLD 0.7 0.4\n"), {{"4 Y", "left out", "range", 700, 400}});
  expect_said(others("NM Y 1 0 1.5 60\nCD 2.25\nLD 0 0\n"), {{"4 Y", "left out", "range", 0, 0}});
  expect_said(others("NM Y 1 0 1.5 60\nCD -2.25\nLD 0.4 0.7\n"), {{"4 Y", "left out", "formula", 587.5618}});
  expect_said(others("NM Y 4 0 1.9 60\nCD 0.25 1 0.1 0.006 0.09\nLD 0.4 0.7\n"),
              {{"4 Y", "left out", "formula", 4, "n_d"}});
  expect_said(others("NM Y 1 0 1.5 60\nCD 2.25\n"), {{"4 Y", "LD", "range", 400, 700}});
  expect_said(others("NM k 1 0 1.5 60\nCD 2.25\nLD 0.4 0.7\n"), {{"4 k", "given"}});
  expect_said(others("XX 1\nXX 2\n"), {{"4 XX", "unknown"}});
}

// Internal transmittances of N-BK7 at 10 and 25 mm. Source: Schott, data sheet N-BK7 517642.251, February 2014.
TEST_F(GlassFiles, InternalTransmittances_OfACatalogue_AreTheAbsorption) {
  const auto file = read(crown +
                         "IT 2.5 0.665 10\nIT 2.5 0.36 25\nIT 0.4 0.997 10\nIT 0.4 0.992 25\n"
                         "IT 0.31 0.574 10\nIT 0.31 0.25 25\n");
  EXPECT_TRUE(said(file).empty());
  const Glass& glass = only(file);
  ASSERT_EQ(glass.absorption.size(), 3u);
  const auto transmittance = [&](double nm, double mm) { return std::exp(-absorption(glass, nm).value() * mm); };
  EXPECT_NEAR(transmittance(310, 25), 0.25, 1e-15);
  EXPECT_NEAR(transmittance(310, 10), 0.574, 1e-3);
  EXPECT_NEAR(transmittance(400, 25), 0.992, 1e-15);
  EXPECT_NEAR(transmittance(400, 10), 0.997, 1e-3);
  EXPECT_NEAR(transmittance(2500, 25), 0.36, 1e-15);
  EXPECT_NEAR(transmittance(2500, 10), 0.665, 1e-3);
  EXPECT_NEAR(transmittance(400, 50), 0.992 * 0.992, 1e-15);
  const auto glasses = with_glasses(petzval::GlassCatalogue(), file.glasses);
  const auto lens = petzval::compile(
      {.name = "window",
       .surfaces = {{.radius = 0, .thickness = 25, .medium = {.glass = "K"}}, {.radius = 0, .thickness = 10}}},
      std::array{400.0, 550.0}, {.glasses = &glasses});
  EXPECT_NEAR(std::exp(-lens.absorption(1, 0) * 25), 0.992, 1e-15);
}

// A transmittance of 0.001 may be 0.0005 to 0.0015; that of 10 mm is better known.
TEST_F(GlassFiles, DarkTransmittances_AreReadFromTheThicknessWithTheSmallestError) {
  const auto at = [&](const std::string& lines) { return only(read(crown + lines)).absorption.at(0).per_mm; };
  EXPECT_DOUBLE_EQ(at("IT 0.4 0.001 25\nIT 0.4 0.063 10\n"), -std::log(0.063) / 10);
  EXPECT_DOUBLE_EQ(at("IT 0.4 0 25\nIT 0.4 0.001 10\n"), -std::log(0.001) / 10);
  EXPECT_DOUBLE_EQ(at("IT 0.4 0 25\nIT 0.4 0 10\n"), -std::log(0.0005) / 10);
  EXPECT_EQ(at("IT 0.4 1.0002 25\n"), 0);
  EXPECT_FALSE(std::signbit(at("IT 0.4 1 25\n")));
}

TEST_F(GlassFiles, InvalidTransmittances_AreLeftOutWithOneWarning) {
  for (const char* line : {"0.5 -0.1 10", "0.5 1.5 10", "0.5 0.9 0", "0.5 0.9 1e-308", "0.5 0.9 -10", "0 0.9 10",
                           "-0.5 0.9 10", "0.5 nan 10", "0.5 0.9", "0.5 0.9 inf", "0.5 0,9 10"}) {
    const std::string it = std::string("IT ") + line + '\n';
    const auto file = read(crown + it + it + "IT 0.4 0.9 10\n");
    EXPECT_EQ(only(file).absorption.size(), 1u) << line;
    expect_said(said(file), {{"4 K", "IT", line, "left out", 0, 1}});
  }
  expect_tokens(refusal("CC a\nIT 0.5 0.9 10\n"), {"line 2", "IT", "NM"});
}

TEST_F(GlassFiles, BrokenCatalogueIsRefusedWithItsLine) {
  expect_tokens(refusal("CC a\nNM\n"), {"line 2", "NM", 0});
  expect_tokens(refusal("NM K 2 0 1,5168 64.17\n"), {"line 1", "NM", "\"1,5168\""});
  expect_tokens(refusal("NM K 2 0 nan 64.17\n"), {"line 1", "NM", "\"nan\""});
  expect_tokens(refusal("NM K 2 0 1.5 64.17\nCD 1 1e400\n"), {"line 2", "CD", "\"1e400\""});
  expect_tokens(refusal("NM K 2 0 1.5 64.17\nLD 1\n"), {"line 2", "LD", 1});
  expect_tokens(refusal("CC a\nCD 1\n"), {"line 2", "CD"});
  expect_tokens(refusal("NM K 2 0 1.5 64.17\n\n"), {"line 2", "CD", "K"});
  expect_tokens(refusal("NM K 99 0 1.5 64.17\nCD 1\n"), {"glass", "line 1", "K", "formula", 99});
  expect_tokens(refusal("CC nothing but this\n"), {"glass"});
}

TEST_F(GlassFiles, OtherFilesAreRefused) {
  expect_error([&] { read("#include <vector>\n", "x.agf"); }, {folder / "x.agf"});
  expect_error([&] { read("", "x.agf"); }, {folder / "x.agf"});
  expect_tokens(refusal("PK\x03\x04..."), {"zip"});
  expect_error([&] { read_glasses(folder); }, {folder, "folder"});
  expect_error([&] { read_glasses(folder / "absent.agf"); }, {folder / "absent.agf"});
}

TEST_F(GlassFiles, TablesOfThisLibraryAreRead) {
  const std::string table = "catalogue,name,nd,vd,formula,wl_min_um,wl_max_um,coefficients,origin\n";
  const auto file = read(table + "mine,X1,1.5,60,cauchy,0.4,0.7,1.49 0.0034525 -2,me\n", "x.csv");
  EXPECT_EQ(only(file).catalogue, "mine");
  EXPECT_NEAR(refractive_index(only(file), 500), 1.49 + 0.0034525 * 4, 1e-15);
  expect_said(said(file), {{"2 X1", "formula", "V_d", 75.84, 60}});
  expect_tokens(refusal(table + "mine\n", "x.csv"), {"line 2"});
}

/// Pages of refractiveindex.info, in a build with yaml-cpp.
class GlassPages : public GlassFiles {
 protected:
  void SetUp() override {
    GlassFiles::SetUp();
    if (!PETZVAL_TEST_YAML) GTEST_SKIP() << "built without yaml-cpp";
  }
};

/// A page with one entry of DATA.
std::string page(const std::string& entry, const std::string& rest = "") {
  return "# a comment\nREFERENCES: \"a book: <a href=\\\"x\\\">y</a>\"\nCOMMENTS: |\n    many\n    words\nDATA:\n" +
         entry + rest;
}

std::string formula(int number, const std::string& coefficients) {
  return page("  - type: formula " + std::to_string(number) +
              "\n    wavelength_range: 0.4 0.7\n    coefficients: " + coefficients + "\n");
}

TEST_F(GlassFiles, PagesAreRefusedWithoutYaml) {
  if (PETZVAL_TEST_YAML) GTEST_SKIP() << "built with yaml-cpp";
  const std::string said = refusal(formula(2, "0 1 2"), "x.yml");
  EXPECT_NE(said.find("refractiveindex.info"), std::string::npos) << said;
  EXPECT_NE(said.find("PETZVAL_WITH_YAML"), std::string::npos) << said;
}

TEST_F(GlassPages, EveryFormulaOfAPageGivesItsIndex) {
  const auto glass = [&](int number, const std::string& c) { return only(read(formula(number, c), "A-B.yml")); };
  EXPECT_EQ(glass(1, "0.5 1 0.25").catalogue, "rii");
  EXPECT_EQ(glass(1, "0.5 1 0.25").name, "A-B");
  expect_index(glass(1, "0.5 1 0.25"), [](double l) { return std::sqrt(1.5 + l * l / (l * l - 0.0625)); });
  expect_index(glass(2, "0.5 1 0.0625"), [](double l) { return std::sqrt(1.5 + l * l / (l * l - 0.0625)); });
  expect_index(glass(3, "2.25 -0.01 2 0.02 -2"),
               [](double l) { return std::sqrt(2.25 - 0.01 * l * l + 0.02 / (l * l)); });
  expect_index(glass(4, "2.25 0.1 1 0.2 2 0.2 0 0.3 2 -0.05 2 0.01 3"), [](double l) {
    return std::sqrt(2.25 + 0.1 * l / (l * l - 0.04) + 0.2 / (l * l - 0.09) - 0.05 * l * l + 0.01 * l * l * l);
  });
  expect_index(glass(4, "2.25 0.1 1 0.2 2"), [](double l) { return std::sqrt(2.25 + 0.1 * l / (l * l - 0.04)); });
  expect_index(glass(5, "1.5 0.01 -2"), [](double l) { return 1.5 + 0.01 / (l * l); });
  expect_index(glass(7, "1.5 0.01 0.001 0.02 0.03"), [](double l) {
    const double s = 1 / (l * l - 0.028);
    return 1.5 + 0.01 * s + 0.001 * s * s + 0.02 * l * l + 0.03 * l * l * l * l;
  });
}

TEST_F(GlassPages, PageKeepsItsPrintedValues) {
  const std::string cauchy = "  - type: formula 5\n    wavelength_range: 0.4 0.7\n    coefficients: 1.5 0.004 -2\n";
  for (const char* section : {"PROPERTIES", "SPECS"}) {
    const auto file = read(page(cauchy, std::string(section) + ":\n    nd: 1.5116\n    Vd: 68\n"), "x.yml");
    EXPECT_EQ(only(file).nd, 1.5116);
    EXPECT_EQ(only(file).vd, 68);
    expect_said(said(file), {{"7 x", "formula", "V_d", 66.97, 68}});
  }
  const auto file = read(page(cauchy + "  - type: tabulated k\n    data: |\n        0.4 1e-6\n        0.7 1e-6\n",
                              "CONDITIONS:\n  n_is_absolute: true\n"),
                         "x.yml");
  expect_said(said(file), {{"15 n_is_absolute", "index"}, {"7 x", "n_d", 1.511587, 587.5618}});
}

TEST_F(GlassPages, FirstOfTwoEntriesIsUsed) {
  const std::string entry = "  - type: formula 5\n    wavelength_range: 0.4 0.7\n    coefficients: 1.5 0.004 -2\n";
  expect_tokens(said(read(page(entry + entry), "x.yml")).at(0), {10, "formula", 5, "left out", "indices"});
}

std::string table(const std::string& type, const std::string& rows) {
  return page("  - type: tabulated " + type + "\n    data: |\n" + rows);
}

TEST_F(GlassPages, TablesOfAPageAreInterpolated) {
  const auto file =
      read(table("n", "        0.7 1.5\n        0.4 1.53\n        0.5 1.515\n        0.5 1.515\n"), "x.yml");
  const Glass& glass = only(file);
  EXPECT_DOUBLE_EQ(glass.shortest_nm, 400);
  EXPECT_DOUBLE_EQ(glass.longest_nm, 700);
  EXPECT_DOUBLE_EQ(refractive_index(glass, 500), 1.515);
  EXPECT_DOUBLE_EQ(refractive_index(glass, 700), 1.5);
  expect_tokens(said(file).at(0), {"7 data", 1, "rows"});
}

TEST_F(GlassPages, TransparentRangeOfATableWithAbsorptionIsUsed) {
  const auto file = read(table("nk",
                               "        0.2 1.9 1.5\n        0.3 1.6 0.02\n        0.4 1.53 0.001\n"
                               "        0.5 1.52 1e-5\n        0.7 1.51 0\n        3 1.4 0.3\n        4 1.4 0\n"),
                         "x.yml");
  EXPECT_DOUBLE_EQ(only(file).shortest_nm, 400);
  EXPECT_DOUBLE_EQ(only(file).longest_nm, 700);
  expect_tokens(said(file).at(0), {7, "tabulated", "absorbs", 400, 700, "left"});
  expect_tokens(refusal(table("nk", "        0.4 0.2 3\n        0.5 0.2 3\n        0.7 0.1 4\n"), "silver.yml"),
                {"line 7", "table", 0, "k", 0.01});
}

// k of N-BK7, computed from 0.25 and 0.36 at 25 mm. Source: refractiveindex.info, SCHOTT-optical N-BK7, CC0 1.0.
TEST_F(GlassPages, TablesOfK_AreTheAbsorption) {
  const std::string k = "        0.310 1.3679E-06\n        2.500 8.1300E-06\n";
  const std::string sellmeier = "  - type: formula 2\n    wavelength_range: 0.3 2.5\n    coefficients: 0 1.27 0.01\n";
  const auto file = read(page(sellmeier + "  - type: tabulated k\n    data: |\n" + k), "x.yml");
  ASSERT_EQ(only(file).absorption.size(), 2u);
  EXPECT_NEAR(std::exp(-absorption(only(file), 310).value() * 25), 0.25, 1e-4);
  EXPECT_NEAR(std::exp(-absorption(only(file), 2500).value() * 25), 0.36, 1e-4);
  const auto nk =
      read(table("nk", "        0.310 1.55 1.3679E-06\n        2.500 1.48 8.1300E-06\n        3 1.4 0.02\n"), "x.yml");
  EXPECT_EQ(absorption(only(nk), 310), absorption(only(file), 310));
  EXPECT_EQ(absorption(only(nk), 2500), absorption(only(file), 2500));
  EXPECT_GT(absorption(only(nk), 3000), 50);
}

TEST_F(GlassPages, InvalidOrRepeatedTablesOfK_AreLeftOut) {
  const std::string cauchy = "  - type: formula 5\n    wavelength_range: 0.4 0.7\n    coefficients: 1.5 0.004 -2\n";
  const auto k = [](const std::string& rows) { return "  - type: tabulated k\n    data: |\n" + rows; };
  const auto negative =
      read(page(cauchy + k("        0.4 -1e-6\n        0.7 1e-6\n"), "SPECS:\n    nd: 1.511587\n"), "x.yml");
  EXPECT_EQ(only(negative).absorption.size(), 1u);
  expect_said(said(negative), {{"7 data", 1, "rows", "k", 0, "left out"}});
  const auto two =
      read(page(cauchy + k("        0.4 1e-6\n") + k("        0.4 2e-6\n"), "SPECS:\n    nd: 1.511587\n"), "x.yml");
  EXPECT_NEAR(absorption(only(two), 400).value(), 0.0314159, 1e-7);
  expect_said(said(two), {{"13 tabulated k", "left out", "earlier", "k"}});
  expect_tokens(refusal(page(cauchy + k("        0.4 1e-6 1\n")), "x.yml"), {"line 12", "row", 3, 2});
}

TEST_F(GlassPages, BrokenPageIsRefusedWithItsLine) {
  expect_tokens(refusal(formula(6, "0 1 2"), "x.yml"), {"line 7", "type", "\"formula 6\""});
  expect_tokens(refusal(formula(2, "0 1"), "x.yml"), {"line 9", "2 coefficients"});
  expect_tokens(refusal(formula(2, ""), "x.yml"), {"line 7", "formula", 2});
  expect_tokens(refusal(formula(2, "0 nan 1"), "x.yml"), {"line 9", "coefficient", "\"nan\""});
  expect_tokens(refusal(formula(2, "0 1e400 1"), "x.yml"), {"line 9", "coefficient", "\"1e400\""});
  expect_tokens(refusal(page("  - type: formula 2\n    coefficients: 0\n"), "x.yml"), {"line 7", "range", 0});
  expect_tokens(refusal(table("n", "        0.4 1.5\n        0.5 1,5\n"), "x.yml"), {"line 10", "data", "\"1,5\""});
  expect_tokens(refusal(table("n", "        0.4 1.5\n        0.5\n"), "x.yml"), {"line 10", "row", 1});
  expect_tokens(refusal(page("  - type: tabulated k\n    data: |\n        0.4 1\n"), "x.yml"), {"line 1", "DATA"});
  expect_tokens(refusal("DATA:\n  - type: [formula 2\n", "x.yml"), {"line 3", "YAML", "end"});
  expect_tokens(refusal("DATA: 5\n", "x.yml"), {"line 1", "DATA"});
}

TEST_F(GlassPages, AliasesAndDeepOrLongPagesAreRefused) {
  expect_tokens(refusal("a: &a [x, x]\nb: &b [*a, *a]\nDATA: [*b]\n", "x.yml"), {"line 2", "alias"});
  for (const char* opening : {"[", "{a: ", "- ", "? "}) {
    std::string deep = "DATA:\n  ";
    for (int i = 0; i < 100; ++i) deep += opening;
    expect_tokens(refusal(deep, "x.yml"), {"line"});
  }
  expect_tokens(refusal("DATA:\n" + std::string(65'537, '['), "x.yml"), {"line 2", "line", 65537});
  expect_tokens(refusal("DATA:\n" + std::string(8 << 20, '\n'), "x.yml"), {"line 1", "page", 8388614});
  expect_tokens(refusal("---\nDATA:\n---\n", "x.yml"), {"line 3", "second"});
}

// Reading throws Error or gives glasses.
TEST_F(GlassFiles, TruncatedFilesAreReadOrRefused) {
  const std::string nk = table("nk", "        0.4 1.53 0.001\n        0.5 1.52 1e-5\n        0.7 1.51 0\n");
  int refused = 0, taken = 0;
  for (const std::string& whole : {every_formula.substr(0, 1500), utf16(every_formula.substr(0, 400), false, true), nk,
                                   formula(4, "2.25 0.1 1 0.2 2 0.2 0 0.3 2")}) {
    const fs::path cut = written("cut", whole);
    for (std::size_t length = whole.size(); length-- > 0;) {
      fs::resize_file(cut, length);
      try {
        const auto file = read_glasses(cut);
        EXPECT_FALSE(file.glasses.empty());
        ++taken;
      } catch (const petzval::Error& error) {
        EXPECT_TRUE(std::string_view(error.what()).starts_with(cut.string())) << error.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_GT(taken, 500);
}

TEST_F(GlassFiles, AMillionLinesAreReadOrRefused) {
  std::string lines = crown;
  for (int i = 0; i < 1'000'000; ++i) lines += "IT 0.5 1 10\n";
  EXPECT_EQ(read(lines).glasses.size(), 1u);
  lines = "CC\n";
  for (int i = 0; i < 1'000'000; ++i) lines += "X" + std::to_string(i) + "\n";
  expect_tokens(refusal(lines), {"glass"});
  std::string many;
  for (int i = 0; i < 100'001; ++i) many += "NM G" + std::to_string(i) + " 1 0 1.5 0\nCD 2.25\nLD .4 .7\n";
  expect_tokens(refusal(many), {"line 300001", "glass"});
  expect_tokens(refusal("NM K 2 0 1.5 " + std::string(1'000'000, '9') + "x\n"), {"line 1", "NM"});
}

TEST_F(GlassFiles, WarningsEndAfterAThousand) {
  std::string many = crown;
  for (int i = 0; i < 2000; ++i) many += "NM G 1 0 1.4 0\nCD 2.25\nLD .4 .7\n";
  const auto file = read(many);
  EXPECT_EQ(file.glasses.size(), 2001u);
  ASSERT_EQ(file.warnings.size(), 1001u);
  expect_tokens(file.warnings.back().message, {2999});
}

// The samples next to the repository, if installed.
TEST(PublicGlassFiles, AreReadWithTheirPrintedIndices) {
  const fs::path formats = PETZVAL_TEST_FORMATS;
  if (!fs::exists(formats)) GTEST_SKIP() << formats << " is missing";
  std::size_t count = 0;
  for (const char* folder : {"agf", "rii"}) {
    if (!PETZVAL_TEST_YAML && std::string_view(folder) == "rii") continue;
    for (const auto& entry : fs::directory_iterator(formats / folder)) {
      const auto file = read_glasses(entry.path());
      for (const Glass& glass : file.glasses) {
        EXPECT_NEAR(refractive_index(glass, petzval::d_line_nm), glass.nd, 1e-5) << glass.name;
        ++count;
      }
    }
  }
  EXPECT_GE(count, PETZVAL_TEST_YAML ? 14u : 11u);
}

}  // namespace glass_files_test
