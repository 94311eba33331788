// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/focus/focus.hpp"
#include "renderer/render.hpp"

namespace renderer {
namespace {

constexpr double request = 0.1;

/// A lamp that fills the left half of the picture, and a wall in the right half, lit by a lamp outside the picture.
SceneDescription half_flat() {
  SceneDescription d;
  d.objects.push_back(
      {"glow", Quad{{-600, -600, -1000}, {600, 0, 0}, {0, 1200, 0}}, Diffuse{{.colour = Rgb(0)}}, Rgb(1)});
  d.objects.push_back({"wall", Quad{{0, -600, -1000}, {600, 0, 0}, {0, 1200, 0}}, Diffuse{}});
  d.objects.push_back({"lamp", Sphere{{320, 0, -800}, 80}, Diffuse{{.colour = Rgb(0)}}, Rgb(20)});
  return d;
}

class Noise : public testing::TestWithParam<Integrator> {
 protected:
  PictureSums picture(const Effort& effort, std::uint64_t seed) const {
    const PathColourSource colours(ColourMode::d);
    const LensCamera camera({lens_, film_, {.normalisation = petzval::Normalisation::unity_on_axis}}, {});
    PictureSums sums(film_.columns, film_.rows);
    std::vector<std::size_t> tiles(sums.tiles());
    std::iota(tiles.begin(), tiles.end(), std::size_t{0});
    const UnitTracer tracer(scene_, camera, colours, GetParam(), seed);
    render(tracer, sums, tiles, effort, 1, [] {});
    return sums;
  }
  static constexpr Effort adaptive{.samples = 1024, .seconds = {}, .noise = request};

  const Scene scene_{half_flat()};
  const petzval::Lens lens_ = petzval::with_focus(petzval::testing::data_lens("double_gauss_100mm_f2_28deg"), 1000);
  const petzval::Film film_{.width_mm = 36, .height_mm = 9, .columns = 64, .rows = 16};
};

TEST_P(Noise, NoisyTilesGetMoreSamplesUntilTheNoiseIsBelowTheRequest) {
  const PictureSums sums = picture(adaptive, 1);
  const auto noise = sums.noise();
  for (std::size_t t = 0; t < sums.tiles(); ++t) {
    EXPECT_LE(noise[t].relative(adaptive.floor), request) << t;
  }
  EXPECT_EQ(sums.samples(0), 32u);
  EXPECT_GT(std::max(sums.samples(2), sums.samples(3)), 64u);
}

// Seeds are independent: their mean has the expectation of the uniform picture, and their scatter is the noise.
TEST_P(Noise, MeanOverSeedsEqualsTheUniformPicture) {
  const PictureSums uniform = picture({.samples = 1024, .seconds = {}}, 99);
  constexpr std::uint64_t seeds = 6;
  std::vector<double> sum(uniform.tiles()), squares(sum), pixel_errors(sum);
  const petzval::RgbImage truth = uniform.picture();
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const PictureSums sums = picture(adaptive, seed);
    const petzval::RgbImage image = sums.picture();
    for (std::size_t t = 0; t < sums.tiles(); ++t) {
      const double mean = sums.luminance(t).mean;
      sum[t] += mean / seeds, squares[t] += mean * mean / seeds;
      const PixelBlock b = sums.block(t);
      for (int y = b.y; y < b.y + b.height; ++y) {
        for (int x = b.x; x < b.x + b.width; ++x) {
          const double error = static_cast<double>(image.pixel(x, y)[1] - truth.pixel(x, y)[1]);
          pixel_errors[t] += error * error / (b.width * b.height * double{seeds});
        }
      }
    }
  }
  for (std::size_t t = 0; t < uniform.tiles(); ++t) {
    const Estimate expected = uniform.luminance(t);
    const double scatter = std::sqrt(std::max(squares[t] - sum[t] * sum[t], 0.0) / (seeds - 1));
    EXPECT_NEAR(sum[t], expected.mean, 4 * std::hypot(scatter, expected.standard_error) + 1e-6) << t;
    // The noise of a tile is known to 18 %.
    EXPECT_LT(std::sqrt(pixel_errors[t]) / std::max(expected.mean, adaptive.floor), 1.4 * request) << t;
  }
}

std::string name_of(const testing::TestParamInfo<Integrator>& info) {
  constexpr std::array names{"path", "light", "bidirectional"};
  return names[static_cast<std::size_t>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Integrators, Noise, testing::Values(Integrator::path, Integrator::bidirectional), name_of);

}  // namespace
}  // namespace renderer
