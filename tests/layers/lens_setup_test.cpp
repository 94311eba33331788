// SPDX-License-Identifier: Apache-2.0
#include "layers/lens_setup.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/geometry.hpp"

namespace {

using petzval::testing::expect_tokens;

using namespace lens_blur;
using petzval::LayerRay;
using petzval::LensRays;

LensFlags thin_lens() {
  LensFlags flags;
  flags.setup.lens.thin_mm = 50, flags.setup.f_number = 0.5, flags.setup.focus_mm = 5000;
  return flags;
}

BlurLens lens_of(const LensFlags& flags, int columns = 80, int rows = 60) {
  return BlurLens(flags, columns, rows, {}, false);
}

std::vector<LayerRay> rays_at(const LensRays& rays, int channel, int column, int row) {
  std::vector<LayerRay> found(rays.count());
  rays.exact_rays_at(channel, column, row, found);
  return found;
}

/// Largest distance of the rays of a pixel from their mean at an inverse depth, px.
double spread(const std::vector<LayerRay>& rays, double inverse_depth) {
  petzval::Vec2<double> mean{0, 0};
  for (const LayerRay& ray : rays)
    mean = mean + (ray.position + ray.slope * inverse_depth) / static_cast<double>(rays.size());
  double most = 0;
  for (const LayerRay& ray : rays) {
    const petzval::Vec2<double> off = ray.position + ray.slope * inverse_depth - mean;
    most = std::max(most, std::hypot(off.x, off.y));
  }
  return most;
}

/// Inverse depth at which the rays of the central pixel meet.
double focus_of(const LensRays& rays, int channel, int column, int row) {
  const std::vector<LayerRay> found = rays_at(rays, channel, column, row);
  double up = 0, down = 0;
  for (const LayerRay& ray : found) {
    const petzval::Vec2<double> off = petzval::Vec2<double>{column + 0.5, row + 0.5} - ray.position;
    up += off.x * ray.slope.x + off.y * ray.slope.y, down += ray.slope.x * ray.slope.x + ray.slope.y * ray.slope.y;
  }
  return up / down;
}

TEST(BlurLens, BlursAPointIntoADiscOfTheFormula) {
  LensFlags flags = thin_lens();
  flags.fov_deg = 40, flags.pattern.rays = 1000;
  const LensRays rays = lens_of(flags).rays(1000, 1);
  for (const double depth : {1500.0, 5000.0, 20000.0}) {
    const double radius = std::abs(1 / depth - 1 / 5000.0) * 50 * 30 / std::tan(petzval::radians(20.0));
    EXPECT_NEAR(spread(rays_at(rays, 0, 13, 50), 1 / depth), radius, 0.002 * radius + 1e-9) << depth;
  }
}

TEST(BlurLens, IsSharpAtItsFocusWithASecondRimOrAberrations) {
  for (const double f_number : {0.7, 1.4, 4.0}) {
    LensFlags rim = thin_lens(), expressive = thin_lens();
    rim.setup.f_number = expressive.setup.f_number = f_number;
    rim.setup.camera.bokeh.lens_ratio = 1.1;
    expressive.setup.camera.expressive.film_offsets = {{{0, 0}, 0}, {{9, 0}, 0.001}, {{0, 9}, 0.001}};
    for (const LensFlags& flags : {rim, expressive}) {
      const LensRays rays = lens_of(flags).rays(1000, 1);
      const std::vector<LayerRay> middle = rays_at(rays, 0, 40, 30);
      EXPECT_LT(spread(middle, 1 / 5000.0), 0.02 * spread(middle, 1 / 1500.0)) << f_number;
    }
  }
}

TEST(BlurLens, FocusesATiltedFilmOnThePlaneOfItsHinge) {
  // The image of the plane (0, sin 30, cos 30) . x = 2 cos 30 m is tilted by 0.848 degrees.
  LensFlags flags = thin_lens();
  flags.setup.f_number = 2.5, flags.setup.focus_mm = 2000,
  flags.setup.film.tilt_rad = petzval::radians(-0.848136346759917);
  BlurLens lens = lens_of(flags);
  const LensRays rays = lens.rays(500, 1);
  const double d = 2000 * std::cos(petzval::radians(30.0));
  for (const int row : {0, 29, 59}) {
    const double up = -(row + 0.5 - lens.layers().axis.y) / lens.layers().focal_px;
    EXPECT_NEAR(focus_of(rays, 0, 70, row) * d, 0.5 * up + std::cos(petzval::radians(30.0)), 1e-9) << row;
  }
  // A swing moves the right side nearer or farther.
  flags.setup.film.tilt_rad = 0, flags.setup.film.swing_rad = petzval::radians(0.848136346759917);
  const LensRays swung = lens_of(flags).rays(500, 1);
  const double left = focus_of(swung, 0, 0, 30), right = focus_of(swung, 0, 79, 30);
  EXPECT_NEAR(left + right, 2 * 1 / 2000.0, 1e-9);
  EXPECT_NEAR(std::abs(right - left) * d, 0.5 * 79 / lens.layers().focal_px, 1e-9);
}

TEST(BlurLens, HasAFocusForEachColour) {
  LensFlags flags = thin_lens();
  flags.wavelengths = "rgb";
  const LensRays rays = lens_of(flags).rays(1000, 1);
  ASSERT_EQ(rays.channels(), 3);
  const double red = focus_of(rays, 0, 40, 30), green = focus_of(rays, 1, 40, 30), blue = focus_of(rays, 2, 40, 30);
  // BK7 at 650, 510 and 475 nm and at the d line, where the focal length is 50 mm.
  const auto shifted = [](double n) { return 1 / 5000.0 + ((n - 1) / 0.516800034500588 - 1) / 50; };
  EXPECT_NEAR(red, shifted(1.514520308564780), 2e-8);
  EXPECT_NEAR(green, shifted(1.520768869927823), 2e-8);
  EXPECT_NEAR(blue, shifted(1.523210540918557), 2e-8);
}

TEST(BlurLens, FocusesASingletAndAPrescription) {
  LensFlags singlet;
  singlet.singlet = "100,-100,8,N-BK7", singlet.setup.focus_mm = 3000, singlet.setup.f_number = 8;
  LensFlags file;
  file.setup.lens.file = std::string(PETZVAL_TEST_DATA) + "/lenses/double_gauss_52mm_f1.8.json",
  file.setup.focus_mm = 3000;
  for (const LensFlags& flags : {singlet, file}) {
    const LensRays rays = lens_of(flags, 300, 200).rays(1000, 1);
    EXPECT_FALSE(rays.shift_invariant());
    const std::vector<LayerRay> middle = rays_at(rays, 0, 150, 100);
    EXPECT_LT(spread(middle, 1 / 3000.0), 0.15 * spread(middle, 1 / 1000.0));
    EXPECT_LT(spread(middle, 1 / 3000.0), 0.3 * spread(middle, 0));
    EXPECT_NEAR(focus_of(rays, 0, 150, 100) * 3000, 1, 0.05);
  }
}

TEST(BlurLens, RefusesInvalidOptions) {
  const auto said = [](const auto& change) {
    LensFlags flags = thin_lens();
    change(flags);
    return petzval::testing::message([&] { lens_of(flags).rays(1000, 1); });
  };
  const auto says = [&](const auto& change, const std::vector<petzval::testing::Token>& tokens) {
    expect_tokens(said(change), tokens);
  };
  says([](LensFlags&) {}, {"no error"});
  says([](LensFlags& f) { f.setup.lens.thin_mm = 0; }, {"--thin-lens", "LENS", "--singlet"});
  says([](LensFlags& f) { f.singlet = "50,-50,5,N-BK7"; }, {2, "--thin-lens", "--singlet"});
  says([](LensFlags& f) { f.setup.f_number.reset(); }, {"--thin-lens", "--f-number"});
  says([](LensFlags& f) { f.setup.focus_mm = 50; }, {50});
  says([](LensFlags& f) { f.setup.f_number = 0.01; }, {"lens"});
  for (const char* flawed : {"50,-50,5", "50,x,5,N-BK7", "50,-50,5,MOON", "50,-50,5,N-BK7,1"}) {
    says([&](LensFlags& f) { f.setup.lens.thin_mm = 0, f.setup.f_number.reset(), f.singlet = flawed; }, {"--singlet"});
  }
}

}  // namespace
