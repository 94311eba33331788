// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "../expect_error.hpp"
#include "lens_text.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace codev_test {

using petzval::Prescription;
using petzval::testing::expect_tokens;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

const std::string singlet = R"(RDM;LEN  "VERSION: 10.7"
TITLE 'A singlet; of glass'   ! a comment
EPD 10
DIM M
WL 656.3 587.6 486.1
REF 2
WTW 1 2 1
XAN 0 0
YAN 0 5
VUY 0 0.2
VLY 0 0.4
SO 0 1e13
S 0 2
  STO
S 50 4 1.5:60
  CIR 8; SLB 'front'
S -50 &
  48
SI 0 0.5
GO
)";

std::string with_line(const std::string& line) { return with(singlet, "  CIR 8;", "  " + line + "\n  CIR 8;"); }

TEST(Codev, HasTheValuesOfTheFile) {
  const Prescription p = read(singlet);
  EXPECT_EQ(p.imported->format, "codev");
  EXPECT_EQ(p.imported->title, "A singlet; of glass");
  EXPECT_TRUE(p.imported->warnings.empty()) << p.imported->warnings[0].message;
  ASSERT_EQ(p.surfaces.size(), 3u);
  EXPECT_TRUE(p.surfaces[0].stop);
  EXPECT_NEAR(*p.surfaces[0].semi_diameter, 5, 1e-12);
  EXPECT_EQ(p.surfaces[1].radius, 50);
  EXPECT_EQ(p.surfaces[1].medium, (petzval::Medium{.nd = 1.5, .vd = 60}));
  EXPECT_EQ(p.surfaces[1].semi_diameter, 8);
  EXPECT_EQ(p.surfaces[1].comment, "front");
  EXPECT_EQ(p.surfaces[2].thickness, 48.5);  // with the defocus of SI
  ASSERT_EQ(p.design.wavelengths.size(), 3u);
  EXPECT_EQ(p.design.wavelengths[1], (petzval::DesignWavelength{587.6, 2}));
  EXPECT_EQ(p.design.primary_wavelength, 1u);
  EXPECT_EQ(p.design.fields[1].y, 5);
  EXPECT_NEAR(p.design.fields[1].compress_y, 0.3, 1e-15);
  EXPECT_NEAR(p.design.fields[1].decentre_y, 0.1, 1e-15);
}

TEST(Codev, CurvaturesAndUnitsAreLengthsAndTheirInverses) {
  std::string curved = with(with(with(singlet, "RDM;", "RDM N;"), "S 50 4", "S 0.02 4"), "S -50 &", "S -0.02 &");
  EXPECT_EQ(read(curved).surfaces, read(singlet).surfaces);
  const Prescription inches = read(with(singlet, "DIM M", "DIM I"));
  EXPECT_EQ(inches.imported->units, "in");
  EXPECT_NEAR(inches.surfaces[1].radius, 1270, 1e-9);
  EXPECT_NEAR(inches.surfaces[2].thickness, 48.5 * 25.4, 1e-9);
  EXPECT_NEAR(*inches.surfaces[0].semi_diameter, 127, 1e-9);
  EXPECT_NEAR(*inches.surfaces[1].semi_diameter, 8 * 25.4, 1e-9);
  EXPECT_EQ(read(with(singlet, "DIM M", "DIM C")).surfaces[1].radius, 500);
  EXPECT_NE(refusal(with(singlet, "DIM M", "DIM F")), "no error");
  // Without RDM, a number that is too large for a curvature is a radius.
  EXPECT_EQ(read(with(singlet, "RDM;", "")).surfaces[1].radius, 50);
  EXPECT_NE(warning(with(singlet, "RDM;", ""), "RDM"), "no warning");
  curved = with(curved, "RDM N;", "");
  EXPECT_EQ(read(curved).surfaces[1].radius, 50);
  EXPECT_NE(warning(with(singlet, "DIM M\n", ""), "DIM"), "no warning");
  EXPECT_EQ(read(with(singlet, "S 50 4", "S 0.5D+02 4")).surfaces[1].radius, 50);
}

TEST(Codev, ShapesAreConicsAndEvenTerms) {
  const petzval::SurfaceRow row = read(with_line("ASP; K -0.5; A 1e-5; B 2e-8; J 1e-30")).surfaces[1];
  EXPECT_EQ(row.conic, -0.5);
  EXPECT_EQ(row.aspheric, (std::vector<petzval::AsphereTerm>{{4, 1e-5}, {6, 2e-8}, {20, 1e-30}}));
  EXPECT_EQ(read(with_line("CON; K -1")).surfaces[1].conic, -1);
  EXPECT_EQ(read(with_line("CYL; RDX 0")).surfaces[1].curved_in, petzval::Section::y);
  for (const char* word : {"SPS XYP", "DIF GRT", "XDE 1", "ADE 5", "BEN", "UDS"}) {
    expect_tokens(refusal(with_line(word)), {"x", "line 16"});
  }
  EXPECT_EQ(refusal(with_line("XDE 0; YDE 0; ADE 0")), "no error");
}

TEST(Codev, AperturesAreRims) {
  EXPECT_EQ(read(with_line("CIR EDG 9")).surfaces[1].semi_diameter, 8);
  EXPECT_EQ(read(with(singlet, "CIR 8;", "CIR EDG 9;")).surfaces[1].semi_diameter, 9);
  EXPECT_EQ(read(with(singlet, "CIR 8;", "CIR '' 9;")).surfaces[1].semi_diameter, 9);
  EXPECT_EQ(read(with_line("CIR HOL 2")).surfaces[1].obscuration_semi_diameter, 2);
  EXPECT_EQ(read(with_line("CIR OBS L'A' 3")).surfaces[1].obscuration_semi_diameter, 3);
  EXPECT_NE(warning(with_line("REX 5"), "REX"), "no warning");
}

TEST(Codev, ApertureSettingsSizeTheStop) {
  const double focal = petzval::first_order(compile(read(singlet))).effective_focal_length;
  // The f-number at the primary wavelength of the design.
  const auto f_number = [](const Prescription& p) {
    return petzval::real_f_number(compile(p, std::array{p.design.wavelengths.at(p.design.primary_wavelength).nm},
                                          {.missing_glass = petzval::MissingGlass::abbe}));
  };
  EXPECT_NEAR(f_number(read(with(singlet, "EPD 10", "FNO 6"))), 6, 1e-6);
  EXPECT_NEAR(petzval::real_f_number(compile(read(singlet))), focal / 10, 1e-6);
  // A circular aperture of the stop clips the declared beam and never widens the beam.
  const auto with_rim = [](const std::string& rim) {
    return *read(with(singlet, "STO", "STO; CIR " + rim)).surfaces[0].semi_diameter;
  };
  // Each zoom position has its own beam.
  const Prescription zoom = read(with(singlet, "GO\n", "ZOO 3\nZOO EPD 10 8 4\nGO\n"));
  ASSERT_EQ(zoom.configurations.size(), 3u);
  const double sizes[] = {5, 4, 2};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(*configured(zoom, i).surfaces[0].semi_diameter, sizes[i], 1e-9) << i;
  EXPECT_NEAR(with_rim("7"), 5, 1e-9);
  EXPECT_EQ(with_rim("3"), 3);
  const Prescription na = read(with(singlet, "EPD 10", "NA 0.05"));
  EXPECT_NEAR(petzval::paraxial_f_number(compile(na)), 1 / (2 * std::tan(std::asin(0.05))), 0.05);
  EXPECT_EQ(read(with(singlet, "EPD 10", "NAO 0.05")).design.aperture->setting, petzval::ApertureSetting::object_na);
}

TEST(Codev, GlassesAreNamesCodesOrPrivate) {
  const auto medium = [](const std::string& glass) { return read(with(singlet, "1.5:60", glass)).surfaces[1].medium; };
  EXPECT_EQ(medium("NBK7_SCHOTT").glass, "N-BK7");
  EXPECT_EQ(medium("nbk7_schott").catalogue, "schott");
  EXPECT_NEAR(medium("N-BK7_SCHOTT").nd.value(), 1.5168, 1e-7);  // by the formula
  EXPECT_NEAR(medium("517.642").nd.value(), 1.517, 1e-12);
  EXPECT_NEAR(*medium("517.642").vd, 64.2, 1e-12);
  EXPECT_NEAR(medium("620410.603236").nd.value(), 1.62041, 1e-12);
  EXPECT_NEAR(*medium("620410.603236").vd, 60.3236, 1e-12);
  EXPECT_NEAR(medium("500.700").nd.value(), 1.5, 1e-12);
  expect_tokens(refusal(with(singlet, "1.5:60", "XYZ_SCHOTT")), {"--glasses FILE"});
  const std::string own = "PRV\nPWL 656.2725 587.5618 486.1327\n'MYGLASS' 1.59 1.6 1.62\nEND\n";
  const petzval::Medium mine = read(with(with(singlet, "SO 0", own + "SO 0"), "1.5:60", "MYGLASS")).surfaces[1].medium;
  EXPECT_EQ(mine.nd, 1.6);
  EXPECT_NEAR(*mine.vd, 0.6 / 0.03, 1e-9);
  const Prescription mirror = read(with(with(singlet, "S 50 4 1.5:60", "S -50 -4 REFL"), "S -50 &", "S 60 -40"));
  EXPECT_TRUE(mirror.surfaces[1].mirror);
}

TEST(Codev, PickupsSolvesAndLaterWordsAreApplied) {
  const Prescription p =
      read(with(singlet, "GO", "THI S2 5\nRDY S2 60\nGLA S2 NSK16_SCHOTT\nPIK RDY S3 Z1 RDY S2 Z1 -1\nGO"));
  EXPECT_EQ(p.surfaces[1].thickness, 5);
  EXPECT_EQ(p.surfaces[1].radius, 60);
  EXPECT_EQ(p.surfaces[1].medium.glass, "N-SK16");
  EXPECT_EQ(p.surfaces[2].radius, -60);
  EXPECT_NE(warning(p, "PIK"), "no warning");
  const Prescription image = read(with(with(singlet, "  48\n", "  49.324\n"), "SI 0 0.5", "PIM\nSI 0 0"));
  EXPECT_NEAR(image.surfaces[2].thickness, 49.324, 1e-12);  // the file's value, because it is near the focus
  const double focus = petzval::first_order(compile(read(singlet))).back_focal_distance;
  const Prescription far = read(with(with(singlet, "  48\n", "  10\n"), "SI 0 0.5", "PIM\nSI 0 0"));
  EXPECT_NEAR(far.surfaces[2].thickness, focus, 1e-3);  // at 587.6 nm
  EXPECT_NE(warning(far, "PIM"), "no warning");
}

TEST(Codev, ZoomPositionsAreConfigurations) {
  const Prescription p = read(with(
      singlet, "GO",
      "ZOO 3\nZOO TIT 'wide' 'middle' 'tele'\nZOO THI S2 4 5 6\nTHI S3 48 47 46\nZOO FNO 4 4 5\nZOO YAN F2 5 4 3\nGO"));
  ASSERT_EQ(p.configurations.size(), 3u);
  EXPECT_EQ(p.configurations[2].name, "tele");
  EXPECT_EQ(p.configurations[2].f_number, 5);
  EXPECT_EQ(configured(p, "tele").surfaces[1].thickness, 6);
  EXPECT_EQ(configured(p, "tele").surfaces[2].thickness, 46.5);
  EXPECT_NE(warning(p, "ZOO"), "no warning");
  expect_tokens(refusal(with(singlet, "GO", "ZOO 3\nZOO THI S2 4 5\nGO")), {"ZOO", 2});
}

TEST(Codev, EveryWordIsReadOrReported) {
  EXPECT_NE(warning(with_line("XYZ 5"), "XYZ"), "no warning");
  EXPECT_NE(warning(with_line("'' 5"), ""), "no warning");  // a word of no letters
  expect_tokens(refusal(with(singlet, "GO", "SCA 2\nGO")), {"SCA"});
  EXPECT_EQ(read(with(singlet, "SO 0", "S0 0")).surfaces, read(singlet).surfaces);
  EXPECT_TRUE(read(with_line("CCY 0; THC 0; KC 1")).imported->warnings.empty());
  const Prescription without = read(with(singlet, "  STO\n", ""));
  EXPECT_TRUE(without.surfaces[0].stop);
  EXPECT_NE(warning(without, "stop"), "no warning");
}

TEST(Codev, WordsMayNameTheirSurface) {
  const auto surface = [](std::size_t i, const std::string& words) {
    return read(with(singlet, "\nGO", '\n' + words + "\nGO")).surfaces.at(i);
  };
  EXPECT_EQ(surface(1, "CIR S2 6").semi_diameter, 6);
  EXPECT_EQ(surface(1, "CUY S2 0.0125").radius, 80);
  EXPECT_EQ(surface(1, "CUY S2 0").radius, 0);
  EXPECT_EQ(
      surface(1, "S2 60 5 1.6:50"),
      (petzval::SurfaceRow{
          .radius = 60, .thickness = 5, .medium = {.nd = 1.6, .vd = 50}, .semi_diameter = 8, .comment = "front"}));
  EXPECT_TRUE(surface(2, "GLA S3 REFL").mirror);
  EXPECT_EQ(surface(2, "PIK GLA S3 GLA S2").medium.nd, 1.5);
  EXPECT_EQ(surface(1, "PIK THI S2 THI S1").thickness, 2);
  EXPECT_NE(warning(with(singlet, "\nGO", "\nPIK THI S2 THI S1 1 2\nGO"), "PIK"), "no warning");
  EXPECT_TRUE(surface(1, "STO S2").stop);
  // The object by number or name, and a distance for each position.
  const Prescription p = read(with(singlet, "\nGO", "\nTHI SO 300\nZOO 2\nZOO THI SO 300 200\nCUY S2 0.02 0.025\nGO"));
  EXPECT_EQ(p.design.object_distance_mm, 300);
  EXPECT_EQ(p.configurations.at(1).subject_distance_mm, 200);
  EXPECT_EQ(configured(p, 1).surfaces[1].radius, 40);
}

TEST(Codev, CylindersAreCurvedInOneSection) {
  const auto row = [](const std::string& shape, const std::string& words) {
    return read(with(with_line(words), "S 50 4", "S " + shape + " 4")).surfaces[1];
  };
  EXPECT_EQ(row("50", "CYL").curved_in, petzval::Section::y);
  EXPECT_EQ(row("50", "CYL; RDX 0").curved_in, petzval::Section::y);
  EXPECT_EQ(row("0", "RDX 40").curved_in, petzval::Section::x);
  EXPECT_EQ(row("0", "RDX 40").radius, 40);
  EXPECT_EQ(row("0", "CYL; RDX 40").curved_in, petzval::Section::x);
}

TEST(Codev, InvalidLensesAreRefused) {
  const auto refused = [](const std::string& words) { return refusal(with(singlet, "\nGO", '\n' + words + "\nGO")); };
  expect_tokens(refused("PIK RDY S9 Z1 RDY S2 Z1"), {"PIK", "surface"});
  expect_tokens(refused("GLA"), {"GLA"});
  expect_tokens(refused("THI S9 5"), {"THI", "\"S9\""});
  expect_tokens(refused("EPD 0"), {"EPD", 0});
  expect_tokens(refused("WL 0.5876"), {"WL", 0.5876});
  expect_tokens(refused("REF 4"), {"REF", 4});
  expect_tokens(refused("CIR S2 -1"), {"CIR", -1});
  expect_tokens(refused("S 50 4"), {"S", "SI"});
  expect_tokens(refused("ZOO 0"), {"ZOO", 0});
  expect_tokens(refused("ZOO THI"), {"ZOO"});
  expect_tokens(refused("ZOO 3\nZOO THI S9 4 5 6"), {"ZOO", 9});
  expect_tokens(refused(petzval::testing::repeated(10'001, "PIK RDY S3 Z1 RDY S2 Z1\n")), {10000, "pickups"});
  expect_tokens(refused("ZOO 3\n" + petzval::testing::repeated(10'001, "ZOO THI S2 4 5 6\n")), {10000, "zoomed"});
  expect_tokens(refusal(with_line("CYL; RDX 40")), {"RDX", 40});
  const std::string own = "PRV\nPWL 656.2725 486.1327\n'MYGLASS' 1.59 1.62\nEND\n";
  expect_tokens(refusal(with(with(singlet, "SO 0", own + "SO 0"), "1.5:60", "MYGLASS")), {"MYGLASS"});
}

TEST(Codev, InfinityIsAPlaneOrAFarObject) {
  for (const char* word : {"inf", "INF", "Infinity"}) {
    const Prescription p = read(with(with(singlet, "SO 0 1e13", "SO " + std::string(word) + ' ' + word), "S 0 2",
                                     "S " + std::string(word) + " 2"));
    EXPECT_EQ(p.design.object_distance_mm, HUGE_VAL);
    EXPECT_EQ(p.surfaces, read(singlet).surfaces);
    EXPECT_EQ(read(with(singlet, "\nGO", "\nTHI SO 300\nTHI SO " + std::string(word) + "\nGO")).design, p.design);
  }
  expect_tokens(refusal(with(singlet, "S 50 4", "S 50 inf")), {"thickness"});
  expect_tokens(refusal(with(with(singlet, "RDM;", "RDM N;"), "S 0 2", "S inf 2")), {"x:13", "S", "\"inf\""});
}

TEST(Codev, ThreeLettersOfAWordAreEnough) {
  const Prescription p = read(with(with(singlet, "EPD 10", "EPDIAMETER 12"), "VUY 0 0.2", "VUYX 0 0.2"));
  EXPECT_EQ(p.design.aperture, (petzval::DesignAperture{petzval::ApertureSetting::entrance_pupil_diameter, 12}));
  EXPECT_NEAR(p.design.fields[1].compress_y, 0.3, 1e-15);
}

TEST(Codev, TruncatedTextsAreReadOrRefused) {
  int refused = 0;
  for (std::size_t length = 0; length < singlet.size(); ++length)
    refused += refusal(singlet.substr(0, length)) != "no error";
  EXPECT_GT(refused, 200);
}

}  // namespace codev_test
