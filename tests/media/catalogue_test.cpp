// SPDX-License-Identifier: Apache-2.0
#include "petzval/media/glass.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "../message.hpp"

namespace {

namespace fs = std::filesystem;
using petzval::GlassCatalogue;
using petzval::testing::message;

const std::string header = "catalogue,name,nd,vd,formula,wl_min_um,wl_max_um,coefficients,origin\n";
const std::string row = "mine,X1,1.5,60,cauchy,0.4,0.7,1.49 0.0035 -2,me\n";

class TableFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::path(::testing::TempDir()) / (std::string("petzval_") + test->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }

  /// The message of loading one table, without the name of the folder.
  std::string refusal(const std::string& text) const {
    write("glass_a.csv", text);
    const std::string all = message([&] { GlassCatalogue::load(folder); });
    const std::string prefix = (folder / "glass_a.csv").string();
    return all.starts_with(prefix) ? all.substr(prefix.size()) : all;
  }

  fs::path folder;
};

TEST(GlassCatalogue, FindsByNameAndCatalogueWhateverTheCase) {
  const auto glasses = GlassCatalogue::load(fs::path(PETZVAL_TEST_DATA) / "glass");
  const auto* glass = glasses.find("n-bk7", "SCHOTT");
  ASSERT_NE(glass, nullptr);
  EXPECT_EQ(glass->name, "N-BK7");
  EXPECT_EQ(glass->catalogue, "schott");
  EXPECT_EQ(glasses.find("N-BK7", "hoya"), nullptr);
  EXPECT_EQ(glasses.find("N-BK", "schott"), nullptr);
  EXPECT_EQ(glasses.find("N-BK77", "schott"), nullptr);
  EXPECT_EQ(glasses.find("", "schott"), nullptr);
}

TEST(GlassCatalogue, TakesTheGlassWithTheNearestIndexWhereOnlyTheNameIsKnown) {
  const auto glasses = GlassCatalogue::load(fs::path(PETZVAL_TEST_DATA) / "glass");
  ASSERT_NE(glasses.find("F2", 1.62004), nullptr);
  EXPECT_NEAR(glasses.find("F2", 1.62004)->nd, 1.62004, 1e-5);
  EXPECT_EQ(glasses.find("f2", 1.6129)->catalogue, "cdgm");
  EXPECT_EQ(glasses.find("F2", 1.5), nullptr);
  EXPECT_EQ(glasses.find("F2", 1.631), nullptr);
  EXPECT_EQ(glasses.find("NO SUCH GLASS", 1.5), nullptr);
}

TEST(GlassCatalogue, IsEmptyWithoutATable) {
  EXPECT_EQ(GlassCatalogue().find("N-BK7", "schott"), nullptr);
  EXPECT_EQ(GlassCatalogue().find("N-BK7", 1.5168), nullptr);
}

TEST(GlassCatalogue, EveryGlassOfTheDataIsFoundUnderItsOwnName) {
  const auto glasses = GlassCatalogue::load(fs::path(PETZVAL_TEST_DATA) / "glass");
  for (const auto& glass : glasses.glasses()) {
    EXPECT_EQ(glasses.find(glass.name, glass.catalogue), &glass) << glass.catalogue << ' ' << glass.name;
    const auto* by_index = glasses.find(glass.name, glass.nd);
    ASSERT_NE(by_index, nullptr);
    EXPECT_EQ(by_index->nd, glass.nd) << glass.name;
  }
}

TEST(DataDirectory, HoldsLensesAndGlass) {
  const auto data = petzval::data_directory();
  EXPECT_TRUE(fs::exists(data / "glass" / "glass_schott.csv"));
  EXPECT_TRUE(fs::exists(data / "lenses" / "double_gauss_100mm_f1.35.json"));
}

TEST_F(TableFolder, LineEndsOfAnyKindReadTheSame) {
  write("glass_unix.csv", header + row + "mine,X2,1.6,40,buchdahl,0.4,0.7,1.6 -0.05 0.01,me");
  std::string dos = header + row;
  for (std::size_t i = 0; (i = dos.find('\n', i)) != std::string::npos; i += 2) dos.replace(i, 1, "\r\n");
  dos.replace(dos.find("mine,X1"), 7, "mine,X3");
  write("glass_dos.csv", dos);
  write("readme.csv", "not a table");
  const auto glasses = GlassCatalogue::load(folder);
  ASSERT_EQ(glasses.glasses().size(), 3u);
  ASSERT_NE(glasses.find("X3", "mine"), nullptr);
  EXPECT_EQ(glasses.find("X3", "mine")->coefficients, glasses.find("X1", "mine")->coefficients);
  EXPECT_EQ(glasses.find("X2", "mine")->formula, petzval::DispersionFormula::buchdahl);
}

TEST_F(TableFolder, ABadTableIsRefusedWithFileLineAndReason) {
  EXPECT_EQ(refusal(""), ": line 1: header is \"\", wanted " + header.substr(0, header.size() - 1));
  EXPECT_EQ(refusal("name,nd\n"), ": line 1: header is \"name,nd\", wanted " + header.substr(0, header.size() - 1));
  EXPECT_EQ(refusal(header + row + "mine,X2,1.5\n"),
            ": line 3: 3 columns, wanted 9: " + header.substr(0, header.size() - 1));
  EXPECT_EQ(refusal(header + "\n"), ": line 2: 1 columns, wanted 9: " + header.substr(0, header.size() - 1));
  EXPECT_EQ(refusal(header + "mine,X1,1;5,60,cauchy,0.4,0.7,1.5,me\n"),
            ": line 2: nd is \"1;5\", wanted a finite number");
  EXPECT_EQ(refusal(header + "mine,X1,nan,60,cauchy,0.4,0.7,1.5,me\n"),
            ": line 2: nd is \"nan\", wanted a finite number");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,1e400,cauchy,0.4,0.7,1.5,me\n"),
            ": line 2: vd is \"1e400\", wanted a finite number");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,60,magic,0.4,0.7,1.5,me\n"),
            ": line 2: formula is \"magic\", wanted sellmeier, sellmeier_squared, polynomial, cauchy or buchdahl");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,60,cauchy,0.7,0.4,1.5,me\n"),
            ": line 2: range is 0.7 to 0.4 um, wanted two increasing positive numbers");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,60,cauchy,0,0.4,1.5,me\n"),
            ": line 2: range is 0 to 0.4 um, wanted two increasing positive numbers");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,60,cauchy,0.4,0.7,1.5 0.1,me\n"),
            ": line 2: 2 coefficients, wanted c0 and pairs");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,60,buchdahl,0.4,0.7,1.5,me\n"), ": line 2: 1 coefficients, wanted 3");
  EXPECT_EQ(refusal(header + "mine,X1,1.5,60,cauchy,0.4,0.7,1.5  0.1 2,me\n"),
            ": line 2: coefficient is \"\", wanted a finite number");
  EXPECT_EQ(refusal(header + ",X1,1.5,60,cauchy,0.4,0.7,1.5,me\n"),
            ": line 2: catalogue or name is empty, wanted both");
  EXPECT_EQ(refusal(header + row), "no error");
}

TEST_F(TableFolder, AFolderWithoutTablesIsRefused) {
  EXPECT_EQ(message([&] { GlassCatalogue::load(folder); }),
            folder.string() + ": no file glass_*.csv, wanted at least one");
  EXPECT_EQ(message([&] { GlassCatalogue::load(folder / "absent"); }),
            (folder / "absent").string() + ": No such file or directory, wanted a folder of glass tables");
}

}  // namespace
