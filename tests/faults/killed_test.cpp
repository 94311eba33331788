// SPDX-License-Identifier: Apache-2.0
// Processes that are killed while they write.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <string>
#include <thread>

#include "petzval/core/error.hpp"
#include "writers.hpp"

namespace petzval {
namespace killed_test {

namespace fs = std::filesystem;
using testing::bytes_of;

/// An image of one colour: 300 KB as EXR before compression.
RgbImage picture(float value) {
  RgbImage image(160, 160);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = value + static_cast<float>(i * i % 977);
  return image;
}

TEST(Killed, WriterLeavesTheOldOrTheNewFile) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("petzval_killed_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path file = folder / "a.exr";
  const RgbImage one = picture(1), other = picture(2);
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  write_exr(one, file);
  const std::string ones = bytes_of(file);
  write_exr(other, file);
  const auto both = Clock::now() - start;
  const std::string others = bytes_of(file);

  std::mt19937 random(1);
  int found_ones = 0, left_behind = 0;
  for (int round = 0; round < 60; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      for (;;) write_exr(one, file), write_exr(other, file);
    }
    std::this_thread::sleep_for(both * (random() % 1000) / 250);  // up to four times the duration of both writes
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the process ended before the signal";

    const std::string found = bytes_of(file);
    ASSERT_TRUE(found == ones || found == others) << "round " << round << ": " << found.size() << " bytes";
    found_ones += found == ones;
    // Leftover files have the name that write_file() states, and do not disturb later writes.
    const std::string own = ".petzval-" + std::to_string(child) + '-';
    for (const std::string& name : testing::names_in(folder)) {
      if (name == "a.exr") continue;
      ASSERT_TRUE(name.starts_with(own)) << name;
      fs::remove(folder / name);
      ++left_behind;
    }
  }
  EXPECT_GT(found_ones, 0);
  EXPECT_LT(found_ones, 60);
  EXPECT_GT(left_behind, 0) << "no process was killed during a write";
  fs::remove_all(folder);
}

}  // namespace killed_test
}  // namespace petzval
