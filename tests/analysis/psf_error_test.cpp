// SPDX-License-Identifier: Apache-2.0
// The stated error of a PSF profile, compared with a run of far more rays.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace psf_error_test {

using testing::expect_error;

std::array<double, 64> light(const Psf& image) {
  std::array<double, 64> result{};
  const double width = image.size.max_radius / 64;
  for (std::size_t k = 0; k < 64; ++k) {
    result[k] = image.radial_profile[k] * std::numbers::pi * width * width * static_cast<double>(2 * k + 1);
  }
  return result;
}

double relative_error(const std::array<double, 64>& found, const std::array<double, 64>& wanted) {
  double errors = 0, squares = 0;
  for (std::size_t k = 0; k < 64; ++k) {
    errors += (found[k] - wanted[k]) * (found[k] - wanted[k]);
    squares += wanted[k] * wanted[k];
  }
  return std::sqrt(errors / squares);
}

TEST(PsfError, HoldsInOtherRuns) {
  int runs = 0, kept = 0;
  for (const char* id : {"double_gauss_100mm_f1.35", "tessar_100mm_f2.8"}) {
    for (const double field : {0.0, 0.15}) {
      for (const int blades : {0, 6}) {
        const Lens stopped = with_f_number(testing::data_lens(id), 5.6);
        const Lens lens = with_iris(with_focus(stopped, 2000), {.blades = blades});
        const FieldPoint point{field, -1000};
        const auto truth = light(point_image(lens, point, {.samples = 1u << 21, .pixels = 8, .seed = 1000}));
        for (std::uint32_t seed = 0; seed < 25; ++seed) {
          constexpr double tolerance = 0.03;
          const auto image =
              point_image(lens, point, {.samples = 1u << 20, .tolerance = tolerance, .pixels = 8, .seed = seed});
          EXPECT_LE(image.error, tolerance);
          EXPECT_LT(image.sent[0], 1u << 20);
          ++runs;
          kept += relative_error(light(image), truth) <= image.error;
        }
      }
    }
  }
  EXPECT_EQ(runs, 200);
  EXPECT_GE(kept, 190);
}

TEST(PsfError, StopsAtTheMaximumOfSamples) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const auto sent = [&](std::uint32_t samples, double tolerance) {
    return point_image(lens, {0, -1000}, {.samples = samples, .tolerance = tolerance, .pixels = 8}).sent[0];
  };
  EXPECT_EQ(sent(1000, 1e-9), 1000u);
  EXPECT_EQ(sent(1u << 17, 1e-9), 1u << 17);
  EXPECT_EQ(sent(100000, 1e-9), 1u << 16);
  EXPECT_EQ(sent(1u << 17, 1), 1u << 14);
  EXPECT_EQ(sent(100000, 0), 100000u);
  expect_error([&] { sent(100, -1); }, {"point_image", "tolerance", -1});
  expect_error([&] { sent(100, std::nan("")); }, {"point_image", "tolerance", "nan"});
}

// Rays sent in steps equal rays sent at once.
TEST(PsfError, DoesNotChangeTheImage) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const auto image = [&](double tolerance) {
    return point_image(lens, {0.1, -1000}, {.samples = 1u << 16, .tolerance = tolerance, .pixels = 64});
  };
  const Psf at_once = image(0), in_steps = image(1e-9);
  EXPECT_EQ(at_once.transmitted, in_steps.transmitted);
  EXPECT_NEAR(at_once.size.rms_radius, in_steps.size.rms_radius, 1e-12);
  EXPECT_NEAR(at_once.error, in_steps.error, 1e-9);
}

// Parts of the samples without a transmitted ray count as dark.
TEST(PsfError, IsNotZeroForFewSamples) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  for (const std::uint32_t samples : {2u, 3u, 5u}) {
    EXPECT_GT(point_image(lens, {0, -1000}, {.samples = samples, .pixels = 8}).error, 0.3) << samples;
  }
}

}  // namespace psf_error_test
}  // namespace petzval
