// SPDX-License-Identifier: Apache-2.0
#include "petzval/image/psf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace psf_image_test {

using testing::expect_error;
using testing::expect_tokens;

double light(const RgbImage& image, double pixel_mm) {
  double sum = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) sum += static_cast<double>(image.pixels[i]);
  return sum * pixel_mm * pixel_mm;
}

TEST(Render, PixelsSumToTheThroughput) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f1.35");
  const std::vector<std::array<double, 3>> white{{1, 1, 1}};
  for (const double f_number : {1.4, 4.0}) {
    for (const int pixels : {32, 200}) {
      const Psf image =
          point_image(with_f_number(lens, f_number), {radians(5), -1200}, {.samples = 1 << 14, .pixels = pixels});
      const RgbImage picture = render(image, white);
      EXPECT_EQ(picture.width, pixels);
      EXPECT_NEAR(light(picture, image.pixel_mm) / image.mean_throughput, 1, 1e-6);
    }
  }
}

TEST(Render, WeighsWavelengths) {
  Psf psf;
  psf.pixels = 2;
  psf.pixel_mm = 0.5;
  psf.wavelengths_nm = {450, 650};
  psf.counts = {0, 10, 0, 0, /**/ 0, 20, 0, 5};
  psf.sent = {100, 100};
  psf.transmitted = {10, 25};
  psf.sampled_area = {2, 4};
  psf.entrance_pupil_area = 8;
  const RgbImage image = render(psf, std::vector<std::array<double, 3>>{{0, 0.25, 1}, {1, 0.75, -0.5}});
  // A ray carries 2 / (100 * 8) or 4 / (100 * 8), spread over 0.25 mm^2: 0.01 and 0.02 per mm^2.
  const std::vector<float> expected{0.1f, 0.075f, -0.05f, 0, 0, 0, 0.4f, 0.325f, -0.1f, 0, 0, 0};
  ASSERT_EQ(image.pixels.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(image.pixels[i], expected[i], 1e-7f) << i;
}

// The pattern of names of the layout (Fichet et al. 2021, Stokes component 0), with the wavelength in its first group.
TEST(SpectralImage, RoundTripsToTheBitByLayoutNames) {
  const std::vector<double> set{587.5618, 430, 656.2725};
  Psf psf;
  psf.pixels = 3;
  psf.pixel_mm = 0.5;
  psf.wavelengths_nm = set;
  for (std::uint64_t i = 0; i < 27; ++i) psf.counts.push_back(i * i);
  psf.sent = {100, 100, 300};
  psf.sampled_area = {2, 4, 3};
  psf.entrance_pupil_area = 8;
  const std::vector<std::array<double, 3>> weights{{0.2, 0.7, 0}, {0.1, -0.1, 1}, {0.7, 0.4, 0}};
  const auto file = std::filesystem::path(::testing::TempDir()) / "petzval_spectral_test.exr";
  write_exr(std::array{spectral_image(psf, weights)}, file);
  const auto parts = read_exr_parts(file);
  const RgbImage rgb = read_exr(file);
  std::filesystem::remove(file);

  EXPECT_EQ(rgb.pixels, render(psf, weights).pixels);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].texts.at("spectralLayoutVersion"), "1.0");
  EXPECT_EQ(parts[0].texts.at("emissiveUnits"), "mm^-2");
  const std::regex pattern("^S0\\.(\\d*,?\\d*([Ee][+-]?\\d+)?)(Y|Z|E|P|T|G|M|k|h|da|d|c|m|u|n|p)?(m|Hz)$");
  std::size_t found = 0;
  for (const auto& [name, values] : parts[0].channels) {
    std::smatch match;
    if (!std::regex_match(name, match, pattern)) continue;
    EXPECT_EQ(match[3].str() + match[4].str(), "nm");
    std::string nm = match[1];
    std::replace(nm.begin(), nm.end(), ',', '.');
    const auto at = std::find(set.begin(), set.end(), std::stod(nm));
    ASSERT_NE(at, set.end()) << name;
    std::vector<std::array<double, 3>> alone(3);
    alone[static_cast<std::size_t>(at - set.begin())] = {1, 0, 0};
    const RgbImage expected = render(psf, alone);
    ASSERT_EQ(values.size(), 9u);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(values[i], expected.pixels[3 * i]);
    ++found;
  }
  EXPECT_EQ(found, 3u);
  EXPECT_EQ(parts[0].channels.size(), 6u);
}

// As in photographs, the triangle stands on an edge behind the focus and on a corner in front of the focus.
TEST(Render, IrisIsUprightForLightsBeyondTheFocus) {
  const std::vector<std::array<double, 3>> white{{1, 1, 1}};
  const Lens lens = with_iris(testing::data_lens("double_gauss_100mm_f2.0"), {.blades = 3});
  for (const double light_z : {-1e5, -1000.0}) {
    const Lens focused = with_focus(with_f_number(lens, 5.6), 3000);
    const RgbImage picture = render(point_image(focused, {0, light_z}, {.samples = 1 << 16, .pixels = 64}), white);
    const auto lit_in_row = [&](int row) {
      int lit = 0;
      for (int column = 0; column < 64; ++column) {
        lit += picture.pixels[3 * (64 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column))] > 0;
      }
      return lit;
    };
    int upper = 0, lower = 0;
    for (int row = 0; row < 32; ++row) upper += lit_in_row(row), lower += lit_in_row(63 - row);
    EXPECT_GT(light_z < -3000 ? lower : upper, 1.2 * (light_z < -3000 ? upper : lower));
  }
}

TEST(Render, RequiresACountForEachPixelAndWavelength) {
  Psf psf;
  psf.pixels = 2;
  psf.wavelengths_nm = {450, 650};
  psf.counts.resize(7);
  const std::vector<std::array<double, 3>> weights(2);
  expect_error([&] { render(psf, weights); }, {"render", "counts", 7, 8});
  expect_error([&] { spectral_image(psf, weights); }, {"render", "counts", 7, 8});
}

TEST(Render, RequiresAWeightForEachWavelength) {
  Psf psf;
  psf.wavelengths_nm = {450, 650};
  try {
    render(psf, std::vector<std::array<double, 3>>{{1, 1, 1}});
    FAIL();
  } catch (const Error& e) {
    expect_tokens(e.what(), {"render", "1 weights"});
  }
}

}  // namespace psf_image_test
}  // namespace petzval
