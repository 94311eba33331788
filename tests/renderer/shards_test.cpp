// SPDX-License-Identifier: Apache-2.0
#include "renderer/shards.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "made_up_sums.hpp"
#include "renderer/checkpoint.hpp"

namespace {

using namespace renderer;
using examples::Json;
using examples::Shard;
using petzval::testing::expect_tokens;
using petzval::testing::message;

constexpr int width = 40, height = 35;
constexpr std::uint32_t passes = 4;

class Shards : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    for (const auto& folder : {here_, there_}) std::filesystem::create_directories(folder);
  }

  void write(const std::filesystem::path& folder, const Shard& shard, std::uint32_t done = passes) const {
    Checkpoint::write(made_up_part(width, height, shard.index, shard.count, done), job_,
                      checkpoint_file(folder, shard));
  }
  std::string refusal(const std::vector<std::filesystem::path>& folders) const {
    return message([&] {
      Json job;
      gather(folders, job);
    });
  }

  const std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "petzval_shards" /
                                        testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::filesystem::path here_ = folder_ / "here", there_ = folder_ / "there";
  Json job_{{"lens", "a lens"}, {"samples", 3 * passes}};
};

TEST_F(Shards, MergeToEqualBits) {
  const PictureSums whole = made_up_part(width, height, 1, 1, passes);
  for (const std::size_t count : {1u, 3u, 11u}) {  // 9 tiles leave two of 11 shards empty
    SetUp();
    for (std::size_t i = 1; i <= count; ++i) write(i % 2 > 0 ? here_ : there_, {i, count});
    write(there_, {1, count});
    Json job;
    EXPECT_EQ(gather({here_, there_}, job), whole) << count;
    EXPECT_EQ(job, job_);
  }
}

TEST_F(Shards, KeepTheirFilesByName) {
  EXPECT_EQ(checkpoint_file("out", {}), "out/sums.exr");
  EXPECT_EQ(checkpoint_file("out", {2, 8}), "out/tile_2_of_8.exr");
  for (const Shard& shard : {Shard{2, 3}, Shard{3, 3}, Shard{1, 3}}) write(here_, shard);
  for (const char* other :
       {"tile_1_of_2.png", "tile_4_of_3.exr", "tile_1_of_x.exr", "tile_1_of_2.5.exr", "picture.exr"}) {
    examples::write_text(here_ / other, "no checkpoint");
  }
  Json job;
  EXPECT_NO_THROW(gather({here_}, job));
}

TEST_F(Shards, MissingAndUnfinishedShardsAreNamed) {
  write(here_, {2, 5});
  write(there_, {3, 5}, passes - 1);
  write(there_, {5, 5});
  expect_tokens(refusal({here_, there_}),
                {here_, there_, "shard 1/5", "shard 3/5", there_ / "tile_3_of_5.exr", 2, "shard 4/5"});
  expect_tokens(refusal({folder_}), {folder_, "shard"});
  expect_tokens(refusal({folder_ / "nowhere"}), {folder_ / "nowhere"});
}

TEST_F(Shards, TimedImagesHaveAtLeastOnePass) {
  job_["samples"] = nullptr;
  write(here_, {1, 2}, 1);
  write(here_, {2, 2}, 3);
  Json job;
  EXPECT_EQ(gather({here_}, job).samples(1), 9u);
  write(here_, {2, 2}, 0);
  expect_tokens(refusal({here_}), {"tile_2_of_2.exr", 4});
}

TEST_F(Shards, OtherImagesAreRefused) {
  write(here_, {1, 3});
  write(here_, {3, 3});
  job_["lens"] = "another lens";
  write(here_, {2, 3});
  expect_tokens(refusal({here_}), {here_, "shard 2/3", here_ / "tile_2_of_3.exr", "lens", "\"another lens\""});
  write(there_, {1, 2});
  const std::string both = refusal({here_, there_});
  expect_tokens(both, {"tile_1_of_2.exr"});
}

TEST_F(Shards, DifferentAndCorruptShardsAreRefused) {
  write(here_, {1, 2});
  write(here_, {2, 2});
  PictureSums other = made_up_part(width, height, 2, 2, passes);
  other.add(1, 0, 1, {});
  Checkpoint::write(other, job_, checkpoint_file(there_, {2, 2}));
  expect_tokens(refusal({here_, there_}), {"differ"});
  std::filesystem::rename(here_ / "tile_1_of_2.exr", here_ / "tile_2_of_2.exr");
  expect_tokens(refusal({here_}), {"tile_2_of_2.exr", "tile", 0});
  const std::string bytes = examples::read_text(there_ / "tile_2_of_2.exr");
  examples::write_text(there_ / "tile_2_of_2.exr", bytes.substr(0, bytes.size() / 2));
  expect_tokens(refusal({there_}), {"shard 2/2", there_});
}

}  // namespace
