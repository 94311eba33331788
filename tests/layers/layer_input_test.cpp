// SPDX-License-Identifier: Apache-2.0
#include "layers/layer_input.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#ifdef PETZVAL_HAS_JPEG
#include <jpeglib.h>
#endif

#include "../expect_error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/image/image.hpp"

namespace {

using lens_blur::InputFlags;
using lens_blur::LayerInput;
using petzval::RgbImage;
using petzval::testing::expect_error;

constexpr int columns = 16, rows = 8;
constexpr std::size_t pixels = columns * rows;
constexpr double infinity = std::numeric_limits<double>::infinity();

class LayerInputFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "petzval-input-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    RgbImage picture(columns, rows);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] = static_cast<float>(i % 64) / 64;
    petzval::write_pfm(picture, path("picture.pfm"));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Grey values from black to white.
  static std::vector<std::uint16_t> ramp(int bits) {
    const std::size_t most = (std::size_t{1} << bits) - 1;
    std::vector<std::uint16_t> values;
    for (std::size_t i = 0; i < pixels; ++i) values.push_back(static_cast<std::uint16_t>(i * most / (pixels - 1)));
    return values;
  }
  std::string write_grey_png(const std::string& name, const std::vector<std::uint16_t>& values, int bits) const {
    png_image png{};
    png.version = PNG_IMAGE_VERSION, png.width = columns, png.height = rows;
    png.format = bits == 16 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    const std::vector<std::uint8_t> bytes(values.begin(), values.end());
    const void* const data = bits == 16 ? static_cast<const void*>(values.data()) : bytes.data();
    EXPECT_TRUE(png_image_write_to_file(&png, path(name).c_str(), 0, data, 0, nullptr)) << png.message;
    return path(name);
  }
  std::string write_depths(const std::string& name, const std::vector<float>& depths, int width = columns,
                           int height = rows) const {
    petzval::write_pfm(width, height, depths, path(name));
    return path(name);
  }
  InputFlags flags(const std::string& depth) const {
    InputFlags result;
    result.image = path("picture.pfm"), result.depth = depth;
    return result;
  }
  /// Planes of the first layer: inverse depth, red, green and blue.
  static std::array<std::vector<float>, 4> layer(const InputFlags& flags) {
    LayerInput input(flags);
    const petzval::PeelPlan plan{.camera = petzval::layer_camera(input.columns(), input.rows(), petzval::radians(30.0)),
                                 .bias = 0};
    input.nearest_mm(plan.camera, 1);
    petzval::LayerSet set;
    input.fill(plan, 1, 1, set);
    std::array<std::vector<float>, 4> planes;
    planes[0].assign(set.inverse_depth(0).begin(), set.inverse_depth(0).end());
    for (std::size_t i = 0; i < planes[0].size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) planes[c + 1].push_back(set.rgba(0, i)[c]);
    }
    return planes;
  }

  std::filesystem::path folder_;
};

TEST_F(LayerInputFiles, PngDepthEqualsPfmDepth) {
  for (const int bits : {8, 16}) {
    const std::vector<std::uint16_t> grey = ramp(bits);
    const std::string png = write_grey_png("depth.png", grey, bits);
    for (const std::string kind : {"axial", "distance", "inverse"}) {
      for (const std::string white : {"", "near", "far"}) {
        InputFlags given = flags(png);
        given.depth_kind = kind, given.white = white, given.near_mm = 1000;
        given.far_mm = kind == "inverse" ? infinity : 9000;
        const bool near_is_white = white.empty() ? kind == "inverse" : white == "near";
        std::vector<float> lengths;
        for (const std::uint16_t value : grey) {
          const double part = value / (std::pow(2.0, bits) - 1), from_near = near_is_white ? 1 - part : part;
          lengths.push_back(static_cast<float>(kind == "inverse" ? 1000 / (1 - from_near) : 1000 + from_near * 8000));
        }
        InputFlags same = flags(write_depths("depth.pfm", lengths));
        same.depth_kind = kind == "inverse" ? "axial" : kind;
        const auto a = layer(given)[0], b = layer(same)[0];
        ASSERT_EQ(a.size(), pixels);
        for (std::size_t i = 0; i < pixels; ++i) EXPECT_NEAR(a[i], b[i], 1e-9) << bits << kind << white << i;
      }
    }
  }
}

TEST_F(LayerInputFiles, InverseDepthsOfFloatFilesAreReciprocals) {
  std::vector<float> inverse, depths;
  for (std::size_t i = 0; i < pixels; ++i) {
    inverse.push_back(static_cast<float>(i) / 65536);  // the first is infinity
    depths.push_back(1 / inverse.back());
  }
  InputFlags given = flags(write_depths("inverse.pfm", inverse));
  given.depth_kind = "inverse";
  EXPECT_EQ(layer(given), layer(flags(write_depths("depth.pfm", depths))));
}

TEST_F(LayerInputFiles, DepthsOfAnExrGiveWayToDepth) {
  const RgbImage picture = petzval::read_pfm(path("picture.pfm"));
  petzval::write_exr(picture, path("picture.exr"));
  InputFlags given = flags(write_depths("depth.pfm", std::vector<float>(pixels, 2000)));
  const auto expected = layer(given);
  given.image = path("picture.exr");
  EXPECT_EQ(layer(given), expected);
  petzval::ExrPart part = petzval::read_exr_parts(path("picture.exr")).front();
  part.channels["Z"].assign(pixels, 500);
  petzval::write_exr({&part, 1}, path("picture.exr"));
  EXPECT_EQ(layer(given), expected);
}

TEST_F(LayerInputFiles, RefusesDepthsThatDoNotFit) {
  const std::string grey = write_grey_png("grey.png", ramp(8), 8);
  InputFlags given = flags(grey);
  const auto refused = [&](const std::vector<petzval::testing::Token>& tokens) {
    expect_error([&] { LayerInput{given}; }, tokens);
  };
  refused({"--depth", "grey.png", "--near", "--far"});
  given.near_mm = 5000, given.far_mm = 1000;
  refused({"--near", 5000, "--far", 1000});
  given.far_mm = infinity;
  refused({"--far", "inf", "--depth-kind"});
  given.far_mm = 9000;
  petzval::write_png({columns, rows,
                      [] {
                        std::vector<std::uint8_t> bytes(3 * pixels, 7);
                        bytes[100] = 8;
                        return bytes;
                      }()},
                     path("colours.png"));
  given.depth = path("colours.png");
  refused({"colours.png", "grey"});
  given.depth = write_depths("long.pfm", std::vector<float>(pixels, 2));
  refused({"long.pfm", 2, 0, 1, "--near"});
  given.depth = write_depths("turned.pfm", std::vector<float>(pixels, 0.5f), rows, columns);
  refused({"turned.pfm", "picture.pfm", columns, rows});
  given.depth = path("depth.tif");
  refused({"--depth", "depth.tif"});
  given = flags("");
  refused({"picture.pfm", "Z", "--depth"});
  given.depth_kind = "inverse";
  refused({"--depth-kind", "inverse", "--depth"});
  given = flags(grey);
  given.image = path("picture.tif"), given.near_mm = 1, given.far_mm = 2;
  refused({"--image", "picture.tif"});
}

#ifdef PETZVAL_HAS_JPEG

/// Writes a JPEG of one colour per quarter, so that blocks of 8 x 8 pixels are uniform.
/// @param orientation  of EXIF data; 0: no EXIF data
void write_jpeg(const std::string& file, const std::vector<std::array<JSAMPLE, 4>>& quarters, int channels,
                J_COLOR_SPACE space, int orientation = 0) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  std::FILE* const out = std::fopen(file.c_str(), "wb");
  ASSERT_TRUE(out);
  jpeg_stdio_dest(&info, out);
  info.image_width = 32, info.image_height = 16;
  info.input_components = channels, info.in_color_space = space;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 100, TRUE);
  for (int c = 0; c < info.num_components; ++c) info.comp_info[c].h_samp_factor = info.comp_info[c].v_samp_factor = 1;
  jpeg_start_compress(&info, TRUE);
  if (orientation > 0) {
    const std::array<JOCTET, 32> exif{
        'E', 'x', 'i', 'f',  0,    0, 'M', 'M', 0, 42, 0, 0, 0,
        8,   0,   1,   0x01, 0x12, 0, 3,   0,   0, 0,  1, 0, static_cast<JOCTET>(orientation)};
    jpeg_write_marker(&info, JPEG_APP0 + 1, exif.data(), static_cast<unsigned>(exif.size()));
  }
  for (std::size_t y = 0; y < 16; ++y) {
    std::vector<JSAMPLE> line;
    for (std::size_t x = 0; x < 32; ++x) {
      const auto& colour = quarters[y / 8 * 2 + x / 16];
      line.insert(line.end(), colour.begin(), colour.begin() + channels);
    }
    JSAMPLE* row = line.data();
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::fclose(out);
}

class JpegInput : public LayerInputFiles {
 protected:
  /// Names of the quarters, row by row from the top: r, g, b or w (white).
  std::string quarters(const std::string& file, int width, int height) const {
    InputFlags given = flags(write_depths("flat.pfm", std::vector<float>(512, 1000), width, height));
    given.image = file;
    const auto planes = layer(given);
    std::string names;
    for (const int y : {height / 4, 3 * height / 4}) {
      for (const int x : {width / 4, 3 * width / 4}) {
        const auto at = static_cast<std::size_t>(y * width + x);
        const bool red = planes[1][at] > 0.9f, green = planes[2][at] > 0.9f, blue = planes[3][at] > 0.9f;
        names += red && green && blue ? 'w' : red ? 'r' : green ? 'g' : blue ? 'b' : '?';
      }
    }
    return names;
  }
  std::string colours(int orientation) const {
    write_jpeg(path("colours.jpg"), {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}}, 3, JCS_RGB, orientation);
    return path("colours.jpg");
  }
};

TEST_F(JpegInput, DecodesSrgb) {
  const std::array<JSAMPLE, 4> grey{128, 128, 128};
  write_jpeg(path("grey.JPG"), {grey, grey, grey, grey}, 3, JCS_RGB);
  write_jpeg(path("one.jpeg"), {grey, grey, grey, grey}, 1, JCS_GRAYSCALE);
  InputFlags given = flags(write_depths("flat.pfm", std::vector<float>(512, 1000), 32, 16));
  for (const char* file : {"grey.JPG", "one.jpeg"}) {
    given.image = path(file);
    const auto planes = layer(given);
    for (std::size_t c = 1; c < 4; ++c) EXPECT_NEAR(planes[c][100], 0.2158605f, 3e-5) << file;  // sRGB 128
  }
}

TEST_F(JpegInput, AppliesTheOrientationOfTheCamera) {
  EXPECT_EQ(quarters(colours(0), 32, 16), "rgbw");
  // The quarters of the upright picture.
  const std::array upright{"rgbw", "grwb", "wbgr", "bwrg", "rbgw", "brwg", "wgbr", "gwrb"};
  for (int i = 1; i <= 8; ++i) {
    const bool turned = i >= 5;
    EXPECT_EQ(quarters(colours(i), turned ? 16 : 32, turned ? 32 : 16), upright[static_cast<std::size_t>(i - 1)]) << i;
  }
}

TEST_F(JpegInput, RefusesInksAndIncompleteFiles) {
  const std::array<JSAMPLE, 4> ink{10, 20, 30, 40};
  InputFlags given = flags(write_depths("flat.pfm", std::vector<float>(512, 1000), 32, 16));
  write_jpeg(path("inks.jpg"), {ink, ink, ink, ink}, 4, JCS_CMYK);
  given.image = path("inks.jpg");
  expect_error([&] { LayerInput{given}; }, {"inks.jpg", "CMYK"});
  const std::string whole = petzval::read_file(colours(6), "a picture");
  given.image = path("part.jpg");
  for (const std::size_t size : {whole.size() - 2, whole.size() / 2, std::size_t{20}, std::size_t{0}}) {
    petzval::write_file(whole.substr(0, size), path("part.jpg"));
    expect_error([&] { LayerInput{given}; }, {"part.jpg", "complete", "JPEG"});
  }
}

#endif

}  // namespace
