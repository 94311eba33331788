// SPDX-License-Identifier: Apache-2.0
// Image headers that claim more data than the file holds are refused before memory is allocated.
#include "image/file_capacity.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "../expect_error.hpp"
#include "../png_checksums.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"

namespace petzval {
namespace file_capacity_test {

using testing::expect_error;

std::filesystem::path file_named(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / ("petzval_room_" + name);
}
std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// An EXR file whose data window starts at 0 and has this width.
std::string with_width(std::string exr, std::uint32_t width) {
  const std::string key = "dataWindow";
  const std::size_t most_x =
      exr.find(key) + key.size() + 1 + 6 + 4 + 8;  // after its type, "box2i", the size and two numbers
  for (std::size_t i = 0; i < 4; ++i) exr[most_x + i] = static_cast<char>((width - 1) >> (8 * i) & 255);
  return exr;
}

TEST(FileRoom, IsTheSizeOfTheFileOrAMillionNumbers) {
  const auto file = file_named("thousand");
  write_bytes(file, std::string(1000, 'x'));
  EXPECT_TRUE(image_detail::fits_in_file(1 << 20, 1, file));
  EXPECT_FALSE(image_detail::fits_in_file((1 << 20) + 1, 1, file));
  EXPECT_TRUE(image_detail::fits_in_file(2'000'000, 2000, file));
  EXPECT_FALSE(image_detail::fits_in_file(2'000'001, 2000, file));
  EXPECT_TRUE(image_detail::fits_in_file(2'000'001, 1, "/nowhere/at/all"));
  std::filesystem::remove(file);
}

TEST(FileRoom, IsCheckedByEveryImageReader) {
  const auto file = file_named("flat.exr"), deep = file_named("deep.exr"), png = file_named("x.png"),
             pfm = file_named("x.pfm");
  write_exr(RgbImage(3, 2), file);
  write_bytes(file, with_width(bytes_of(file), 10'000'000));
  expect_error([&] { read_exr(file); }, {file, 60000000});

  // OpenEXR reads 16 bytes in any case and takes the following bytes for the next attribute.
  write_exr(RgbImage(3, 2), file);
  std::string longer = bytes_of(file);
  longer[longer.find("box2i") + 6] = 17;
  write_bytes(file, longer);
  expect_error([&] { read_exr(file); }, {file, "box2i", 17});

  write_deep_exr({.columns = 1, .rows = 1, .offsets = {0, 1}, .fragments = {{.depth_mm = 5}}}, deep);
  write_bytes(deep, with_width(bytes_of(deep), 10'000'000));
  expect_error([&] { read_deep_exr(deep); }, {deep, 10000000, 1});

  // Likewise for the samples. The only row consists of its number, three sizes and the table of counts.
  write_deep_exr({.columns = 1, .rows = 1, .offsets = {0, 1}, .fragments = {{.depth_mm = 5}}}, deep);
  std::string counted = bytes_of(deep);
  std::uint64_t place = 0, size = 0;
  for (std::size_t at = 0; place != at + 7; ++at) std::memcpy(&place, &counted.at(at), 8);
  const std::uint32_t count = 2'000'000;
  size = 20ull * count;
  std::memcpy(&counted.at(place + 20), &size, 8);
  std::memcpy(&counted.at(place + 28), &count, 4);
  write_bytes(deep, counted);
  expect_error([&] { read_deep_exr(deep); }, {deep, 2000000, 0});

  // Sizes beyond any file are refused first.
  write_deep_exr({.columns = 1, .rows = 1, .offsets = {0, 1}, .fragments = {{.depth_mm = 5}}}, deep);
  write_bytes(deep, with_width(bytes_of(deep), 1 << 28));
  expect_error([&] { read_deep_exr(deep); }, {268435456, 1});
  write_exr(RgbImage(3, 2), file);
  write_bytes(file, with_width(bytes_of(file), 1 << 28));
  expect_error([&] { read_exr(file); }, {268435456, 2, 3, "channels"});

  write_png({3, 1, {0, 128, 255, 10, 188, 64, 255, 255, 255}}, png);
  std::string bytes = bytes_of(png);
  bytes[18] = bytes[22] = 0x1f;  // width and height
  write_bytes(png, testing::with_checksums(bytes));
  expect_error([&] { read_png(png); }, {png});

  write_bytes(pfm, "PF\n8000 8000\n-1.0\nabcd");
  expect_error([&] { read_pfm(pfm); }, {pfm});
  for (const auto& written : {file, deep, png, pfm}) std::filesystem::remove(written);
}

}  // namespace file_capacity_test
}  // namespace petzval
