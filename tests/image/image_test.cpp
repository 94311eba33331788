// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/image.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "../expect_error.hpp"
#include "../message.hpp"

namespace petzval {
namespace image_test {

using testing::expect_error;
using testing::message;

/// A temporary folder for the test.
class ImageFiles : public ::testing::Test {
 protected:
  ImageFiles() : folder_(std::filesystem::path(::testing::TempDir()) / ("petzval_image_" + std::string(test_name()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ImageFiles() override { std::filesystem::remove_all(folder_); }

  static const char* test_name() { return ::testing::UnitTest::GetInstance()->current_test_info()->name(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::filesystem::path folder_;
};

RgbImage random_floats(int width, int height) {
  RgbImage image(width, height);
  std::mt19937 random(7);
  for (float& value : image.pixels) {
    do value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    while (std::isnan(value));
  }
  image.pixels[0] = -0.0f;
  image.pixels[1] = std::numeric_limits<float>::denorm_min();
  image.pixels[2] = std::numeric_limits<float>::infinity();
  return image;
}

TEST_F(ImageFiles, ExrKeepsEveryBitOfEveryFloat) {
  const auto file = folder_ / "a.exr";
  for (const auto& [width, height] : {std::pair{1, 1}, {37, 5}, {5, 37}, {130, 67}}) {
    const RgbImage image = random_floats(width, height);
    write_exr(image, file);
    const RgbImage back = read_exr(file);
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.height, height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(back.pixels[i]), std::bit_cast<std::uint32_t>(image.pixels[i])) << i;
    }
  }
  EXPECT_EQ(files(), 1u);
}

/// Two parts of different sizes with channels in the order of their names.
std::vector<ExrPart> two_parts() {
  const auto values = [](int count, int seed) {
    std::vector<float> all = random_floats(count, 1).pixels;
    std::rotate(all.begin(), all.begin() + seed, all.end());
    all.resize(static_cast<std::size_t>(count));
    return all;
  };
  return {{"first", 7, 3, {{"S0.475nm", values(21, 1)}, {"Y", values(21, 2)}}, {{"units", "1/mm²"}}, {}},
          {"second", 2, 40, {{"Z", values(80, 3)}}, {{"empty", ""}}, {{"field_deg", 0.1}, {"distance_mm", HUGE_VAL}}}};
}

TEST_F(ImageFiles, ExrPartsRoundTripToTheBit) {
  const auto same = [](const std::vector<float>& a, const std::vector<float>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float x, float y) {
      return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
    });
  };
  const auto file = folder_ / "a.exr";
  for (const std::size_t count : {1u, 2u}) {
    const std::vector<ExrPart> parts = two_parts();
    write_exr(std::span(parts).first(count), file);
    const std::vector<ExrPart> back = read_exr_parts(file);
    ASSERT_EQ(back.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(back[i].name, parts[i].name);
      EXPECT_EQ(back[i].width, parts[i].width);
      EXPECT_EQ(back[i].height, parts[i].height);
      EXPECT_EQ(back[i].texts, parts[i].texts);
      EXPECT_EQ(back[i].numbers, parts[i].numbers);
      ASSERT_EQ(back[i].channels.size(), parts[i].channels.size());
      for (const auto& [name, values] : parts[i].channels) {
        ASSERT_TRUE(back[i].channels.contains(name));
        EXPECT_TRUE(same(back[i].channels.at(name), values)) << i << ' ' << name;
      }
    }
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(ImageFiles, ExrDisplayWindowIsReadWithItsOwnPixels) {
  const auto file = folder_ / "a.exr";
  // A data window that ends 2 pixels beyond the display window on the left and right, and 1 above and below.
  ExrPart part{.width = 9, .height = 5, .margin_x = 2, .margin_y = 1};
  for (int i = 0; i < 45; ++i) part.channels["Z"].push_back(static_cast<float>(i));
  write_exr({&part, 1}, file);
  const ExrPart inner = read_exr_parts(file, ExrWindow::display)[0];
  ASSERT_EQ(std::pair(inner.width, inner.height), std::pair(5, 3));
  EXPECT_EQ(inner.channels.at("Z"), (std::vector<float>{11, 12, 13, 14, 15, 20, 21, 22, 23, 24, 29, 30, 31, 32, 33}));
  // A smaller part in the display window of a larger one.
  ExrPart small{.name = "small", .width = 2, .height = 1, .channels = {{"Z", {7, 8}}}};
  const std::array parts{ExrPart{.name = "large", .width = 3, .height = 2, .channels = {{"Z", {1, 2, 3, 4, 5, 6}}}},
                         small};
  write_exr(parts, file);
  EXPECT_EQ(read_exr_parts(file, ExrWindow::display)[1].channels.at("Z"), (std::vector<float>{7, 8, 0, 0, 0, 0}));
}

TEST_F(ImageFiles, ExrKeepsMarginsPairsAndStandardFloats) {
  const auto file = folder_ / "a.exr";
  std::vector<ExrPart> parts = two_parts();
  parts[0].margin_x = 2, parts[0].margin_y = 1;
  parts[0].pairs["size"] = {0.1f, -2};
  parts[0].numbers["aperture"] = 2.8;
  for (const std::size_t count : {1u, 2u}) {
    write_exr(std::span(parts).first(count), file);
    const std::vector<ExrPart> back = read_exr_parts(file);
    // Next to a taller part the first part is not centred in the display window.
    EXPECT_EQ(back[0].margin_x, count == 1 ? 2 : 0);
    EXPECT_EQ(back[0].margin_y, count == 1 ? 1 : 0);
    EXPECT_EQ(back[0].pairs, parts[0].pairs);
    EXPECT_EQ(back[0].numbers.at("aperture"), double{2.8f});
    EXPECT_EQ(back[0].channels, parts[0].channels);
  }
}

TEST_F(ImageFiles, RgbIsReadFromTheFirstPart) {
  const auto file = folder_ / "a.exr";
  std::vector<ExrPart> parts = two_parts();
  parts[0].channels = {{"B", {3, 6}}, {"G", {2, 5}}, {"R", {1, 4}}, {"A", {7, 8}}};
  parts[0].width = 2, parts[0].height = 1;
  write_exr(parts, file);
  EXPECT_EQ(read_exr(file).pixels, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  std::swap(parts[0], parts[1]);
  write_exr(parts, file);
  expect_error([&] { read_exr(file); }, {file, "channel"});
}

TEST_F(ImageFiles, RefusesInvalidExrParts) {
  const auto file = folder_ / "a.exr";
  const auto refused = [&](auto&& change, std::vector<testing::Token> tokens) {
    std::vector<ExrPart> parts = two_parts();
    change(parts);
    tokens.push_back(file);
    expect_error([&] { write_exr(parts, file); }, tokens);
  };
  using Parts = std::vector<ExrPart>;
  refused([](Parts& p) { p.clear(); }, {"part"});
  refused([](Parts& p) { p[1].channels.clear(); }, {"part \"second\"", "channel"});
  refused([](Parts& p) { p[1].width = 0; }, {"part \"second\"", 0, 40});
  refused([](Parts& p) { p[0].channels.at("Y").pop_back(); }, {"channel Y", 20, 7, 3});
  refused([](Parts& p) { p[0].channels[""] = p[0].channels.at("Y"); }, {"channel"});
  refused([](Parts& p) { p[1].name = "first"; }, {"part \"first\""});
  refused([](Parts& p) { p[1].name.clear(); }, {"name"});
  refused([](Parts& p) { p[0].texts["type"] = "deepscanline"; }, {"attribute", "type"});
  refused([](Parts& p) { p[0].numbers["dataWindow"] = 1; }, {"attribute", "dataWindow"});
  refused([](Parts& p) { p[0].numbers["units"] = 1; }, {"attribute", "units"});
  refused([](Parts& p) { p[1].pairs["field_deg"] = {1, 2}; }, {"attribute", "field_deg"});
  refused([](Parts& p) { p[1].margin_x = 1; }, {"part \"second\"", "margins", 1, 0});
  refused([](Parts& p) { p[1].margin_y = -1; }, {"part \"second\"", "margins", 0, -1});
  EXPECT_EQ(files(), 0u);
}

TEST_F(ImageFiles, PngDecodesToEqualPixels) {
  Rgb8Image image{19, 7, {}};
  for (int i = 0; i < 19 * 7 * 3; ++i) image.pixels.push_back(static_cast<std::uint8_t>(i * 37));
  const auto file = folder_ / "a.png";
  write_png(image, file);
  EXPECT_EQ(files(), 1u);

  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(12, 4), "IHDR");
  EXPECT_EQ(bytes.substr(24, 2), std::string("\x08\x02", 2));  // 8 bits, RGB
  EXPECT_NE(bytes.find("sRGB"), std::string::npos);

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&png, file.c_str()));
  ASSERT_EQ(png.width, 19u);
  ASSERT_EQ(png.height, 7u);
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(png));
  ASSERT_TRUE(png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(pixels, image.pixels);
}

TEST_F(ImageFiles, FailureNamesTheFileAndLeavesNothingBehind) {
  const RgbImage linear(2, 2);
  const Rgb8Image bytes = to_srgb8(linear);
  const auto nowhere = folder_ / "missing" / "a";
  expect_error([&] { write_exr(linear, nowhere); }, {nowhere, "No such file"});
  expect_error([&] { write_png(bytes, nowhere); }, {nowhere, "No such file"});
  const auto taken = folder_ / "taken";
  std::filesystem::create_directories(taken / "inside");
  expect_error([&] { write_exr(linear, taken); }, {taken, "folder"});
  expect_error([&] { write_png(bytes, taken); }, {taken, "folder"});
  EXPECT_EQ(files(), 1u);
}

TEST_F(ImageFiles, PngKeepsTexts) {
  const Rgb8Image image{2, 1, {1, 2, 3, 250, 128, 7}};
  write_png(image, folder_ / "plain.png");
  write_png(image, folder_ / "texts.png", {{"lens", "double Gauss"}, {"focus", "1500"}});
  const auto bytes = [&](const char* name) {
    std::ifstream file(folder_ / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string plain = bytes("plain.png"), texts = bytes("texts.png");
  // Length, type, keyword, 0, text, CRC-32 of type to text.
  const std::string chunk(
      "\0\0\0\x0a"
      "tEXtfocus\0"
      "1500"
      "\x57"
      "\x5f"
      "\xc9"
      "\xbb",
      22);
  EXPECT_NE(texts.find(chunk), std::string::npos);
  EXPECT_NE(texts.find(std::string("lens\0double Gauss", 17)), std::string::npos);
  EXPECT_EQ(texts.substr(texts.find("IDAT")), plain.substr(plain.find("IDAT")));
  EXPECT_EQ(read_png(folder_ / "texts.png").pixels, read_png(folder_ / "plain.png").pixels);
  expect_error([&] { write_png(image, folder_ / "long.png", {{std::string(80, 'k'), "v"}}); }, {"long.png", "keyword"});
}

TEST_F(ImageFiles, RefusesImagesWithoutPixelsOrWithTooFew) {
  const auto file = folder_ / "a.exr";
  RgbImage torn(3, 2);
  torn.pixels.pop_back();
  expect_error([&] { write_exr(torn, file); }, {file, "image", 3, 2, 17});
  expect_error([&] { write_png(Rgb8Image{}, file); }, {file, "image", 0, 0, 0});
  expect_error([&] { write_pfm(2, 2, std::vector<float>(3), file); }, {file, 3, 2, 2});
  constexpr int wide = 1'000'001;  // libpng writes at most a million
  expect_error([&] { write_png(Rgb8Image{wide, 1, std::vector<std::uint8_t>(3 * wide)}, file); }, {file});
  EXPECT_EQ(files(), 0u);
}

TEST_F(ImageFiles, ReadingNamesBadFiles) {
  const auto absent = folder_ / "absent.exr";
  expect_error([&] { read_exr(absent); }, {absent, "No such file"});
  expect_error([&] { read_exr_parts(absent); }, {absent, "No such file"});
  expect_error([&] { read_exr(folder_); }, {folder_, "folder"});
  expect_error([&] { read_pfm(folder_); }, {folder_, "folder"});
  expect_error([&] { read_png(folder_); }, {folder_, "folder"});

  const auto file = folder_ / "a.exr";
  write_exr(random_floats(64, 64), file);
  const auto size = std::filesystem::file_size(file);
  for (const auto kept : {size / 2, std::uintmax_t(100), std::uintmax_t(4), std::uintmax_t(0)}) {
    std::filesystem::resize_file(file, kept);
    const std::string said = message([&] { read_exr(file); });
    EXPECT_TRUE(said.starts_with(file.string())) << kept << ": " << said;
    EXPECT_EQ(said.find(file.string(), 1), std::string::npos) << kept << ": " << said;
  }

  write_exr(two_parts(), file);
  for (auto kept = std::filesystem::file_size(file); kept-- > 0;) {
    std::filesystem::resize_file(file, kept);
    expect_error([&] { read_exr_parts(file); }, {file});
  }
}

TEST(Image, IsDesqueezed) {
  RgbImage image(20, 10);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      image.pixel(x, y)[0] = 1, image.pixel(x, y)[1] = x + 0.5f, image.pixel(x, y)[2] = y + 0.5f;
    }
  }
  for (const double squeeze : {1.0, 1.92, 0.5}) {
    const RgbImage out = desqueezed(image, squeeze);
    EXPECT_EQ(out.width, squeeze > 1 ? 38 : 20);
    EXPECT_EQ(out.height, squeeze < 1 ? 20 : 10);
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        EXPECT_FLOAT_EQ(out.pixel(x, y)[0], 1);
        // Positions scale except in the outer halves of the edge pixels.
        EXPECT_NEAR(out.pixel(x, y)[1], std::clamp((x + 0.5) * 20 / out.width, 0.5, 19.5), 1e-5);
        EXPECT_NEAR(out.pixel(x, y)[2], std::clamp((y + 0.5) * 10 / out.height, 0.5, 9.5), 1e-5);
      }
    }
  }
  for (const double bad : {0.0, -2.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_error([&] { desqueezed(image, bad); }, {"squeeze", bad});
  }
  image.pixels.pop_back();
  expect_error([&] { desqueezed(image, 2); }, {"desqueezed", "image", 20, 10, 599});
  expect_error([&] { desqueezed({}, 2); }, {"desqueezed", "image", 0, 0, 0});
}

TEST(Image, HasNoNegativeSize) {
  expect_error([] { RgbImage(-1, 5); }, {"picture", -1, 5});
  expect_error([] { RgbImage(5, -1); }, {"picture", 5, -1});
  EXPECT_TRUE(RgbImage(0, 5).pixels.empty());
}

TEST(Image, ConvertsToSrgb) {
  RgbImage image(3, 1);
  // IEC 61966-2-1 by hand: 0.5 is 0.735 of full scale. The last three values test the linear segment.
  image.pixels = {0.0f, 1.0f, 0.5f, -1.0f, 7.0f, 0.0031308f, std::numeric_limits<float>::quiet_NaN(), 0.25f, 0.002f};
  EXPECT_EQ(to_srgb8(image).pixels, (std::vector<std::uint8_t>{0, 255, 188, 0, 255, 10, 0, 137, 7}));
  EXPECT_EQ(to_srgb8(image, 2).pixels, (std::vector<std::uint8_t>{0, 255, 255, 0, 255, 18, 0, 188, 13}));
}

}  // namespace image_test
}  // namespace petzval
