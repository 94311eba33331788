// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/exr.hpp"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
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
      auto& f = lists.fragments.back();
      f.back_mm = k % 3 == 0 ? 2 * f.depth_mm : f.depth_mm;
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
                         std::bit_cast<std::uint32_t>(f.green),    std::bit_cast<std::uint32_t>(f.blue),
                         std::bit_cast<std::uint32_t>(f.alpha),    std::bit_cast<std::uint32_t>(f.back_mm)};
    };
    ASSERT_EQ(bits(again.lists.fragments[i]), bits(lists.fragments[i]));
  }
  EXPECT_FLOAT_EQ(read_deep_exr(file, 1000).lists.fragments[0].depth_mm, 1000 * lists.fragments[0].depth_mm);
}

struct Part {
  std::string name;
  bool tiled = false;
  Imath::Box2i window{};
  FragmentLists lists{};
};
const Imath::Box2i display{{0, 0}, {39, 29}};
std::vector<Part> two_parts() {
  return {{"beauty", false, {{-5, 3}, {20, 17}}, some_lists(26, 15)},
          {"matte", true, {{2, -4}, {38, 25}}, some_lists(37, 30)}};
}

/// Writes parts with channels of a type: half or float.
template <class T>
void write_parts(const std::vector<Part>& parts, const std::filesystem::path& file) {
  const Imf::PixelType type = std::is_same_v<T, half> ? Imf::HALF : Imf::FLOAT;
  const char* const names[] = {"Z", "R", "G", "B", "A", "ZBack"};
  std::vector<Imf::Header> headers;
  for (const Part& part : parts) {
    Imf::Header& header = headers.emplace_back(display, part.window);
    header.setName(part.name), header.setType(part.tiled ? Imf::DEEPTILE : Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    if (part.tiled) header.setTileDescription({16, 7, Imf::ONE_LEVEL});
    for (const char* name : names) header.channels().insert(name, Imf::Channel(type));
  }
  Imf::MultiPartOutputFile out(file.string().c_str(), headers.data(), static_cast<int>(headers.size()), true, 0);
  for (int p = 0; p < out.parts(); ++p) {
    const auto& [name, tiled, window, lists] = parts[static_cast<std::size_t>(p)];
    const auto width = static_cast<std::size_t>(lists.columns);
    const std::ptrdiff_t first = -window.min.x - window.min.y * std::ptrdiff_t{lists.columns};
    std::vector<unsigned> counts;
    std::vector<T> values[6];
    std::vector<T*> begins[6];
    for (const auto& f : lists.fragments) {
      const float numbers[] = {f.depth_mm, f.red, f.green, f.blue, f.alpha, f.back_mm};
      for (std::size_t c = 0; c < 6; ++c) values[c].push_back(T(numbers[c]));
    }
    for (std::size_t i = 0; i + 1 < lists.offsets.size(); ++i) {
      counts.push_back(static_cast<unsigned>(lists.offsets[i + 1] - lists.offsets[i]));
      for (std::size_t c = 0; c < 6; ++c) begins[c].push_back(values[c].data() + lists.offsets[i]);
    }
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice({Imf::UINT, reinterpret_cast<char*>(counts.data() + first), 4, 4 * width});
    for (std::size_t c = 0; c < 6; ++c) {
      buffer.insert(names[c], Imf::DeepSlice(type, reinterpret_cast<char*>(begins[c].data() + first), sizeof(T*),
                                             sizeof(T*) * width, sizeof(T)));
    }
    if (tiled) {
      Imf::DeepTiledOutputPart part(out, p);
      part.setFrameBuffer(buffer), part.writeTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
    } else {
      Imf::DeepScanLineOutputPart part(out, p);
      part.setFrameBuffer(buffer), part.writePixels(lists.rows);
    }
  }
}

template <class T>
class DeepExrOf : public ::testing::Test {};
using Types = ::testing::Types<float, half>;
TYPED_TEST_SUITE(DeepExrOf, Types);

TYPED_TEST(DeepExrOf, ReadsPartsIntoTheDisplayWindow) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_deep_parts.exr";
  write_parts<TypeParam>(two_parts(), file);
  for (const auto& [name, tiled, window, lists] : two_parts()) {
    const DeepPicture picture = read_deep_exr(file, 1, name);
    ASSERT_EQ(picture.lists.offsets.size(), 1201u);
    std::size_t next = 0, outside = 0, volumes = 0, pixel = 0;
    for (int row = window.min.y; row <= window.max.y; ++row) {
      for (int column = window.min.x; column <= window.max.x; ++column, ++pixel) {
        const std::size_t count = lists.offsets[pixel + 1] - lists.offsets[pixel];
        if (!display.intersects(Imath::V2i(column, row))) {
          outside += count;
          continue;
        }
        ASSERT_EQ(picture.lists.offsets[static_cast<std::size_t>(row * 40 + column)], next) << name;
        for (std::size_t i = lists.offsets[pixel]; i < lists.offsets[pixel + 1]; ++i, ++next) {
          const auto &a = lists.fragments[i], &b = picture.lists.fragments.at(next);
          for (const auto value : {&FragmentLists::Fragment::depth_mm, &FragmentLists::Fragment::back_mm,
                                   &FragmentLists::Fragment::green, &FragmentLists::Fragment::alpha})
            EXPECT_EQ(b.*value, TypeParam(a.*value));
          volumes += b.back_mm > b.depth_mm;
        }
      }
    }
    EXPECT_GT(std::min(outside, volumes), 20u);
    EXPECT_EQ(picture.outside, outside);
    EXPECT_EQ(picture.volumes, volumes);
    EXPECT_EQ(picture.lists.fragments.size(), next);
  }
  EXPECT_EQ(read_deep_exr(file).outside, read_deep_exr(file, 1, "beauty").outside);
  expect_error([&] { read_deep_exr(file, 1, "depth"); }, {file, "depth", "beauty", "matte"});
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
  std::vector<std::string> files;
  write_deep_exr(some_lists(13, 9), file);
  files.push_back(bytes_of(file));
  write_parts<float>({{"tiles", true, {{0, 0}, {12, 8}}, some_lists(13, 9)}}, file);
  files.push_back(bytes_of(file));
  std::mt19937 engine(2);
  for (const std::string& whole : files) {
    int refused = 0;
    for (int i = 0; i < 750; ++i) {
      std::string bytes = whole;
      for (int k = 0; k < 1 + i % 3; ++k) bytes[engine() % bytes.size()] = static_cast<char>(engine());
      write_bytes(file, bytes);
      const std::string said = petzval::testing::message([&] { read_deep_exr(file); });
      if (said == "no error") continue;
      ++refused;
      expect_tokens(said, {file});
    }
    EXPECT_GT(refused, 50);
  }
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
