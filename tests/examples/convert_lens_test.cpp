// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "petzval/formats/lens_file.hpp"
#include "petzval/image/image.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "program.hpp"

namespace {

using ConvertLens = Programs;

const std::string table = "# A singlet 50 mm f/5\n50.6 5.2 1.5168 25.4\n-50.6 1 1 25.4\n0 47 0 9.4\n";
const std::string zemax = R"(MODE SEQ
NAME Two positions
UNIT IN X W X CM MR CPMM
FNUM 8 0
SURF 0
  DISZ INFINITY
SURF 1
  STOP
  CURV 0.5
  DISZ 0.2
  GLAS MYGLASS 0 0 1.5 40
SURF 2
  CURV -0.5
  DISZ 1.9
SURF 3
MNUM 2 1
LTTL 0 1 "near"
LTTL 0 2 "far"
THIC 2 1 1.9
THIC 2 2 2.1
)";
const std::string glasses = R"(CC
NM MYGLASS 2 517642 1.5168 64.17 0 1
CD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653 0 0 0 0
LD 0.3 2.5
)";

TEST_F(ConvertLens, ExtensionChoosesTheFormat) {
  for (const char* ending : {".json", ".dat", ".zmx", ".seq"}) {
    const auto outcome = run("convert", {lens("double_gauss_100mm_f2.0"), path(std::string("lens") + ending)});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto back = petzval::read_lens(path(std::string("lens") + ending));
    // Other programs' files name glasses, whose formulas differ from printed indices by a few 1e-6.
    const bool names_glasses = std::string(ending) == ".zmx" || std::string(ending) == ".seq";
    EXPECT_NEAR(petzval::first_order(petzval::compile(back)).effective_focal_length, 100.7163339,
                names_glasses ? 1e-3 : 1e-6)
        << ending;
  }
  EXPECT_EQ(read(path("lens.json")), read(lens("double_gauss_100mm_f2.0")));  // byte for byte
  EXPECT_EQ(run("convert", {lens("double_gauss_100mm_f2.0"), path("lens.osl")}).status, 0);
  EXPECT_EQ(read(path("lens.osl")).find("// Double Gauss 100 mm f/2"), 0u);
  EXPECT_EQ(run("convert", {lens("double_gauss_100mm_f2.0"), path("lens.osl"), "--wavelengths", "rgb"}).status, 0);
  EXPECT_NE(read(path("lens.osl")).find("3 wavelengths from 475 to 650 nm"), std::string::npos);
  // Media with n_d and V_d only, and with n_d only.
  EXPECT_NE(run("convert", {lens("planar_50mm_f1.4"), path("lens.osl"), "--wavelengths", "rgb"}).err.find("n_d/V_d"),
            std::string::npos);
  EXPECT_NE(read(path("lens.osl")).find("3 wavelengths from 475 to 650 nm"), std::string::npos);
  const auto grey = run("convert", {lens("fisheye_10mm_f4"), path("lens.osl"), "--wavelengths", "rgb"});
  EXPECT_EQ(grey.status, 0) << grey.err;
  EXPECT_NE(grey.err.find("dispersion"), std::string::npos) << grey.err;
  expect_failure("convert", {lens("double_gauss_100mm_f2.0"), path("lens.zmx"), "--wavelengths", "rgb"},
                 {"--wavelengths", "lens.zmx", ".osl"});
  EXPECT_EQ(run("convert", {lens("double_gauss_100mm_f2.0"), path("lens.opentrackio.json")}).status, 0);
  EXPECT_TRUE(read_json(path("lens.opentrackio.json")).contains("lens"));
  EXPECT_EQ(run("convert", {lens("double_gauss_100mm_f2.0"), path("lens.stmap.exr")}).status, 0);
  EXPECT_EQ(petzval::read_exr_parts(path("lens.stmap.exr")).size(), 2u);
  expect_failure("convert", {lens("double_gauss_100mm_f2.0"), path("lens.doc")}, {"lens.doc"});
}

TEST_F(ConvertLens, JsonReportDescribesTheInput) {
  write("lens.dat", table);
  const auto outcome = run("convert", {path("lens.dat"), path("lens.json"), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["format"], "table");
  EXPECT_EQ(json["title"], "A singlet 50 mm f/5");
  EXPECT_EQ(json["units"], "mm");
  EXPECT_EQ(json["surfaces"], 3);
  EXPECT_EQ(json["stop"], 2);
  EXPECT_NEAR(json["effective_focal_length_mm"].get<double>(), 49.8272, 1e-3);
  EXPECT_NEAR(json["f_number"].get<double>(), 5, 0.2);
  EXPECT_EQ(json["declared"]["focal_length_mm"], 50);
  EXPECT_EQ(json["warnings"].size(), 0u);
  EXPECT_EQ(json["configurations"].size(), 0u);
}

TEST_F(ConvertLens, ReportsLostZoomPositions) {
  for (const char* name : {"zoom.dat", "zoom.osl", "zoom.opentrackio.json", "zoom.stmap.exr"}) {
    const std::string lost = path(name) + ": configurations";
    const auto whole = run("convert", {lens("zoom_70-210mm_f4"), path(name)});
    EXPECT_EQ(whole.status, 0) << whole.err;
    EXPECT_NE(whole.err.find(lost), std::string::npos) << whole.err;
    const auto one = run("convert", {lens("zoom_70-210mm_f4"), path(name), "--configuration", "tele"});
    EXPECT_EQ(one.status, 0) << one.err;
    EXPECT_EQ(one.err.find(lost), std::string::npos) << one.err;
  }
}

TEST_F(ConvertLens, StrictRefusesWithStatus3AndWritesNothing) {
  write("lens.dat", "50.6 5.2 1.5168 25.4\n-50.6 0 1 25.4\n");
  const auto outcome = run("convert", {path("lens.dat"), path("lens.json"), "--strict"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_FALSE(std::filesystem::exists(path("lens.json")));
  EXPECT_NE(outcome.err.find("line 2: thickness"), std::string::npos);
  write("lens.dat", table);
  EXPECT_EQ(run("convert", {path("lens.dat"), path("lens.json"), "--strict"}).status, 0);
}

TEST_F(ConvertLens, MissingGlassesAreReadFromFilesOfTheUser) {
  write("lens.zmx", zemax);
  write("my.agf", glasses);
  expect_failure("convert", {path("lens.zmx"), path("lens.json")}, {"MYGLASS"});
  const auto outcome = run("convert", {path("lens.zmx"), path("lens.json"), "--glasses", path("my.agf"), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["units"], "in");
  ASSERT_EQ(json["configurations"].size(), 2u);
  EXPECT_EQ(json["configurations"][1]["name"], "far");
  EXPECT_NEAR(json["f_number"].get<double>(), 8, 1e-6);
  const auto back = petzval::read_lens(path("lens.json"));
  EXPECT_EQ(back.configurations.size(), 2u);
  EXPECT_NEAR(back.surfaces[0].medium.nd.value(), 1.5168, 1e-7);  // by the formula
  // A single position.
  EXPECT_EQ(run("convert", {path("lens.zmx"), path("far.json"), "--glasses", path("my.agf"), "--configuration", "far"})
                .status,
            0);
  EXPECT_NEAR(petzval::read_lens(path("far.json")).surfaces[1].thickness, 2.1 * 25.4, 1e-9);
}

// Germanium is opaque at the d line: V_d is 0, and the lens is made for 10.6 um.
TEST_F(ConvertLens, InfraredGlassOfAUsersFile_IsReadByEveryProgramThatRecommendsIt) {
  write("ge.zmx", R"(MODE SEQ
UNIT MM X W X CM MR CPMM
ENPD 20
WAVM 1 10.6 1
PWAV 1
SURF 0
  DISZ INFINITY
SURF 1
  STOP
  CURV 0.01
  DISZ 4
  GLAS CHALCOGEN 0 0 1.5 40
SURF 2
  CURV 0.007
  DISZ 90
SURF 3
)");
  write("infrared.agf", "NM CHALCOGEN 2 000000 4.003 0 0 0\nCD 14.0 0.2 0.3 24 0 0 0 0 0 0\nLD 3 12\n");
  const auto expect_both = [&](const std::string& program, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), path("ge.zmx"));
    const auto without = run(program, arguments);
    EXPECT_NE(without.status, 0) << program;
    EXPECT_NE(without.err.find("--glasses"), std::string::npos) << without.err;
    arguments.insert(arguments.end(), {"--glasses", path("infrared.agf")});
    const auto with = run(program, arguments);
    EXPECT_EQ(with.status, 0) << program << ' ' << with.err;
  };
  expect_both("convert", {path("ge.json")});
  expect_both("report", {"--wavelengths", "10600"});
  expect_both("spots", {"--wavelengths", "10600", "--fields", "0", "--out", path("spots")});
  const auto back = petzval::read_lens(path("ge.json"));
  EXPECT_EQ(back.reference_wavelength_nm, 10600);
  EXPECT_NEAR(petzval::first_order(petzval::compile(back)).effective_focal_length, 106.5453, 1e-4);
  for (const char* ending : {".zmx", ".seq", ".dat", ".osl"}) {
    EXPECT_EQ(
        run("convert", {path("ge.json"), path(std::string("out") + ending), "--glasses", path("infrared.agf")}).status,
        0)
        << ending;
  }
}

TEST_F(ConvertLens, RepairsUnambiguousFaults) {
  // A lens of 50 mm that declares 50 mm and f/5, with diameters instead of semi-diameters, and ten times too large.
  write("lens.json", R"({"format": "petzval-lens 1", "name": "bad", "focal_length_mm": 50, "f_number": 5, "surfaces": [
    {"radius": 506, "thickness": 52, "nd": 1.5168, "semi_diameter": 100, "stop": true},
    {"radius": -506, "thickness": 600, "nd": 1, "semi_diameter": 120, "stop": true}]})");
  const auto outcome = run("convert", {path("lens.json"), path("good.json"), "--repair", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["repairs"].size(), 4u) << outcome.err;
  EXPECT_NEAR(json["effective_focal_length_mm"].get<double>(), 49.83, 0.01);
  EXPECT_NEAR(json["f_number"].get<double>(), 5, 0.1);
  EXPECT_EQ(json["lint"].size(), 0u);
}

TEST_F(ConvertLens, EveryProgramReadsEveryFormat) {
  write("lens.dat", table);
  const auto outcome = run("report", {path("lens.dat"), "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["format"], "table");
  const auto zoom = run("report", {lens("zoom_70-210mm_f4"), "--json", "--configuration", "tele"});
  EXPECT_NEAR(nlohmann::json::parse(zoom.out)["effective_focal_length_mm"].get<double>(), 205.265, 1e-3);
}

// The example lens of data/README.md, with the glasses of its index numbers.
TEST_F(ConvertLens, TypedTablesGetTheirGlasses) {
  write("cooke.txt",
        "# Cooke triplet 50 mm f/5\nR d nd vd semi\n22.01359 3.25896 1.62041 60.3 9.5\n-435.76044 6.00755\n"
        "-22.21328 0.99997 1.62004 36.4 5\n20.29192 4.75041 1 - 4.8 stop\n79.6836 2.95208 1.62041 60.3 8\n"
        "-18.39533 42.20778\n");
  const auto plain = run("report", {path("cooke.txt"), "--json"});
  ASSERT_EQ(plain.status, 0) << plain.err;
  EXPECT_NEAR(nlohmann::json::parse(plain.out)["effective_focal_length_mm"].get<double>(), 50.0213, 1e-3);
  EXPECT_EQ(plain.err.find("matched"), std::string::npos);

  const auto matched = run("convert", {path("cooke.txt"), path("cooke.json"), "--match-glasses"});
  ASSERT_EQ(matched.status, 0) << matched.err;
  const auto lens = petzval::read_lens(path("cooke.json"));
  for (const std::size_t i : {0u, 2u, 4u}) {
    EXPECT_EQ(lens.surfaces[i].medium.glass_origin, "matched") << i;
    EXPECT_NE(matched.err.find(lens.surfaces[i].medium.glass.value()), std::string::npos) << matched.err;
  }
  EXPECT_EQ(lens.surfaces[0].medium.nd, 1.62041);
  EXPECT_NEAR(petzval::first_order(petzval::compile(lens)).effective_focal_length, 50.0213, 1e-3);
  EXPECT_NE(run("report", {path("cooke.txt"), "--match-glasses"}).err.find("matched"), std::string::npos);
}

TEST_F(ConvertLens, OneLensOfADatabaseIsAConfiguration) {
  const std::string element = R"({"radius": 50, "thickness": [5, 6, 7], "material": "abbe", "ior": 1.5, "abbe": 60},
    {"radius": -50, "thickness": 47, "material": "air"})";
  write("lenses.json", R"({"2003": {"product-name": "a", "optical-elements-patent": [)" + element +
                           R"(]}, "2004": {"product-name": "b", "optical-elements-patent": [)" + element + "]}}");
  expect_failure("convert", {path("lenses.json"), path("lens.json")}, {"--configuration", 2003, "a", 2004, "b"});
  for (const char* chosen : {"2004", "b"}) {
    ASSERT_EQ(run("convert", {path("lenses.json"), path("lens.json"), "--configuration", chosen}).status, 0);
    const auto lens = petzval::read_lens(path("lens.json"));
    EXPECT_EQ(lens.imported->entry, "2004");
    EXPECT_EQ(lens.configurations.size(), 3u);
  }
  ASSERT_EQ(run("convert", {path("lenses.json"), path("lens.json"), "--configuration", "2004/long"}).status, 0);
  EXPECT_EQ(petzval::read_lens(path("lens.json")).surfaces[0].thickness, 7);
  EXPECT_EQ(run("report", {path("lenses.json"), "--configuration", "2004/long"}).status, 0);
}

TEST_F(ConvertLens, BadFilesFailInOneLine) {
  write("lens.zar", "PK\x03\x04");
  expect_failure("convert", {path("lens.zar"), path("lens.json")}, {"lens.zar", "zip"});
  expect_failure("convert", {path("none.zmx"), path("lens.json")}, {"none.zmx"});
  EXPECT_FALSE(std::filesystem::exists(path("lens.json")));
}

}  // namespace
