// SPDX-License-Identifier: Apache-2.0
#include "petzval/glass/glass.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "../expect_error.hpp"
#include "../message.hpp"

namespace catalogue_test {

namespace fs = std::filesystem;
using petzval::Glass;
using petzval::GlassCatalogue;
using petzval::testing::expect_error;
using petzval::testing::expect_tokens;
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

  /// The error message for one table, without the name of the folder.
  std::string refusal(const std::string& text) const {
    write("glass_a.csv", text);
    const std::string all = message([&] { GlassCatalogue::load(folder); });
    const std::string prefix = (folder / "glass_a.csv").string();
    return all.starts_with(prefix) ? all.substr(prefix.size()) : all;
  }

  fs::path folder;
};

TEST(GlassCatalogue, FindsByNameAndCatalogueInAnyCase) {
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

TEST(GlassCatalogue, NameWithoutCatalogueFindsTheNearestIndex) {
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

Glass named(const std::string& catalogue, const std::string& name, double nd, double vd = 60) {
  Glass glass;
  glass.catalogue = catalogue;
  glass.name = name;
  glass.nd = nd;
  glass.vd = vd;
  return glass;
}

TEST(GlassCatalogue, AddedGlassPrecedesOthersOfItsName) {
  const GlassCatalogue tables({named("schott", "F2", 1.62004), named("cdgm", "F2", 1.61293), named("a", "K", 1.5)});
  const auto more = with_glasses(tables, {named("Schott", "f2", 1.62), named("mine", "F2", 1.6205)});
  EXPECT_EQ(tables.glasses().size(), 3u);
  ASSERT_EQ(more.glasses().size(), 5u);
  EXPECT_EQ(more.find("F2", "schott")->nd, 1.62);
  EXPECT_EQ(more.find("F2", "MINE")->nd, 1.6205);
  EXPECT_EQ(more.find("F2", "cdgm")->nd, 1.61293);
  EXPECT_EQ(more.find("K", "a")->nd, 1.5);
  // Search by index: an added glass within the tolerance for moulding, otherwise the nearest glass of all.
  EXPECT_EQ(more.find("F2", 1.62004)->nd, 1.62);
  EXPECT_EQ(more.find("F2", 1.6204)->nd, 1.6205);
  EXPECT_EQ(more.find("F2", 1.613)->nd, 1.61293);
  EXPECT_EQ(with_glasses(GlassCatalogue(), {named("mine", "F2", 1.62)}).find("F2", 1.613)->nd, 1.62);
}

TEST(GlassCatalogue, NameAlone_TakesTheNewestCatalogue) {
  const GlassCatalogue tables({named("a-1983", "K", 1.51), named("b-legacy", "K", 1.52), named("c", "K", 1.53),
                               named("d", "K", 1.53009), named("a-1983", "L", 1.61), named("b-legacy", "L", 1.62),
                               named("a-1983", "M", 1.7), named("c", "N", 1.5), named("d", "N", 1.5002)});
  EXPECT_EQ(tables.find("k")->catalogue, "c");
  EXPECT_EQ(tables.find("L")->catalogue, "b-legacy");
  EXPECT_EQ(tables.find("M")->catalogue, "a-1983");
  EXPECT_EQ(tables.find("X"), nullptr);
  expect_error([&] { tables.find("N"); }, {"\"N\"", "c", 1.5, "d", 1.5002});
  const auto more = with_glasses(tables, {named("mine", "N", 1.6)});
  EXPECT_EQ(more.find("N")->catalogue, "mine");
}

TEST(GlassTables, AreLoadedOnce) {
  const GlassCatalogue& tables = petzval::glass_tables();
  EXPECT_EQ(&tables, &petzval::glass_tables());
  EXPECT_EQ(tables.glasses().size(), GlassCatalogue::load(fs::path(PETZVAL_TEST_DATA) / "glass").glasses().size());
  EXPECT_EQ(tables.find("N-BK7")->catalogue, "schott");
  EXPECT_EQ(tables.find("BK7")->catalogue, "schott-legacy");
}

TEST(GlassCatalogue, LastAddedIsFoundFirst) {
  const auto first = with_glasses(GlassCatalogue(), {named("mine", "X", 1.5), named("mine", "A", 1.4)});
  const auto second = with_glasses(first, {named("mine", "X", 1.6), named("mine", "Z", 1.7)});
  EXPECT_EQ(second.find("x", "mine")->nd, 1.6);
  EXPECT_EQ(second.find("a", "mine")->nd, 1.4);
  EXPECT_EQ(second.find("z", "mine")->nd, 1.7);
  EXPECT_EQ(second.find("x", 1.5)->nd, 1.5);
  EXPECT_EQ(second.glasses().size(), 4u);
}

TEST(GlassCatalogue, NamesTheGlassesNearestByIndexAndAbbeNumber) {
  const GlassCatalogue glasses(
      {named("a", "A", 1.5, 60), named("a", "B", 1.501, 60), named("a", "C", 1.5, 61), named("a", "D", 1.5, 60)});
  const auto names = [&](double nd, std::optional<double> vd, std::size_t count) {
    std::string all;
    for (const Glass* glass : nearest_glasses(glasses, nd, vd, count)) all += glass->name;
    return all;
  };
  EXPECT_EQ(names(1.5, 60, 9), "ADBC");
  EXPECT_EQ(names(1.5, 60, 1), "A");
  EXPECT_EQ(names(1.5, 60, 0), "");
  EXPECT_EQ(names(1.5, 61, 2), "CA");
  EXPECT_EQ(names(1.501, std::nullopt, 1), "B");
  expect_error([&] { names(std::nan(""), 60, 1); }, {"glasses", "n_d", "nan", "V_d", 60});
  expect_error([&] { names(1.5, INFINITY, 1); }, {"glasses", "n_d", 1.5, "V_d", "inf"});
  EXPECT_TRUE(nearest_glasses(GlassCatalogue(), 1.5, 60, 3).empty());
}

TEST_F(TableFolder, LineEndsAreIrrelevant) {
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

TEST_F(TableFolder, BadTableIsRefusedWithFileLineAndReason) {
  expect_tokens(refusal(""), {"line 1", "header", "\"\""});
  expect_tokens(refusal("name,nd\n"), {"line 1", "header", "\"name,nd\""});
  expect_tokens(refusal(header + row + "mine,X2,1.5\n"), {"line 3", "3 columns"});
  expect_tokens(refusal(header + "\n"), {"line 2", "1 columns"});
  expect_tokens(refusal(header + "mine,X1,1;5,60,cauchy,0.4,0.7,1.5,me\n"), {"line 2", "nd", "\"1;5\""});
  expect_tokens(refusal(header + "mine,X1,nan,60,cauchy,0.4,0.7,1.5,me\n"), {"line 2", "nd", "\"nan\""});
  expect_tokens(refusal(header + "mine,X1,1.5,1e400,cauchy,0.4,0.7,1.5,me\n"), {"line 2", "vd", "\"1e400\""});
  expect_tokens(refusal(header + "mine,X1,1.5,60,magic,0.4,0.7,1.5,me\n"), {"line 2", "formula", "\"magic\""});
  expect_tokens(refusal(header + "mine,X1,1.5,60,cauchy,0.7,0.4,1.5,me\n"), {"line 2", "range", 0.7, 0.4});
  expect_tokens(refusal(header + "mine,X1,1.5,60,cauchy,0,0.4,1.5,me\n"), {"line 2", "range", 0, 0.4});
  expect_tokens(refusal(header + "mine,X1,1.5,60,cauchy,0.4,0.7,1.5 0.1,me\n"), {"line 2", "2 coefficients"});
  expect_tokens(refusal(header + "mine,X1,1.5,60,buchdahl,0.4,0.7,1.5,me\n"), {"line 2", "1 coefficients"});
  expect_tokens(refusal(header + "mine,X1,1.5,60,cauchy,0.4,0.7,1.5  0.1 2,me\n"), {"line 2", "coefficient", "\"\""});
  for (const char* table :
       {"0.5 1.5 0.4 1.6 0.7 1.5", "0.4 1.6 0.4 1.5 0.7 1.5", "0.41 1.6 0.7 1.5", "0.4 1.6 0.69 1.5"}) {
    expect_tokens(refusal(header + "mine,X1,1.5,60,tabulated,0.4,0.7," + table + ",me\n"), {"line 2"});
  }
  expect_tokens(refusal(header + ",X1,1.5,60,cauchy,0.4,0.7,1.5,me\n"), {"line 2", "catalogue"});
  EXPECT_EQ(refusal(header + row), "no error");
}

TEST_F(TableFolder, FolderWithoutTablesIsRefused) {
  expect_error([&] { GlassCatalogue::load(folder); }, {folder, "file", "glass_*.csv"});
  expect_error([&] { GlassCatalogue::load(folder / "absent"); }, {folder / "absent", "No such file"});
}

TEST_F(TableFolder, FolderWithTheNameOfATableIsRefused) {
  fs::create_directory(folder / "glass_x.csv");
  expect_error([&] { GlassCatalogue::load(folder); }, {folder / "glass_x.csv", "folder"});
}

}  // namespace catalogue_test
