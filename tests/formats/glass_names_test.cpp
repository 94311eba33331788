// SPDX-License-Identifier: Apache-2.0
// Glasses named in files: catalogues, numbers after the name, substitutions, infrared and constant materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "../expect_error.hpp"
#include "lens_text.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace glass_names_test {

namespace fs = std::filesystem;
using petzval::Glass;
using petzval::GlassCatalogue;
using petzval::Medium;
using petzval::Prescription;
using petzval::testing::expect_tokens;
using petzval::testing::read;
using petzval::testing::refusal;
using petzval::testing::warning;
using petzval::testing::with;

double focal_length(const Prescription& p, double nm = petzval::d_line_nm, const GlassCatalogue* glasses = nullptr) {
  const petzval::Lens lens = compile(p, std::array{nm}, {.glasses = glasses});
  return first_order(lens).effective_focal_length;
}

/// A double Gauss lens of 84 mm with named glasses. sk4, f2: text after the names.
std::string double_gauss(const std::string& catalogues, const std::string& sk4, const std::string& f2) {
  struct Row {
    double radius, thickness;
    std::string glass;
  };
  const std::vector<Row> rows{{42.2, 6.5, "SK4 " + sk4},
                              {113.3, 0.4, ""},
                              {28.3, 9.2, "SK4 " + sk4},
                              {-1500, 2.8, "F2 " + f2},
                              {18.2, 10.6, ""},
                              {0, 8.9, ""},
                              {-21.3, 2.8, "F2 " + f2},
                              {59.5, 8.1, "SK4 " + sk4},
                              {-29.8, 0.4, ""},
                              {133, 5.1, "SK4 " + sk4},
                              {-59.8, 46, ""}};
  std::string text = "VERS 140730 0 0\nMODE SEQ\nUNIT MM X W X CM MR CPMM\nENPD 20\n" +
                     (catalogues.empty() ? std::string() : "GCAT " + catalogues + "\n") +
                     "WAVM 1 0.5875618 1\nPWAV 1\nSURF 0\n  TYPE STANDARD\n  CURV 0\n  DISZ INFINITY\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += "SURF " + std::to_string(i + 1) + (i == 5 ? "\n  STOP" : "") + "\n  TYPE STANDARD\n  CURV " +
            std::to_string(rows[i].radius == 0 ? 0 : 1 / rows[i].radius) + "\n  DISZ " +
            std::to_string(rows[i].thickness) + "\n" + (rows[i].glass.empty() ? "" : "  GLAS " + rows[i].glass + "\n");
  }
  return text + "SURF 12\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n";
}

const std::string dummy = "0 0 1.5 40 0 0 0 0 0 0";

bool speaks_of(const Prescription& p, std::string_view glass) {
  return std::ranges::any_of(p.imported->warnings, [&](const auto& w) { return w.command == glass; });
}

TEST(GlassNames, ZemaxFixedGlass_IgnoresLeftoverNumbers) {
  const Prescription named = read(double_gauss("SCHOTT", dummy, dummy));
  const double f = focal_length(named);
  const std::vector<std::array<std::string, 2>> stale{
      {"0 0 1.6228 60.3 0 0 0 0 0 0", "0 0 1.59551 39.2 0 0 0 0 0 0"},    // another glass
      {"0 0 1.6127 58.6 0.0001 1 1 0 0 0", "0 0 1.6129 37 0 1 1 0 0 0"},  // F2 of cdgm, flags of variables
      {"0 0 1.9 20 0 0 0 0 0 0", "0 0 1.4 90 0 0 0 0 0 0"}};
  for (const auto& [sk4, f2] : stale) {
    const Prescription p = read(double_gauss("SCHOTT", sk4, f2));
    EXPECT_NEAR(focal_length(p), f, 1e-12 * f) << sk4;
    EXPECT_EQ(p.surfaces, named.surfaces);
    EXPECT_FALSE(speaks_of(p, "SK4") || speaks_of(p, "F2"));
  }
  EXPECT_EQ(named.surfaces[0].medium.catalogue, "schott-legacy");
  EXPECT_EQ(named.surfaces[3].medium.catalogue, "schott");
  // The numbers of a model glass are used.
  const Prescription model = read(double_gauss("SCHOTT", "1 0 1.9 20 0 0 0 0 0 0", dummy));
  EXPECT_EQ(model.surfaces[0].medium, (Medium{.nd = 1.9, .vd = 20}));
  EXPECT_GT(std::abs(focal_length(model) - f), 1);
}

TEST(GlassNames, ZemaxCatalogues_ComeInTheOrderOfGcat) {
  const auto f2 = [](const std::string& catalogues) {
    const Prescription p = read(double_gauss(catalogues, dummy, dummy));
    EXPECT_FALSE(speaks_of(p, "F2")) << catalogues;
    return *p.surfaces[3].medium.catalogue;
  };
  EXPECT_EQ(f2("SCHOTT CDGM"), "schott");
  EXPECT_EQ(f2("CDGM SCHOTT"), "cdgm");
  EXPECT_EQ(f2("HIKARI SCHOTT"), "hikari");
  EXPECT_EQ(f2("NIKON-HIKARI SCHOTT_2009"), "hikari");
  EXPECT_EQ(f2("OLD-OHAR SCHO"), "ohara-1983");
  EXPECT_EQ(f2(""), "schott");  // the default of OpticStudio
}

TEST(GlassNames, ZemaxGlassOfAnotherCatalogue_IsAWarningThatNamesBoth) {
  const std::string text = with(double_gauss("OHARA", dummy, dummy), "GLAS F2", "GLAS H-ZF1");
  const Prescription p = read(text);
  EXPECT_EQ(p.surfaces[3].medium.catalogue, "cdgm");
  const std::string said = warning(p, "H-ZF1");
  expect_tokens(said, {"OHARA", "H-ZF1", "cdgm"});
  // The tables list the glass by another name, or without the suffix of moulded versions.
  const auto other = [](const std::string& name) {
    return warning(with(double_gauss("SCHOTT MISC OHARA", dummy, dummy), "GLAS F2", "GLAS " + name), name);
  };
  expect_tokens(other("SILICA"), {"F_SILICA", "misc"});
  expect_tokens(other("C79-80"), {"F_SILICA", "misc"});
  expect_tokens(other("ZNS_IR"), {"ZNS", "infrared"});
  expect_tokens(other("N15"), {1.5});
  expect_tokens(other("L-TIM28_MOLD"), {"L-TIM28", "ohara"});
}

TEST(GlassNames, NameInSeveralCatalogues_IsAWarningUnlessTheFileNamesOne) {
  const std::string seq = "RDM;LEN\nDIM M\nWL 587.56\nEPD 5\nSO 0 1e13\nS 50 4 F2\nSTO\nS -50 40\nSI 0 0\nGO\n";
  expect_tokens(warning(read(seq), "F2"), {"schott", "cdgm"});
  EXPECT_EQ(warning(read(with(seq, "F2", "F2_SCHOTT")), "F2"), "no warning");
  EXPECT_EQ(warning(read(with(seq, "F2", "NBK7")), "NBK7"), "no warning");
}

// Radii, thicknesses and glasses of the Cooke triplet that OpticStudio ships; its primary wavelength is 0.55 um, where
// OpticStudio prints a focal length of 49.9997831 mm. In the format of optiland.
std::string cooke_triplet() {
  struct Row {
    double radius, thickness;
    const char* glass;
  };
  const std::vector<Row> rows{{22.01359, 3.25896, "hikari/SK16"}, {-435.76044, 6.00755, ""},
                              {-22.21328, 0.99997, "schott/F2"},  {20.29192, 4.75041, ""},
                              {79.6836, 2.95208, "hikari/SK16"},  {-18.39533, 42.20778, ""}};
  const std::string air = R"({"type": "IdealMaterial", "index": 1.0})";
  std::string surfaces = R"({"geometry": {"type": "Plane", "cs": {"z": -Infinity}}, "material_post": )" + air + "}";
  double z = 0;
  for (const auto& [radius, thickness, glass] : rows) {
    const std::string path = glass, name = path.substr(path.find('/') + 1);
    surfaces += ",\n" + (R"({"geometry": {"type": "StandardGeometry", "cs": {"z": )" + std::to_string(z)) +
                R"(}, "radius": )" + std::to_string(radius) + R"(}, "is_stop": )" +
                (radius == 20.29192 ? "true" : "false") + R"(, "material_post": )" +
                (name.empty() ? air
                              : R"({"type": "Material", "name": ")" + name + R"(", "filename": "data-nk/glass/)" +
                                    path + R"(.yml"})") +
                "}";
    z += thickness;
  }
  return R"({"aperture": {"type": "EPD", "value": 10},
 "wavelengths": {"wavelengths": [{"value": 0.48, "unit": "um"}, {"value": 0.55, "is_primary": true, "unit": "um"}]},
 "surface_group": {"surfaces": [)" +
         surfaces + R"(, {"geometry": {"type": "Plane", "cs": {"z": )" + std::to_string(z) +
         R"(}}, "material_post": )" + air + "}]}}";
}

TEST(GlassNames, NamedGlass_HasTheIndexOfItsFormula) {
  const Prescription p = read(cooke_triplet());
  EXPECT_EQ(warning(p, "SK16"), "no warning");
  EXPECT_NEAR(focal_length(p, 550), 49.9997831, 1e-7 * 50);
  const Glass& sk16 = *petzval::glass_tables().find("SK16", "hikari");
  EXPECT_EQ(p.surfaces[0].medium.nd, petzval::refractive_index(sk16, petzval::d_line_nm));
  EXPECT_NEAR(p.surfaces[0].medium.vd.value(), sk16.vd, 1e-3);
  // The library's JSON and a .zmx keep the index.
  EXPECT_NEAR(focal_length(petzval::parse_prescription(format_prescription(p), "x"), 550), 49.9997831, 1e-7 * 50);
  std::string of_schott = cooke_triplet();
  for (std::size_t at; (at = of_schott.find("hikari")) != std::string::npos;) of_schott.replace(at, 6, "schott");
  const Prescription schott = read(of_schott);
  const auto zmx = petzval::format_zemax(schott);
  EXPECT_NE(zmx.text.find("GLAS SK16 0 0 "), std::string::npos) << zmx.text;
  EXPECT_NEAR(focal_length(read(zmx.text), 550), focal_length(schott, 550), 1e-11 * 50);
}

// SK16 of hikari and F2 of schott: each catalogue also has a glass with the other name.
TEST(GlassNames, ZemaxWriter_OffsetsAGlassWhoseNameIsHidden) {
  const Prescription p = read(cooke_triplet());
  const auto zmx = petzval::format_zemax(p);
  EXPECT_TRUE(std::ranges::any_of(zmx.losses, [](const auto& loss) { return loss.command == "glass"; }));
  EXPECT_NEAR(focal_length(read(zmx.text)), focal_length(p), 1e-9 * 50);
  // Another order of catalogues is enough if only hikari has the glass.
  const Prescription one = read(with(double_gauss("SCHOTT HIKARI", dummy, dummy), "GLAS SK4", "GLAS J-BK7A"));
  ASSERT_EQ(one.surfaces[0].medium.catalogue, "hikari");
  ASSERT_EQ(one.surfaces[3].medium.catalogue, "schott");
  EXPECT_EQ(read(petzval::format_zemax(one).text).surfaces, one.surfaces);
}

TEST(GlassNames, PrintedIndex_IsKeptWithTheGlass) {
  // A table with an index: the rounded index of the catalogue, and the index of another melt.
  const auto nd = [](const std::string& index) {
    return read("[descriptive data]\ntitle\tx\n[lens data]\n1\t50\t4\t" + index +
                "\t20\t64.2\tN-BK7\n2\t-50\t48\t\t20\n[constants]\nFocal Length\t50\n")
        .surfaces[0]
        .medium.nd.value();
  };
  const double formula = petzval::refractive_index(*petzval::glass_tables().find("N-BK7"), petzval::d_line_nm);
  EXPECT_EQ(nd("1.5168"), formula);
  EXPECT_EQ(nd("1.51680"), formula);
  EXPECT_EQ(nd("1.5173"), 1.5173);
}

/// The triplet with one material in another data set.
std::string with_material(const std::string& material) {
  return with(cooke_triplet(), R"({"type": "Material", "name": "F2", "filename": "data-nk/glass/schott/F2.yml"})",
              material);
}

TEST(GlassNames, OptilandDataSetThatIsReplaced_IsAWarningThatNamesBoth) {
  for (const char* material : {R"({"type": "Material", "name": "CaF2", "reference": "Daimon-20"})",
                               R"({"type": "MaterialFile", "filename": "data-nk/main/CaF2/Daimon-20.yml"})"}) {
    expect_tokens(warning(read(with_material(material)), "CaF2"), {"Daimon-20", "CAF2", "misc"});
  }
  for (const char* material : {R"({"type": "Material", "name": "CaF2", "reference": "Malitson"})",
                               R"({"type": "MaterialFile", "filename": "data-nk/main/CaF2/Malitson.yml"})"}) {
    const Prescription p = read(with_material(material));
    EXPECT_EQ(p.surfaces[2].medium.glass, "CAF2");
    EXPECT_FALSE(speaks_of(p, "CaF2") || speaks_of(p, "CAF2"));
  }
}

TEST(GlassNames, IdealMaterial_HasItsIndexAtEveryWavelength) {
  const Prescription p = read(with_material(R"({"type": "IdealMaterial", "index": 1.6})"));
  EXPECT_EQ(p.surfaces[2].medium, (Medium{.nd = 1.6, .vd = 0}));
  for (const double nm : {400.0, 650.0}) EXPECT_EQ(compile(p, std::array{nm}).index(3), 1.6);
  const auto zmx = petzval::format_zemax(p);
  EXPECT_EQ(read(zmx.text).surfaces[2].medium, p.surfaces[2].medium);
  const auto seq = petzval::format_codev(p);
  EXPECT_EQ(read(seq.text).surfaces[2].medium.vd, 0);
  EXPECT_EQ(petzval::parse_prescription(format_prescription(p), "x"), p);
}

class InfraredGlass : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  GlassCatalogue glasses(const std::string& agf) const {
    std::ofstream(folder / "infrared.agf", std::ios::binary) << agf;
    return with_glasses(petzval::glass_tables(), petzval::read_glasses(folder / "infrared.agf").glasses);
  }

  fs::path folder;
};

// Three lines: V_d 0, since germanium is opaque at the d line. Formula 2, of 3 to 12 um.
const std::string germanium_agf = "NM GERMANIUM 2 000000 4.003 0 0 0\nCD 14.0 0.2 0.3 24 0 0 0 0 0 0\nLD 3 12\n";

std::string infrared_lens(const std::string& glass) {
  return "VERS 140730 0 0\nMODE SEQ\nUNIT MM X W X CM MR CPMM\nENPD 20\nGCAT INFRARED SCHOTT\nWAVM 1 8 1\nWAVM 2 10.6 "
         "1\n"
         "PWAV 2\nSURF 0\n  TYPE STANDARD\n  CURV 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  TYPE STANDARD\n  CURV 0.01\n  "
         "DISZ 4\n"
         "  GLAS " +
         glass + "\nSURF 2\n  TYPE STANDARD\n  CURV 0.007\n  DISZ 90\nSURF 3\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n";
}

TEST_F(InfraredGlass, WithoutIndexAtTheDLine_IsReadAtThePrimaryWavelength) {
  const std::string text = infrared_lens("GERMANIUM 0 0 1.5 40 0 0 0 0 0 0");
  expect_tokens(refusal(with(text, "GERMANIUM", "CHALCOGEN")), {"--glasses", "INFRARED, SCHOTT"});
  const GlassCatalogue all = glasses(germanium_agf);
  const Prescription p = petzval::parse_lens(text, "x", {.glasses = &all});
  EXPECT_FALSE(speaks_of(p, "GERMANIUM"));
  EXPECT_EQ(p.reference_wavelength_nm, 10600);
  const auto germanium = [&](double nm) { return petzval::refractive_index(*all.find("GERMANIUM"), nm); };
  EXPECT_EQ(p.surfaces[0].medium.nd, germanium(10600));
  EXPECT_EQ(p.surfaces[0].medium.vd, std::nullopt);
  const petzval::Lens lens = compile(p, {.glasses = &all});
  const double n = germanium(10600), power = (n - 1) * (0.01 - 0.007 + (n - 1) / n * 4 * 0.01 * 0.007);
  EXPECT_NEAR(first_order(lens).effective_focal_length, 1 / power, 1e-9 / power);
  EXPECT_EQ(compile(p, std::array{8000.0}, {.glasses = &all}).index(1), n + (germanium(8000) - n));
  // It is kept by its own JSON and by a .zmx.
  EXPECT_EQ(petzval::parse_prescription(format_prescription(p), "x"), p);
  const auto zmx = petzval::format_zemax(p, &all);
  EXPECT_NE(zmx.text.find("GLAS GERMANIUM 0 0 "), std::string::npos) << zmx.text;
  EXPECT_EQ(petzval::parse_lens(zmx.text, "x", {.glasses = &all}).surfaces, p.surfaces);
}

// By the formula of Burnett 2016: 4.003556 at 10.6 um.
TEST(GlassNames, InfraredGlassOfTheTables_IsReadAtThePrimaryWavelength) {
  const Prescription p = read(infrared_lens("GERMANIUM 0 0 1.5 40 0 0 0 0 0 0"));
  const double n = 4.003556, power = (n - 1) * (0.01 - 0.007 + (n - 1) / n * 4 * 0.01 * 0.007);
  EXPECT_NEAR(focal_length(p, 10600), 1 / power, 1e-4);
  EXPECT_FALSE(speaks_of(p, "GERMANIUM"));
}

TEST_F(InfraredGlass, WithAConstantIndex_KeepsItWithoutItsCatalogue) {
  const GlassCatalogue all = glasses("NM N15 1 000000 1.5 0 0 0\nCD 2.25 0 0 0 0 0 0 0 0 0\nLD 0.3 20\n");
  const Prescription p = petzval::parse_lens(infrared_lens("N15 0 0 1.5 40 0 0 0 0 0 0"), "x", {.glasses = &all});
  EXPECT_EQ(p.surfaces[0].medium, (Medium{.glass = "N15", .catalogue = "infrared", .nd = 1.5, .vd = 0}));
  EXPECT_EQ(compile(p, std::array{10600.0}, {.glasses = &all}).index(1), 1.5);
  EXPECT_EQ(compile(p, std::array{10600.0}).index(1), 1.5);
}

TEST_F(InfraredGlass, CatalogueThatBeginsWithASentence_IsRead) {
  const GlassCatalogue all = glasses("These glasses were collected in 1999.\nand more words\n" + germanium_agf);
  EXPECT_NE(all.find("GERMANIUM"), nullptr);
  const petzval::GlassFile file = petzval::read_glasses(folder / "infrared.agf");
  for (const auto& w : file.warnings) EXPECT_NE(w.line, 1) << w.message;
}

}  // namespace glass_names_test
