// SPDX-License-Identifier: Apache-2.0
#include "renderer/outputs.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "made_up_sums.hpp"

namespace {

using namespace renderer;
using examples::Json;

TEST(Outputs, ImagesOfAllFormatsAreEqual) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "petzval_outputs";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  PictureSums sums = made_up_part(3, 2, 1, 1, 5);
  sums.set_guides({{"depth.Z", {1, 2, 3, 4, 5, 6}}});
  const petzval::RgbImage picture = sums.picture();
  const auto files = write_pictures(sums, {{"lens", "a lens"}}, {{"f_number", 2.8}}, {"pfm", "exr"}, folder);
  EXPECT_EQ(files, (std::vector{folder / "picture.pfm", folder / "picture.exr"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "picture.png"));
  EXPECT_EQ(petzval::read_exr(folder / "picture.exr").pixels, picture.pixels);
  const auto parts = petzval::read_exr_parts(folder / "picture.exr");
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].texts.at("lens"), "a lens");
  EXPECT_EQ(parts[0].numbers.at("f_number"), 2.8);
  EXPECT_EQ(parts[0].channels.at("depth.Z"), sums.guides().at("depth.Z"));
  EXPECT_EQ(examples::read_text(folder / "picture.pfm").substr(0, 12), "PF\n3 2\n-1.0\n");
  write_pictures(sums, {}, {}, {"png"}, folder);
  petzval::write_png(petzval::to_srgb8(picture), folder / "wanted.png");
  EXPECT_EQ(petzval::read_png(folder / "picture.png").pixels, petzval::read_png(folder / "wanted.png").pixels);
}

TEST(Outputs, StatisticsEqualTheSums) {
  const PictureSums sums = made_up_part(40, 20, 1, 1, 5);
  const Json json = statistics(sums);
  EXPECT_EQ(json["samples"], 15);
  EXPECT_EQ(json["rejected"], 0);
  ASSERT_EQ(json["mean_radiance"].size(), 3u);
  EXPECT_EQ(json["mean_radiance"][2]["mean"], sums.mean()[2].mean);
  EXPECT_EQ(json["mean_radiance"][2]["standard_error"], sums.mean()[2].standard_error);
  const Json& tiles = json["tiles"];
  EXPECT_EQ(tiles["rows"], 2);
  EXPECT_EQ(tiles["columns"], 3);
  for (const char* key : {"mean", "standard_error"}) {
    ASSERT_EQ(tiles[key].size(), 2u);
    ASSERT_EQ(tiles[key][1].size(), 3u);
  }
  EXPECT_EQ(tiles["mean"][1][0], sums.luminance(3).mean);
  EXPECT_EQ(tiles["standard_error"][0][2], sums.luminance(2).standard_error);
}

TEST(Outputs, UnknownValuesAreNull) {
  PictureSums sums(32, 16);
  sums.add(1, 0, 6, {});
  const Json json = statistics(sums);
  EXPECT_EQ(json["samples"], 3) << "half of the pixels have 6";
  EXPECT_TRUE(json["mean_radiance"][0]["standard_error"].is_null());
  EXPECT_TRUE(json["tiles"]["standard_error"][0][0].is_null());
}

}  // namespace
