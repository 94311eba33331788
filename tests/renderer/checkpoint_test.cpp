// SPDX-License-Identifier: Apache-2.0
#include "renderer/checkpoint.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "made_up_sums.hpp"

namespace {

using namespace renderer;
using examples::Json;
using petzval::testing::expect_error;
using petzval::testing::message;

constexpr int width = 40, height = 35;

class CheckpointFile : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(file_.parent_path()); }

  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / "petzval_checkpoint" /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".exr");
  const Json job_{{"lens", "a \"lens\" of glass"},        {"focus_mm", 0.1}, {"limit", nullptr},
                  {"iris", {{"blades", 7}, {"map", ""}}}, {"width", width},  {"height", height}};
  const PictureSums sums_ = made_up_part(width, height, 1, 1, 18);
};

TEST_F(CheckpointFile, KeepsAllBits) {
  Checkpoint::write(sums_, job_, file_);
  const PictureSums read = Checkpoint::read(file_, job_);
  EXPECT_EQ(read, sums_);
  EXPECT_EQ(read.mean()[0].standard_error, sums_.mean()[0].standard_error);
  const std::string bytes = examples::read_text(file_);
  Checkpoint::write(read, job_, file_);
  EXPECT_EQ(examples::read_text(file_), bytes);
}

TEST_F(CheckpointFile, KeepsLightPathsTargetsAndGuides) {
  PictureSums sums = sums_;
  sums.add(2, 3, 7, made_up_unit(sums, 2, 0), PictureSums::Of::light);
  sums.set_target(1, PictureSums::Of::film, 48);
  sums.set_guides({{"depth.Z", std::vector<float>(width * height, 3)}});
  Checkpoint::write(sums, job_, file_);
  EXPECT_EQ(Checkpoint::read(file_, job_), sums);
}

TEST_F(CheckpointFile, KeepsLargeCountsAndEmptySums) {
  Checkpoint::write(PictureSums(3, 1), job_, file_);
  EXPECT_EQ(Checkpoint::read(file_, job_), PictureSums(3, 1));
  PictureSums many(1, 1);
  many.add(0, 0, 4294967295u, std::vector<Contribution>(3, {0, {1e30f, 0, 0}}));
  Checkpoint::write(many, job_, file_);
  EXPECT_EQ(Checkpoint::read(file_, job_), many);
  EXPECT_EQ(many.rejected(), 3u);
}

TEST_F(CheckpointFile, ShowsTheSums) {
  Checkpoint::write(sums_, job_, file_);
  const petzval::RgbImage shown = petzval::read_exr(file_), picture = sums_.picture();
  ASSERT_EQ(shown.width, width);
  ASSERT_EQ(shown.height, height);
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    EXPECT_FLOAT_EQ(shown.pixels[i], picture.pixels[i] * static_cast<float>(sums_.samples(0)));
  }
}

TEST_F(CheckpointFile, RefusesAnotherJob) {
  Checkpoint::write(sums_, job_, file_);
  Json other = job_;
  other["iris"]["blades"] = 5;
  other["focus_mm"] = 0.2;
  other.erase("limit");
  other["seed"] = 3;
  expect_error([&] { Checkpoint::read(file_, other); },
               {file_, "focus_mm", 0.1, 0.2, "limit", "iris/blades", 7, 5, "seed", 3});
  Json larger = job_;
  larger["width"] = 41;
  expect_error([&] { Checkpoint::read(file_, larger); }, {file_, "width", 40, 41});
}

TEST_F(CheckpointFile, RefusesOtherAndTruncatedFiles) {
  const auto refused = [&](const std::string& bytes) {
    examples::write_text(file_, bytes);
    expect_error([&] { Checkpoint::read(file_, job_); }, {file_});
  };
  expect_error([&] { Checkpoint::read(file_.parent_path() / "none.exr", job_); }, {"none.exr"});
  refused("");
  refused("no EXR at all");
  petzval::write_exr(petzval::RgbImage(4, 4), file_);
  refused(examples::read_text(file_));
  Checkpoint::write(sums_, job_, file_);
  const std::string whole = examples::read_text(file_);
  for (std::size_t size = whole.size() - 1; size > 0; size -= std::min<std::size_t>(size, whole.size() / 23)) {
    SCOPED_TRACE(size);
    refused(whole.substr(0, size));
  }
}

/// A changed byte is refused or has no effect, because some bytes of the format are not read.
TEST_F(CheckpointFile, DetectsChangedBytes) {
  Checkpoint::write(sums_, job_, file_);
  const std::string whole = examples::read_text(file_);
  std::size_t refused = 0, flips = 0;
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 120, ++flips) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    examples::write_text(file_, bytes);
    PictureSums read(1, 1);
    const std::string text = message([&] { read = Checkpoint::read(file_, job_); });
    if (text == "no error") {
      EXPECT_EQ(read, sums_) << at;
    } else {
      EXPECT_TRUE(text.starts_with(file_.string())) << text;
      ++refused;
    }
  }
  EXPECT_GT(refused, flips * 9 / 10);
}

}  // namespace
