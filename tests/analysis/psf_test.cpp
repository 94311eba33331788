// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/psf.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval {
namespace psf_test {

using testing::data_lens;
using testing::expect_error;
using testing::expect_tokens;
using testing::front_stop_lens;
using testing::message;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::uint64_t sum(const Psf& psf) { return std::accumulate(psf.counts.begin(), psf.counts.end(), std::uint64_t(0)); }

double profile_light(const Psf& image) {
  const double width = image.size.max_radius / 64;
  double light = 0;
  for (std::size_t k = 0; k < 64; ++k) {
    light += image.radial_profile[k] * std::numbers::pi * width * width * static_cast<double>(2 * k + 1);
  }
  return light;
}

TEST(PointImage, ImageContainsEveryTransmittedRay) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  for (const double field : {0.0, 14.0}) {
    for (const double z : {-infinity, -1000.0}) {
      const Psf image = point_image(lens, {radians(field), z}, {.samples = 1 << 15, .pixels = 101});
      EXPECT_GT(image.transmitted[0], 10000u);
      EXPECT_EQ(sum(image), image.transmitted[0]);
      EXPECT_EQ(image.sent[0], 1u << 15);
      EXPECT_EQ(image.centre, image.size.centroid);
      EXPECT_NEAR(profile_light(image), image.mean_throughput, 1e-14);
    }
  }
}

TEST(PointImage, CentreShiftsTheImageOnly) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const FieldPoint point{radians(10), -700};
  const Psf own = point_image(lens, point, {.samples = 1 << 14, .pixels = 64});
  const Vec2<double> centre = own.size.centroid + Vec2<double>{0.5, -1};
  const Psf moved = point_image(lens, point, {.samples = 1 << 14, .pixels = 64, .centre = centre});
  EXPECT_EQ(moved.centre, centre);
  EXPECT_EQ(moved.size.centroid, own.size.centroid);
  EXPECT_EQ(moved.radial_profile, own.radial_profile);
  EXPECT_GT(moved.pixel_mm, own.pixel_mm) << "holds every ray";
  EXPECT_EQ(sum(moved), moved.transmitted[0]);
  for (const double bad : {std::nan(""), infinity}) {
    expect_error([&] { point_image(lens, point, {.centre = Vec2<double>{0, bad}}); }, {"centre", bad});
  }
}

TEST(PointImage, OneWavelengthEqualsItsPlane) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens lens = compile(testing::data_prescription("cooke_triplet_50mm_f5"),
                            std::array{656.2725, 486.1327, 587.5618}, {.glasses = &glasses});
  const FieldPoint point{radians(10), -2000};
  const PsfOptions options{.samples = 1 << 12, .pixels = 32, .half_width_mm = 0.5, .centre = Vec2<double>{0, -9}};
  const Psf all = point_image(lens, point, options);
  for (std::size_t w = 0; w < 3; ++w) {
    PsfOptions one = options;
    one.wavelength = w;
    const Psf psf = point_image(lens, point, one);
    EXPECT_EQ(psf.wavelengths_nm, std::vector{lens.wavelengths_nm()[w]});
    ASSERT_EQ(psf.counts.size(), 1024u);
    EXPECT_TRUE(std::equal(psf.counts.begin(), psf.counts.end(), all.counts.begin() + static_cast<int>(w) * 1024)) << w;
    EXPECT_EQ(psf.throughput(0), all.throughput(w));
  }
  PsfOptions none = options;
  none.wavelength = 3;
  expect_error([&] { point_image(lens, point, none); }, {"wavelength"});
}

TEST(PointImage, CropKeepsThroughputAndProfile) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const FieldPoint point{radians(10), -700};
  const Psf whole = point_image(lens, point, {.samples = 1 << 14, .pixels = 64});
  const Psf cropped =
      point_image(lens, point, {.samples = 1 << 14, .pixels = 64, .half_width_mm = whole.size.rms_radius / 2});
  EXPECT_LT(sum(cropped), sum(whole) / 2);
  EXPECT_GT(sum(cropped), 0u);
  EXPECT_EQ(cropped.mean_throughput, whole.mean_throughput);
  EXPECT_EQ(cropped.radial_profile, whole.radial_profile);
  EXPECT_EQ(cropped.pixel_mm * 64, whole.size.rms_radius);
}

TEST(PointImage, SeedsAgreeWithinTheirError) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const FieldPoint point{radians(8), -1300};
  const Psf a = point_image(lens, point, {.samples = 1 << 15, .seed = 1});
  const Psf b = point_image(lens, point, {.samples = 1 << 15, .seed = 2});
  EXPECT_NE(a.counts, b.counts);
  EXPECT_NEAR(a.mean_throughput / b.mean_throughput, 1, 2e-3);
  EXPECT_NEAR(a.size.rms_radius / b.size.rms_radius, 1, 2e-3);
}

TEST(PointImage, MirrorsWithTheField) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const Psf up = point_image(lens, {radians(12), -1300}, {.samples = 1 << 15});
  const Psf down = point_image(lens, {radians(-12), -1300}, {.samples = 1 << 15});
  EXPECT_NEAR(up.size.centroid.y / down.size.centroid.y, -1, 1e-4);
  EXPECT_NEAR(up.mean_throughput / down.mean_throughput, 1, 2e-3);
  EXPECT_LT(up.size.centroid.y, 0);
  // The image is symmetric about the meridian.
  const auto side = static_cast<std::size_t>(up.pixels);
  std::uint64_t left = 0;
  for (std::size_t i = 0; i < up.counts.size(); ++i) left += i % side < side / 2 ? up.counts[i] : 0;
  EXPECT_NEAR(static_cast<double>(left) / static_cast<double>(sum(up)), 0.5, 2e-3);
}

TEST(PointImage, RowsRunFromTheTop) {
  // Coma moves the light to one side of the spot. The first moments of image and hits must agree.
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FieldPoint point{radians(10), -infinity};
  const Psf image = point_image(lens, point, {.samples = 1 << 14, .pixels = 40, .half_width_mm = 0.05});
  const RayBundle hits = trace_bundle(lens, PupilSampler(pupil_boundary(lens, point)), 1 << 14);
  std::uint64_t above = 0, above_left = 0;
  const double cx = image.centre.x, cy = image.centre.y;
  for (std::size_t i = 0; i < hits.x.size(); ++i) {
    if (std::abs(hits.x[i] - cx) >= 0.05 || std::abs(hits.y[i] - cy) >= 0.05 || hits.y[i] <= cy + 0.02) continue;
    ++above;
    above_left += hits.x[i] < cx - 0.01;
  }
  std::uint64_t counted = 0, counted_left = 0;
  for (std::size_t row = 0; row < 12; ++row) {
    for (std::size_t column = 0; column < 40; ++column) {
      counted += image.counts[row * 40 + column];
      counted_left += column < 16 ? image.counts[row * 40 + column] : 0;
    }
  }
  EXPECT_NE(above, 0u);
  EXPECT_EQ(counted, above);
  EXPECT_EQ(counted_left, above_left);
}

TEST(PointImage, AllLightOfAFrontStopArrives) {
  const Lens lens = front_stop_lens(2);
  for (const double field : {0.0, 5.0}) {
    for (const double z : {-infinity, -1000.0}) {
      const Psf image = point_image(lens, {radians(field), z}, {.samples = 1 << 18});
      EXPECT_NEAR(image.entrance_pupil_area, 4 * std::numbers::pi, 1e-12);
      EXPECT_NEAR(image.mean_throughput, 1, 3e-4) << field << " " << z;
    }
  }
}

TEST(PointImage, DefocusOfAPerfectLensIsAUniformDisc) {
  // f/10: the edge of the cone is brighter by a few tenths of a per cent, the difference of tan and sin.
  constexpr double n = 10, defocus = 3;
  const Lens sharp = with_f_number(data_lens("analytic_plano_hyperbolic_100mm"), n);
  for (const double side : {-1.0, 1.0}) {
    const Lens lens = with_film(sharp, sharp.film_z() + side * defocus);
    const Psf image = point_image(lens, {0, -infinity}, {.samples = 1 << 20});
    const double radius = defocus / (2 * n);
    EXPECT_NEAR(image.size.max_radius / radius, 1, 3e-3);
    EXPECT_NEAR(image.size.rms_radius / (radius / std::sqrt(2.0)), 1, 3e-3);
    const double flat = image.mean_throughput / (std::numbers::pi * image.size.max_radius * image.size.max_radius);
    // Skips rings with few rays and the rim; the sampling error of a ring of 16,000 rays is below 1 %.
    for (std::size_t k = 4; k < 63; ++k) EXPECT_NEAR(image.radial_profile[k] / flat, 1, 0.015) << k;
  }
}

TEST(PointImage, PerfectFocusIsAPoint) {
  const Psf image =
      point_image(data_lens("analytic_plano_hyperbolic_100mm"), {0, -infinity}, {.samples = 4096, .pixels = 5});
  EXPECT_EQ(image.counts[12], image.transmitted[0]);
  EXPECT_EQ(image.pixel_mm, 2e-4 / 5);
}

TEST(PointImage, FieldsOutsideTheLensAreDark) {
  const Psf image =
      point_image(data_lens("double_gauss_100mm_f1.35"), {radians(50), -infinity}, {.samples = 1000, .pixels = 8});
  EXPECT_EQ(image.mean_throughput, 0);
  EXPECT_EQ(sum(image), 0u);
  EXPECT_EQ(image.size.max_radius, 0);
  for (const double value : image.radial_profile) EXPECT_EQ(value, 0);
}

TEST(Psf, MissingWavelengthHasNoLight) {
  EXPECT_EQ(Psf{}.ray_weight(0), 0);
  EXPECT_EQ(Psf{}.throughput(0), 0);
  Psf one;
  one.sent = {10}, one.transmitted = {5}, one.sampled_area = {2}, one.entrance_pupil_area = 1;
  EXPECT_EQ(one.throughput(0), 1);
  EXPECT_EQ(one.throughput(1), 0);
}

TEST(PointImage, RefusesInvalidOptions) {
  const Lens lens = front_stop_lens();
  const auto refusal = [&](const PsfOptions& options) {
    return message([&] { point_image(lens, {0, -infinity}, options); });
  };
  expect_tokens(refusal({.samples = 0}), {"point_image", "samples", 0});
  expect_tokens(refusal({.pixels = 0}), {"point_image", "pixels", 0});
  expect_tokens(refusal({.half_width_mm = -1}), {"point_image", "half_width_mm", -1});
  expect_tokens(refusal({.threads = 0}), {"trace_bundle", "threads", 0});
}

TEST(PointImage, StopWithoutRimIsLimitedByOtherRims) {
  const auto [marked, unmarked] = testing::without_the_rim_of_its_stop(testing::open_singlet(10));
  const FieldPoint point{0, -1000};
  const PsfOptions options{.samples = 1 << 12, .pixels = 21};
  const Psf found = point_image(marked, point, options), wanted = point_image(unmarked, point, options);
  EXPECT_NEAR(found.mean_throughput, 1, 0.05);
  EXPECT_EQ(found.mean_throughput, wanted.mean_throughput);
  EXPECT_EQ(found.ray_weight(0), wanted.ray_weight(0));
  const Lens endless = compile(testing::open_singlet());
  EXPECT_EQ(message([&] { point_image(endless, point, options); }), message([&] { pupils(endless); }));
}

}  // namespace psf_test
}  // namespace petzval
