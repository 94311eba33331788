// SPDX-License-Identifier: Apache-2.0
// Images of points with diffraction: closed forms, laws, and Huygens' sum against the FFT.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace diffraction_test {

constexpr double far = -std::numeric_limits<double>::infinity();

/// A parabolic mirror of 100 mm focal length: perfect on the axis.
Lens parabola(double f_number, std::vector<double> wavelengths_nm = {d_line_nm}) {
  Prescription p;
  p.name = "parabola";
  p.surfaces = {
      {.radius = -200, .thickness = -100, .semi_diameter = 50 / f_number, .conic = -1, .stop = true, .mirror = true}};
  return compile(p, wavelengths_nm);
}

Lens cooke(double f_number) {
  const Lens lens = with_f_number(testing::data_lens("cooke_triplet_50mm_f5"), f_number);
  return with_focus(lens, std::numeric_limits<double>::infinity());
}

double light_of(const DiffractionPsf& psf) {
  return std::accumulate(psf.irradiance.begin(), psf.irradiance.end(), 0.0) * psf.pixel_mm * psf.pixel_mm;
}

double pixel(const DiffractionPsf& psf, int row, int column) {
  return psf.irradiance[static_cast<std::size_t>(row * psf.pixels + column)];
}

/// Largest difference of two images relative to the largest value.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double farthest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) farthest = std::max(farthest, std::abs(a[i] - b[i]));
  return farthest / *std::ranges::max_element(a);
}

TEST(DiffractionPsf, OfAPerfectMirrorIsTheAiryPattern) {
  constexpr double f_number = 10, wave_mm = d_line_nm * 1e-6;
  const DiffractionPsf psf = diffraction_psf(parabola(f_number), {.z = far}, {.pixels = 255});
  // Peak: area of the pupil / (wavelength focal length)^2 per light on the pupil.
  const double peak = std::numbers::pi * 25 / std::pow(wave_mm * 100, 2);
  for (int column = 127; column < 255; ++column) {
    const double v = std::numbers::pi * (column - 127) * psf.pixel_mm / (wave_mm * f_number);
    const double airy = v == 0 ? 1 : std::pow(2 * std::cyl_bessel_j(1, v) / v, 2);
    EXPECT_NEAR(pixel(psf, 127, column) / peak, airy, 2e-3) << column;
    EXPECT_NEAR(pixel(psf, 254 - column, 127) / peak, airy, 2e-3) << column;
  }
  EXPECT_NEAR(psf.strehl[0], 1, 1e-9);
  EXPECT_NEAR(psf.throughput[0], 1, 1e-3);
}

TEST(DiffractionPsf, OfTwiceTheWavelengthIsTwiceAsLarge) {
  const Lens lens = parabola(8, {400, 800});
  const auto at = [&](std::size_t w, double half_width) {
    return diffraction_psf(lens, {.z = far}, {.pixels = 128, .half_width_mm = half_width, .wavelength = w}).irradiance;
  };
  std::vector<double> small = at(0, 0.03), large = at(1, 0.06);
  for (double& value : large) value *= 4;
  EXPECT_LT(difference(small, large), 1e-3);
}

TEST(DiffractionPsf, ByFftEqualsHuygensSum) {
  for (const double field_deg : {0.0, 12.0}) {
    const FieldPoint point{.field_rad = radians(field_deg), .z = far};
    const Lens lens = cooke(8);
    const DiffractionPsf fft = diffraction_psf(lens, point, {.pixels = 48});
    const DiffractionPsf sum = diffraction_psf(lens, point, {.pixels = 48, .huygens = true});
    EXPECT_LT(difference(fft.irradiance, sum.irradiance), 1e-3) << field_deg;
    EXPECT_NEAR(fft.strehl[0], sum.strehl[0], 1e-3) << field_deg;
  }
}

TEST(DiffractionPsf, ConservesTheLight) {
  for (const double field_deg : {0.0, 15.0}) {
    const FieldPoint point{.field_rad = radians(field_deg), .z = far};
    const DiffractionPsf psf = diffraction_psf(cooke(16), point);
    EXPECT_LT(light_of(psf), psf.throughput[0]) << field_deg;
    EXPECT_GT(light_of(psf), 0.97 * psf.throughput[0]) << field_deg;  // 15 Airy radii hold 98 to 99 %
    const Psf rays = point_image(cooke(16), point, {.samples = 1u << 16, .pixels = 16});
    EXPECT_NEAR(psf.throughput[0], rays.mean_throughput, 2e-3 * rays.mean_throughput);
  }
}

TEST(DiffractionPsf, HasTheStrehlRatioOfASmallWavefrontError) {
  const Lens lens = cooke(9);
  const FieldPoint point{.field_rad = radians(5.0), .z = far};
  const auto front = wavefront(lens, point);
  ASSERT_TRUE(front);
  ASSERT_TRUE(front->strehl);
  EXPECT_LT(*front->strehl, 0.97);
  EXPECT_GT(*front->strehl, 0.5);
  for (const double half_width : {0.0, 0.05, 0.5}) {
    const DiffractionPsf psf = diffraction_psf(lens, point, {.pixels = 128, .half_width_mm = half_width});
    EXPECT_NEAR(psf.strehl[0], *front->strehl, 5e-3) << half_width;
  }
}

// Far out of focus the image approaches the geometric blur.
TEST(DiffractionPsf, OfADefocusedPointHasTheSizeOfTheGeometricBlur) {
  const Lens lens = parabola(8);
  const Lens defocused = with_film(lens, lens.film_z() - 2);
  const FieldPoint point{.z = far};
  const DiffractionPsf psf = diffraction_psf(defocused, point, {.pixels = 256, .half_width_mm = 0.2});
  const Psf rays = point_image(defocused, point, {.samples = 1u << 16, .pixels = 16});
  double inside = 0;
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      const double r = std::hypot(row - 127.5, column - 127.5) * psf.pixel_mm;
      if (r < 1.2 * rays.size.max_radius) inside += pixel(psf, row, column) * psf.pixel_mm * psf.pixel_mm;
    }
  }
  EXPECT_NEAR(inside, rays.mean_throughput, 0.04);  // the edge of the shadow is 25 um wide
}

TEST(DiffractionPsf, OfASquareIrisIsTheSquareOfTwoSincs) {
  const Lens lens = with_iris(parabola(10), {.blades = 4, .rotation_rad = std::numbers::pi / 4});
  const DiffractionPsf psf = diffraction_psf(lens, {.z = far}, {.pixels = 255, .half_width_mm = 0.06});
  const double side = 10 / std::sqrt(2), unit = d_line_nm * 1e-6 * 100 / side;
  const double peak = side * side * side * side / (std::numbers::pi * 25) / std::pow(d_line_nm * 1e-6 * 100, 2);
  for (int column = 127; column < 255; ++column) {
    const double v = std::numbers::pi * (column - 127) * psf.pixel_mm / unit;
    const double sinc = v == 0 ? 1 : std::sin(v) / v;
    EXPECT_NEAR(pixel(psf, 127, column) / peak, sinc * sinc, 3e-3) << column;
  }
  // Spikes: far more light along x than on the diagonal.
  double spike = 0, diagonal = 0;
  for (int k = 40; k < 120; ++k) spike += pixel(psf, 127, 127 + k), diagonal += pixel(psf, 127 - k, 127 + k);
  EXPECT_GT(spike, 50 * diagonal);
}

TEST(DiffractionPsf, IsTheSameForEveryNumberOfThreads) {
  const Lens lens = cooke(11);
  const FieldPoint point{.field_rad = radians(10.0), .z = far};
  EXPECT_EQ(diffraction_psf(lens, point, {.pixels = 64, .threads = 1}).irradiance,
            diffraction_psf(lens, point, {.pixels = 64, .threads = 3}).irradiance);
}

TEST(DiffractionPsf, PixelsAreMeansOfFinerSamples) {
  const Lens lens = cooke(11);
  const FieldPoint point{.z = far};
  const DiffractionPsf coarse = diffraction_psf(lens, point, {.pixels = 64, .half_width_mm = 0.32});
  const DiffractionPsf fine = diffraction_psf(lens, point, {.pixels = 256, .half_width_mm = 0.32});
  EXPECT_GT(coarse.samples_per_pixel, fine.samples_per_pixel);
  std::vector<double> means(coarse.irradiance.size());
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      means[static_cast<std::size_t>(row / 4 * 64 + column / 4)] += pixel(fine, row, column) / 16;
    }
  }
  EXPECT_LT(difference(coarse.irradiance, means), 2e-3);
}

TEST(DiffractionPsf, OfADarkFieldIsBlack) {
  const DiffractionPsf psf = diffraction_psf(cooke(8), {.field_rad = radians(80.0), .z = far}, {.pixels = 16});
  EXPECT_EQ(std::ranges::count(psf.irradiance, 0.0), 256);
  EXPECT_EQ(psf.throughput[0], 0);
}

TEST(DiffractionPsf, RefusesInvalidOptionsAndLargeBlurs) {
  const Lens lens = cooke(5);
  const FieldPoint point{.z = far};
  testing::expect_error([&] { diffraction_psf(lens, point, {.pixels = 8}); }, {"pixels", 8, 16});
  testing::expect_error([&] { diffraction_psf(lens, point, {.half_width_mm = -1}); }, {"half_width_mm", -1});
  testing::expect_error([&] { diffraction_psf(lens, point, {.threads = 0}); }, {"threads", 0});
  testing::expect_error([&] { diffraction_psf(with_film(lens, lens.film_z() + 60), point); }, {"blur", 4096});
  testing::expect_error([&] { diffraction_psf(lens, point, {.half_width_mm = 1e-4}); }, {"width", "at least"});
  // A cylinder has no focus in the other section.
  testing::expect_error([] { diffraction_psf(testing::data_lens("cylinder_3.9mm"), {.z = far}); }, {"parallel"});
}

TEST(DiffractionMtf, OfAPerfectMirrorIsTheClosedForm) {
  constexpr double f_number = 8;
  const DiffractionPsf psf = diffraction_psf(parabola(f_number), {.z = far});
  const std::array frequencies{20.0, 60.0, 100.0, 150.0, 200.0, 250.0};
  for (const MtfPoint& point : diffraction_mtf(psf, frequencies)) {
    const double limit = diffraction_limited_mtf(point.frequency_per_mm, d_line_nm, f_number);
    EXPECT_NEAR(point.tangential, limit, 5e-3) << point.frequency_per_mm;
    EXPECT_NEAR(point.sagittal, limit, 5e-3) << point.frequency_per_mm;
  }
  testing::expect_error([&] { diffraction_mtf(psf, frequencies, std::array{1.0, 1.0}); }, {"weights", 2, 1});
}

// Wide pixels lower the contrast of the image, not of the MTF.
TEST(DiffractionMtf, DoesNotDependOnThePixels) {
  const Lens lens = cooke(11);
  const FieldPoint point{.field_rad = radians(8.0), .z = far};
  const std::array frequencies{10.0, 30.0};
  const auto fine = diffraction_mtf(diffraction_psf(lens, point, {.pixels = 512, .half_width_mm = 0.3}), frequencies);
  const auto wide = diffraction_mtf(diffraction_psf(lens, point, {.pixels = 64, .half_width_mm = 0.3}), frequencies);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_NEAR(fine[i].tangential, wide[i].tangential, 2e-3);
    EXPECT_NEAR(fine[i].sagittal, wide[i].sagittal, 2e-3);
  }
  const std::array none{0.0};
  EXPECT_GT(diffraction_mtf(diffraction_psf(lens, point), none)[0].tangential, 0.97);
}

}  // namespace diffraction_test
}  // namespace petzval
