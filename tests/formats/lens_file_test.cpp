// SPDX-License-Identifier: Apache-2.0
// Files of unknown kinds, of other programs, and hostile files.
#include <gtest/gtest.h>

#include <clocale>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>

#include "../expect_error.hpp"
#include "lens_text.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace lens_file_test {

namespace fs = std::filesystem;
using petzval::Prescription;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
using petzval::testing::refusal;

const fs::path formats = PETZVAL_TEST_FORMATS;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(LensFile, SamplesOfOtherProgramsHaveTheirFocalLengths) {
  if (!fs::exists(formats)) GTEST_SKIP() << "no samples";
  // Focal lengths from data/README.md, or from the makers of lenses that are missing there.
  const std::map<std::string, double> focal_lengths = {{"cooke_triplet.zmx", 50.0213},
                                                       {"cooke_triplet.len", 50.0213},
                                                       {"cooke_triplet_utf16.zmx", 50.0213},
                                                       {"compact_even_asphere.zmx", 30.806},
                                                       {"catadioptric_corrector.zmx", 24.612},
                                                       {"mangin_photographic.zmx", 999.595},
                                                       {"planar_1896_pickups.zmx", 49.389},
                                                       {"ag_dblgauss.seq", 100.004},
                                                       {"landscape_lens.seq", 10.034},
                                                       {"questar35.seq", 1282.62},
                                                       {"dgauss.50mm.dat", 50.358},
                                                       {"dgauss.axpos.dat", 100.716},
                                                       {"dgauss.f1.35.100mm.dat", 100.437},
                                                       {"fisheye.10mm.dat", 9.991},
                                                       {"telephoto.250mm.dat", 249.567},
                                                       {"wide.22mm.dat", 22.0235},
                                                       {"double_gauss_f1.35.txt", 100.437},
                                                       {"double_gauss_f2.0.txt", 100.716},
                                                       {"double_gauss_f1.7_substitute.txt", 99.913}};
  std::size_t known = 0, lenses = 0;
  for (const char* folder : {"zemax", "codev", "oslo", "pbrt", "table"}) {
    for (const auto& entry : fs::directory_iterator(formats / folder)) {
      if (entry.path().filename() == "finite_conjugate_uv.zmx") {
        // The file declares a telecentric object space, but its stop is elsewhere.
        expect_error([&] { petzval::read_lens(entry.path()); }, {"line 38", "FTYP"});
        continue;
      }
      const Prescription lens = petzval::read_lens(entry.path());
      ++lenses;
      const auto found = focal_lengths.find(entry.path().filename().string());
      if (found == focal_lengths.end()) continue;
      ++known;
      EXPECT_NEAR(petzval::first_order(compile(lens)).effective_focal_length, found->second, 1e-4 * found->second)
          << entry.path();
    }
  }
  EXPECT_EQ(known, focal_lengths.size());
  EXPECT_EQ(lenses, 27u);
}

TEST(LensFile, TruncatedSamplesAreReadOrRefused) {
  if (!fs::exists(formats)) GTEST_SKIP() << "no samples";
  std::size_t texts = 0;
  for (const auto& entry : fs::recursive_directory_iterator(formats)) {
    if (!entry.is_regular_file() || entry.file_size() > 40'000) continue;
    const std::string whole = bytes_of(entry.path());
    // Every byte of short files, and steps through long files.
    const std::size_t step = 1 + whole.size() / 100;
    for (std::size_t length = 0; length < whole.size(); length += step) {
      refusal(whole.substr(0, length));  // any exception but Error ends the test
      ++texts;
    }
  }
  EXPECT_GT(texts, 1500u);
}

TEST(LensFile, ChangedSamplesAreReadOrRefused) {
  if (!fs::exists(formats)) GTEST_SKIP() << "no samples";
  std::mt19937 random(5);
  for (const char* name : {"zemax/cooke_triplet.zmx", "codev/questar35.seq", "pbrt/dgauss.50mm.dat"}) {
    const std::string whole = bytes_of(formats / name);
    for (int i = 0; i < 300; ++i) {
      std::string text = whole;
      for (auto changes = 1 + random() % 4; changes > 0; --changes) {
        text[random() % text.size()] =
            static_cast<char>(random() % 3 ? "0123456789.-eE \n;'\""[random() % 19] : random() % 256);
      }
      refusal(text);
    }
  }
}

TEST(LensFile, OtherFilesAreRefusedByKind) {
  using namespace std::string_literals;
  expect_tokens(refusal("PK\x03\x04 and more"s), {"x", "zip"});
  expect_tokens(refusal("\x89PNG\r\n\x1a\n"s), {"x", "PNG"});
  expect_tokens(refusal("\x76\x2f\x31\x01 exr"s), {"x", "OpenEXR"});
  expect_tokens(refusal("\x01\x02\x00\x03\x04"s), {"x", "byte", 2, 0});
  expect_tokens(refusal("To be, or not to be\n"s), {"x", "To be, or not to be"});
  EXPECT_NE(refusal(""), "no error");
  EXPECT_NE(refusal("\xFF\xFE"s), "no error");
  EXPECT_NE(refusal("{\"lens\": 5}"), "no error");
  // Models of other programs, and the format to export.
  const std::string roa = refusal("{\"optical_model\": {\"seq_model\": {\"ifcs\": []}}}");
  expect_tokens(roa, {"ray-optics", ".seq", ".zmx"});
  const std::string opt = refusal(
      "  3 surfaces  SIMPLE.OPT\n  index   Z     Curv    Diam   Mir/Lens\n--------:-----:-------:------:---------:\n"
      "   1.0  : 0.0 : 0.02  : 10 : Lens\n");
  expect_tokens(opt, {"BEAM FOUR"});
  expect_tokens(refusal("3  entries  PRISM.OPT\n X   Z   pitch\n---:---.-:-----\n"), {"BEAM FOUR"});
  expect_tokens(refusal("OpTaliX\nREM 1 lens\nSUR 1\nSUT S\nCUY 0.02\nTHI 4\n"), {"x", "OpTaliX", ".seq", ".zmx"});
  expect_tokens(refusal("CC glasses\nNM X1 1 517642 1.517 64.2 0\nCD 2.27 0 0\n"), {"x", ".agf", "--glasses"});
  expect_tokens(refusal("const LENS_DATA = {\n  key: \"a\",\n  surfaces: [\n  ]\n};\n"),
                {"x", "LensVisualizer", "table"});
  expect_tokens(refusal("{\"spacing\": [1, 2], \"radii\": 5}"), {"x", "JSON", "\"radii\"", "\"spacing\"", ".zmx"});
}

TEST(LensFile, HugeFilesAreReadOrRefusedSoon) {
  const std::string long_line(2'000'000, 'x');
  EXPECT_LT(refusal(long_line).size(), 1000u);
  EXPECT_LT(refusal("VERS 1\nSURF 0\n" + long_line + "\n").size(), 1000u);
  std::string surfaces = "VERS 1\nMODE SEQ\n";
  for (int i = 0; i < 200'000; ++i) surfaces += "SURF " + std::to_string(i) + "\n";
  expect_tokens(refusal(surfaces), {"x", 10000, "surfaces"});
  std::string rows;
  for (int i = 0; i < 200'000; ++i) rows += "50 1 1.5 10\n";
  expect_tokens(refusal(rows), {"x", 10000, "surfaces"});
  std::string commands =
      "MODE SEQ\nUNIT MM\nSURF 0\nDISZ INFINITY\nSURF 1\nSTOP\nDISZ 5\nCURV 0.01\nDIAM 5 1\nGLAS ___BLANK 1 0 1.5 60\n";
  for (int i = 0; i < 200'000; ++i) commands += "A" + std::to_string(i) + "\n";
  const Prescription lens = petzval::testing::read(commands + "SURF 2\nDISZ 90\nSURF 3\n");
  EXPECT_EQ(lens.imported->warnings.size(), 1001u);
  expect_tokens(lens.imported->warnings.back().message, {199001});
  std::string statements = "SO 0 1e13;";
  for (int i = 0; i < 100'000; ++i) statements += "S 50 1;";
  expect_tokens(refusal(statements), {"x", 10000, "surfaces"});
}

TEST(LensFile, StrictRefusesAssumptionsExceptInTheOwnFormat) {
  const std::string table = "50.6 5.2 1.5168 25.4\n-50.6 0 1 25.4\n";
  expect_error([&] { petzval::parse_lens(table, "x", {.strict = true}); }, {"strict"});
  const Prescription lens = petzval::testing::read(table);
  EXPECT_FALSE(lens.imported->warnings.empty());
  const Prescription again = petzval::parse_lens(petzval::format_prescription(lens), "x", {.strict = false});
  EXPECT_EQ(again, lens);
}

}  // namespace lens_file_test
