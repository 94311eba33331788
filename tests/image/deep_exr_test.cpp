// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/exr.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/error.hpp"
#include "petzval/image/image.hpp"

namespace deep_exr_test {

using petzval::testing::expect_error;
using petzval::testing::expect_tokens;

using namespace petzval;

constexpr float infinity = std::numeric_limits<float>::infinity(), none = std::numeric_limits<float>::quiet_NaN();

std::filesystem::path file_named(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) /
         ("petzval_deep_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + name);
}

FragmentLists some_lists(int columns, int rows) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> number(0, 1);
  FragmentLists lists{.columns = columns, .rows = rows, .offsets = {0}, .fragments = {}};
  for (int i = 0; i < columns * rows; ++i) {
    for (int k = static_cast<int>(5 * number(engine)); k > 0; --k) {  // unsorted, some empty
      const float alpha = number(engine);
      lists.fragments.push_back({number(engine) < 0.1f ? infinity : 1e4f * number(engine) + 1e-3f, 50 * number(engine),
                                 -number(engine), 1e-30f, alpha});
    }
    lists.offsets.push_back(lists.fragments.size());
  }
  return lists;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(DeepExr, RoundTripsToTheBit) {
  const auto file = file_named("round_trip.exr");
  const FragmentLists lists = some_lists(67, 41);
  write_deep_exr(lists, file);
  const DeepPicture again = read_deep_exr(file);
  EXPECT_EQ(again.without_depth, 0u);
  EXPECT_EQ(again.lists.columns, 67);
  EXPECT_EQ(again.lists.rows, 41);
  EXPECT_EQ(again.lists.offsets, lists.offsets);
  ASSERT_EQ(again.lists.fragments.size(), lists.fragments.size());
  for (std::size_t i = 0; i < lists.fragments.size(); ++i) {
    const auto bits = [](const FragmentLists::Fragment& f) {
      return std::vector{std::bit_cast<std::uint32_t>(f.depth_mm), std::bit_cast<std::uint32_t>(f.red),
                         std::bit_cast<std::uint32_t>(f.green), std::bit_cast<std::uint32_t>(f.blue),
                         std::bit_cast<std::uint32_t>(f.alpha)};
    };
    ASSERT_EQ(bits(again.lists.fragments[i]), bits(lists.fragments[i]));
  }
  EXPECT_FLOAT_EQ(read_deep_exr(file, 1000).lists.fragments[0].depth_mm, 1000 * lists.fragments[0].depth_mm);
}

TEST(DeepExr, SkipsSamplesWithoutDepth) {
  const auto file = file_named("no_depth.exr");
  write_deep_exr({.columns = 2,
                  .rows = 1,
                  .offsets = {0, 3, 4},
                  .fragments = {{none, 1, 1, 1, 1}, {-5, 1, 1, 1, 1}, {7, 1, 2, 3, 1}, {0, 1, 1, 1, 1}}},
                 file);
  const DeepPicture picture = read_deep_exr(file);
  EXPECT_EQ(picture.without_depth, 3u);
  EXPECT_EQ(picture.lists.offsets, (std::vector<std::size_t>{0, 1, 1}));
  EXPECT_EQ(picture.lists.fragments[0].green, 2);
}

TEST(DeepExr, RefusesOtherFiles) {
  const auto flat = file_named("flat.exr");
  write_exr(RgbImage(3, 2), flat);
  expect_error([&] { read_deep_exr(flat); }, {flat, "deep"});
  const auto text = file_named("text.exr");
  write_bytes(text, "not a picture");
  expect_error([&] { read_deep_exr(text); }, {text});
  expect_error([&] { read_deep_exr(file_named("nowhere.exr")); }, {file_named("nowhere.exr"), "No such file"});
  expect_error([&] { read_deep_exr(text, 0); }, {"unit"});
  expect_error(
      [&] {
        write_deep_exr({.columns = 2, .rows = 1, .offsets = {0, 1}, .fragments = {{}}}, text);
      },
      {"offsets"});
}

TEST(DeepExr, RefusesMissingChannels) {
  const auto file = file_named("channels.exr");
  write_deep_exr(some_lists(5, 4), file);
  const std::string whole = bytes_of(file);
  // The names of channels stand in the header as text.
  const auto renamed = [&](const std::string& from, const std::string& to) {
    std::string bytes = whole;
    std::string pattern;
    pattern += '\0';
    pattern += from;
    pattern += '\0';
    pattern += '\2';
    const std::size_t at = bytes.find(pattern);
    EXPECT_NE(at, std::string::npos);
    bytes.replace(at + 1, 1, to);
    write_bytes(file, bytes);
    return petzval::testing::message([&] { read_deep_exr(file); });
  };
  expect_tokens(renamed("Z", "Q"), {"Z"});
  expect_tokens(renamed("R", "S"), {"R", "G", "B", "Y"});
}

TEST(DeepExr, RefusesTruncatedFiles) {
  const auto file = file_named("cut.exr");
  write_deep_exr(some_lists(23, 19), file);
  const std::string whole = bytes_of(file);
  for (std::size_t end = 0; end + 1 < whole.size(); end += 1 + whole.size() / 60) {
    write_bytes(file, whole.substr(0, end));
    expect_error([&] { read_deep_exr(file); }, {file});
  }
}

TEST(DeepExr, SurvivesDamage) {
  const auto file = file_named("damaged.exr");
  write_deep_exr(some_lists(13, 9), file);
  const std::string whole = bytes_of(file);
  std::mt19937 engine(2);
  int refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 1 + i % 3; ++k) bytes[engine() % bytes.size()] = static_cast<char>(engine());
    write_bytes(file, bytes);
    const std::string said = petzval::testing::message([&] { read_deep_exr(file); });
    if (said == "no error") continue;
    ++refused;
    expect_tokens(said, {file});
  }
  EXPECT_GT(refused, 100);
}

TEST(Pfm, RoundTrips) {
  const auto file = file_named("back.pfm");
  RgbImage image(5, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.37f * static_cast<float>(i) - 2;
  write_pfm(image, file);
  EXPECT_EQ(read_pfm(file).pixels, image.pixels);
  const std::vector<float> grey{1, 2, infinity, -4, 5, 6};
  write_pfm(3, 2, grey, file);
  const RgbImage back = read_pfm(file);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(back.pixels[3 * i + 2], grey[i]);
  // The opposite byte order.
  write_bytes(file, std::string("Pf\n1 1\n1.0\n") + "\x3f\x80" + std::string(2, '\0'));
  EXPECT_EQ(read_pfm(file).pixels[0], 1);
}

TEST(Pfm, RefusesDamagedFiles) {
  const auto file = file_named("bad.pfm");
  for (const char* bytes :
       {"", "P6\n1 1\n255\n", "PF\n-1 1\n-1\n", "PF\n2 2\n-1.0\nabcd", "PF\n1000000 1000000\n-1.0\n"}) {
    write_bytes(file, bytes);
    expect_error([&] { read_pfm(file); }, {file});
  }
}

TEST(Png, IsReadAsLinearLight) {
  const auto file = file_named("light.png");
  Rgb8Image shown{3, 1, {0, 128, 255, 10, 188, 64, 255, 255, 255}};
  write_png(shown, file);
  const RgbImage light = read_png(file);
  ASSERT_EQ(light.width, 3);
  EXPECT_NEAR(light.pixels[1], 0.21586, 1e-5);
  EXPECT_EQ(light.pixels[2], 1);
  EXPECT_EQ(to_srgb8(light).pixels, shown.pixels);
}

}  // namespace deep_exr_test
