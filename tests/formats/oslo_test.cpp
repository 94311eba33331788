// SPDX-License-Identifier: Apache-2.0
// Lens files of OSLO.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "said.hpp"

namespace oslo_test {

using petzval::AsphereTerm;
using petzval::parse_lens;
using petzval::Prescription;
using petzval::testing::expect_error;
using petzval::testing::expect_said;
using petzval::testing::expect_tokens;
using petzval::testing::message;
using petzval::testing::read_sample;
using petzval::testing::said;
using petzval::testing::with;
using Said = std::vector<std::string>;

void expect_terms(const std::vector<AsphereTerm>& found, const std::vector<AsphereTerm>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].order, wanted[i].order);
    EXPECT_NEAR(found[i].coefficient, wanted[i].coefficient, 1e-12 * std::abs(wanted[i].coefficient));
  }
}

TEST(Oslo, EveryKnownCommandIsReadOrReported) {
  const auto lens = read_sample("oslo_words.len");
  EXPECT_EQ(lens.imported->format, "oslo");
  EXPECT_EQ(lens.name, "words of a lens");
  EXPECT_EQ(lens.imported->notes, (Said{"none", "a note; with // signs"}));
  ASSERT_EQ(lens.surfaces.size(), 8u);
  const auto& s = lens.surfaces;
  // A unit of 10 mm: radii, thicknesses and apertures times 10, coefficients of r^n times 10^(1 - n).
  EXPECT_DOUBLE_EQ(s[0].radius, 50);
  EXPECT_DOUBLE_EQ(s[0].thickness, 4);
  EXPECT_DOUBLE_EQ(*s[0].semi_diameter, 14);
  EXPECT_EQ(s[0].conic, -0.5);
  EXPECT_EQ(s[0].medium.glass, "BK7");
  expect_terms(s[0].aspheric, {{4, 1e-6}, {6, -2e-9}, {8, 3e-12}, {10, 4e-15}});
  EXPECT_DOUBLE_EQ(s[1].radius, -40);
  EXPECT_NEAR(s[1].medium.nd.value(), 1.62, 1e-12);
  EXPECT_NEAR(*s[1].medium.vd, (1.62 - 1) / (1.6321 - 1.6149), 2e-3);
  EXPECT_EQ(s[2].radius, 0);
  EXPECT_TRUE(s[3].stop);
  EXPECT_NEAR(*s[3].semi_diameter, 11.4347, 1e-3);  // from EBR: its AP is not checked
  EXPECT_DOUBLE_EQ(s[4].radius, 10 / (0.25 + 0.01));
  EXPECT_EQ(s[4].medium.catalogue, "hoya");
  EXPECT_EQ(s[4].medium.glass, "LAF2");
  expect_terms(s[4].aspheric, {{2, 1e-3}, {6, 2e-10}});
  EXPECT_DOUBLE_EQ(s[5].radius, 50);  // PK CV 1, with conic and terms
  EXPECT_EQ(s[5].conic, -0.5);
  expect_terms(s[5].aspheric, s[0].aspheric);
  EXPECT_DOUBLE_EQ(s[5].thickness, 3);
  EXPECT_DOUBLE_EQ(*s[5].semi_diameter, 12);
  EXPECT_TRUE(s[6].mirror);
  EXPECT_EQ(s[6].medium.nd, 1.5);
  EXPECT_DOUBLE_EQ(s[6].thickness, -20);
  EXPECT_EQ(lens.image_diagonal_mm, 16);
  EXPECT_EQ(lens.half_field_deg, 15);
  EXPECT_EQ(lens.design.aperture->value, 24);
  ASSERT_EQ(lens.design.wavelengths.size(), 3u);
  EXPECT_DOUBLE_EQ(lens.design.wavelengths[1].nm, 486.13);
  EXPECT_EQ(lens.design.wavelengths[1].weight, 0.5);
  expect_said(said(lens), {{"5 UNI", "unit", 10},
                           {"37 APN", "apertures"},
                           {"38 AX1", "apertures"},
                           {"61 PUC", "solve", "value"},
                           {"62 XYZ", "unknown"},
                           {"75 CFG", "configurations"},
                           {"23 GLA", "indices", "n_d", 1.62, "V_d", 36.047},
                           {"65 TH", "image", -0.1},
                           {"65 RD", "image"}});
}

TEST(Oslo, AxialRaySolveGivesTheFocus) {
  const auto lens = read_sample("oslo_words.len");
  const auto first = first_order(
      compile(lens, std::array{lens.design.wavelengths[0].nm}, {.missing_glass = petzval::MissingGlass::abbe}));
  EXPECT_NEAR(lens.surfaces.back().thickness, first.back_focal_distance - 0.1, 1e-9);
}

const std::string plain =
    "LEN NEW \"plain\" 50 3\nEBR 5\nANG 10\nUNI 1.0\nAIR\nTH 1e20\nNXT\nGLA 1.5\nRD 25\nTH 0\nAP 8\nAST\nNXT\nAIR\nRD "
    "0\n"
    "TH 50\nAP 8\nNXT\nAIR\nEND 3\n";

TEST(Oslo, PlainLensIsReadWithoutWarnings) {
  const auto lens = parse_lens(plain, "x.len");
  EXPECT_TRUE(said(lens).empty());
  EXPECT_EQ(lens.focal_length_mm, 50);
  EXPECT_NEAR(first_order(compile(lens)).effective_focal_length, 50, 1e-12);
  ASSERT_EQ(lens.surfaces.size(), 2u);
  EXPECT_NEAR(*lens.surfaces[0].semi_diameter, 5, 0.01);
}

// The same lens with semicolons, in lower case, and with blank lines instead of NXT.
TEST(Oslo, IndependentOfLayout) {
  auto expected = parse_lens(plain, "x.len");
  std::string blank = plain, semicolons, low;
  for (std::size_t at = 0; (at = blank.find("NXT\n")) != std::string::npos;) blank.replace(at, 4, "\n");
  for (const char c : with(plain, "LEN NEW \"plain\" 50 3\n", "")) semicolons += c == '\n' ? ';' : c;
  semicolons = "// a comment; END\nLEN NEW \"plain\" 50 3\n" + semicolons + " // END";
  for (const char c : plain) low += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const std::string& text : {blank, blank + "\n\n", semicolons, low}) {
    const auto lens = parse_lens(text, "x.len");
    EXPECT_EQ(lens, expected) << text;
  }
}

TEST(Oslo, FiniteObjectHasAnAngleForItsBeam) {
  const auto lens = parse_lens(with(with(plain, "TH 1e20", "TH 100"), "ANG 10", "OBH 4"), "x.len");
  EXPECT_EQ(lens.design.object_distance_mm, 100);
  EXPECT_EQ(lens.design.aperture->setting, petzval::ApertureSetting::object_na);
  EXPECT_NEAR(lens.design.aperture->value, 5 / std::hypot(5.0, 100.0), 1e-12);
  EXPECT_EQ(lens.design.field_kind, petzval::FieldKind::object_height);
  EXPECT_NEAR(*lens.surfaces[0].semi_diameter, 5, 1e-9);
}

TEST(Oslo, ApertureAndFieldHaveOtherForms) {
  using petzval::ApertureSetting;
  const auto setting = [](std::string_view command) {
    const auto aperture = parse_lens(with(plain, "EBR 5", command), "x.len").design.aperture.value();
    return std::pair(aperture.setting, aperture.value);
  };
  EXPECT_EQ(setting("FNO 4"), std::pair(ApertureSetting::f_number, 4.0));
  EXPECT_EQ(setting("NAP 0.1"), std::pair(ApertureSetting::image_na, 0.1));
  EXPECT_EQ(setting("NAO 0.1"), std::pair(ApertureSetting::object_na, 0.1));
  const auto lens = parse_lens(with(plain, "ANG 10", "GIH 7"), "x.len");
  EXPECT_EQ(lens.image_diagonal_mm, 14);
}

TEST(Oslo, IndicesMayHaveOtherWavelengths) {
  // n = 1.5 + 0.004 / l^2 at three other wavelengths.
  const auto n = [](double um) { return 1.5 + 0.004 / (um * um); };
  const std::string glass = "WV 0.55 0.45 0.65\nGLA " + std::to_string(n(0.55)) + " " + std::to_string(n(0.45)) + " " +
                            std::to_string(n(0.65));
  const auto lens = parse_lens(with(plain, "GLA 1.5", glass), "x.len");
  EXPECT_NEAR(lens.surfaces[0].medium.nd.value(), n(0.5875618), 1e-6);
  EXPECT_NEAR(*lens.surfaces[0].medium.vd, (n(0.5875618) - 1) / (n(0.4861327) - n(0.6562725)), 2e-2);
}

TEST(Oslo, ThicknessThatContradictsItsSolveIsReported) {
  expect_said(said(parse_lens(with(plain, "TH 50", "TH 50\nPY 0"), "x.len")), {});
  expect_said(said(parse_lens(with(plain, "TH 50", "TH 49\nPY 0"), "x.len")), {{"13 PY", "file", 49, 50}});
  // Half the beam height halves the distance.
  const auto lens = parse_lens(with(plain, "TH 50", "PY 2.5"), "x.len");
  EXPECT_NEAR(lens.surfaces[1].thickness, 25, 1e-12);
  expect_tokens(said(parse_lens(with(with(plain, "TH 50", "TH 1\nPY 2"), "EBR 5", "FNO 5"), "x.len")).at(0),
                {"13 PY", "EBR", "thickness"});
}

TEST(Oslo, WrongFocalLengthIsReported) {
  expect_said(said(parse_lens(with(plain, "\" 50", "\" 100"), "x.len")), {});  // default of OSLO for new lenses
  expect_said(said(parse_lens(with(plain, "\" 50", "\" 60"), "x.len")), {{"1 LEN", 60, "focal", 50}});
}

TEST(Oslo, UnsupportedCommandsAreRefusedWithTheirLine) {
  const auto refusal = [](std::string_view old, std::string_view text) {
    return message([&] { parse_lens(with(plain, old, text), "x.len"); });
  };
  expect_tokens(refusal("RD 25", "RD 2,5"), {"x.len", "line 9", "RD", "\"2,5\""});
  expect_tokens(refusal("RD 25", "RD nan"), {"x.len", "line 9", "RD", "\"nan\""});
  expect_tokens(refusal("RD 25", "RD 1e400"), {"x.len", "line 9", "RD", "\"1e400\""});
  expect_tokens(refusal("RD 25", "RD"), {"x.len", "line 9", "RD"});
  expect_tokens(refusal("RD 25", "TLA 5"), {"x.len", "line 9", "TLA", 5});
  expect_tokens(refusal("RD 25", "PFL 5"), {"x.len", "line 9", "PFL"});
  expect_tokens(refusal("RD 25", "GSP 5"), {"x.len", "line 9", "GSP"});
  expect_tokens(refusal("RD 25", "LMO NSS"), {"x.len", "line 9", "LMO"});
  expect_tokens(refusal("RD 25", "ASP ZER"), {"x.len", "line 9", "ASP", "\"zer\""});
  expect_tokens(refusal("RD 25", "ASP ARA\nAS1 1"), {"x.len", "line 10", "AS1", 1});
  expect_tokens(refusal("RD 25", "AS1 1"), {"x.len", "line 9", "AS1"});
  expect_tokens(refusal("RD 25", "PK CV 1"), {"x.len", "line 9", "PK", 1});
  expect_tokens(refusal("AP 8", "AP -8"), {"x.len", "line 11", "AP", -8});
  expect_tokens(refusal("UNI 1.0", "UNI 0"), {"x.len", "line 4", "UNI", 0});
  expect_tokens(refusal("TH 50", "TH 1e20"), {"x.len", "line 13", "TH", "1e+20"});
  expect_tokens(refusal("GLA 1.5", "GLA MOD X"), {"x.len", "line 8", "GLA"});
  expect_error([] { parse_lens("LEN NEW \"x\" 1 1\nTH 5\nNXT\n", "x.len"); }, {"x.len", "line 1", "LEN", 2});
  expect_said(said(parse_lens(with(plain, "RD 25", "RD 25\nPK XX 0"), "x.len")), {{"10 PK", "unknown"}});
}

TEST(Oslo, UnsolvedSolvesAndLongListsAreReported) {
  expect_tokens(said(parse_lens(with(with(plain, "RD 25", "RD 0"), "TH 50", "TH 50\nPY 0"), "x.len")).at(0),
                {"13 PY", "thickness", "file"});
  expect_error([] { parse_lens(with(plain, "EBR 5", "EBR 5\nWV101 0.5"), "x.len"); }, {"x.len", "line 3", "WV101"});
  std::string many = plain;
  for (int i = 0; i < 10'001; ++i) many.insert(many.find("RD 25"), "TH 1\nNXT\n");
  expect_error([&] { parse_lens(many, "x.len"); }, {"x.len", 10000, "surfaces"});
}

TEST(PublicOsloFiles, CookeTripletHasItsFocalLength) {
  const std::filesystem::path file = std::filesystem::path(PETZVAL_TEST_FORMATS) / "oslo" / "cooke_triplet.len";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
  const auto lens = petzval::read_lens(file);
  EXPECT_TRUE(said(lens).empty());
  EXPECT_NEAR(first_order(compile(lens)).effective_focal_length, 50.0213, 1e-3);
}

}  // namespace oslo_test
