// SPDX-License-Identifier: Apache-2.0
// The light that the edges of the pupil diffract, against Airy's rings and the Fourier transform of the pupil.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace starburst_test {

constexpr double half_mm = 0.3;
constexpr int side = 512;

Lens double_gauss(double f_number, int blades, double nm = d_line_nm) {
  const std::array wavelengths{nm};
  const Lens wide =
      compile(testing::data_prescription("double_gauss_52mm_f1.8"), wavelengths, {.missing_glass = MissingGlass::abbe});
  const Lens lens = with_f_number(wide, f_number);
  return blades > 0 ? with_iris(lens, Iris{.blades = blades}) : lens;
}

FieldPoint star(double degrees) {
  return {.field_rad = radians(degrees), .z = -std::numeric_limits<double>::infinity()};
}

/// The starburst of a star about a film point, as fractions of the light of the image.
std::vector<float> starburst(const Lens& lens, const FieldPoint& field, const Vec2<double>& centre) {
  Film film;
  film.columns = film.rows = side;
  film.width_mm = film.height_mm = 2 * half_mm;
  film.shift_x_mm = centre.x, film.shift_y_mm = centre.y;
  const std::array wavelengths{Wavelength{}};
  std::vector<float> result(static_cast<std::size_t>(side * side));
  const ScenePoint light = scene_point(lens, field);
  const GhostOptions options{.max_pairs = 0, .starburst = true};
  add_ghosts(lens, light, film, wavelengths, result, options);
  const double power = ghost_audit(lens, light, options, 4096).image * ghost_pairs(lens, light, options).entering_mm2;
  const double pixel_mm = 2 * half_mm / side;
  for (float& value : result) value *= static_cast<float>(pixel_mm * pixel_mm / power);
  return result;
}

/// Sums over twelve sectors of a ring from 0.1 to 0.2 mm about the middle of a picture.
std::array<double, 12> sectors(const std::function<double(std::size_t)>& pixel, std::size_t columns) {
  std::array<double, 12> result{};
  const double pixel_mm = 2 * half_mm / static_cast<double>(columns);
  for (std::size_t i = 0; i < columns * columns; ++i) {
    const double x = (static_cast<double>(i % columns) + 0.5) * pixel_mm - half_mm,
                 y = half_mm - (static_cast<double>(i / columns) + 0.5) * pixel_mm, r = std::hypot(x, y);
    if (r < 0.1 || r > 0.2) continue;
    const double turns = std::atan2(x, y) / (2 * std::numbers::pi) + 1 + 1.0 / 24;
    result[static_cast<std::size_t>(12 * turns) % 12] += pixel(i);
  }
  return result;
}

double sum(const std::array<double, 12>& of) {
  double result = 0;
  for (const double value : of) result += value;
  return result;
}

TEST(Starburst, OfARoundPupilHasTheLightOfAirysRings) {
  for (const double nm : {486.1, 656.3}) {
    const Lens lens = double_gauss(8, 0, nm);
    const auto picture = starburst(lens, star(0), {0, 0});
    // The mean of J0^2 + J1^2 far from the centre.
    const double expected = 2 * nm * 1e-6 * real_f_number(lens) / std::pow(std::numbers::pi, 2) * (1 / 0.1 - 1 / 0.2);
    EXPECT_NEAR(sum(sectors([&](std::size_t i) { return picture[i]; }, side)) / expected, 1, 0.03) << nm;
  }
}

TEST(Starburst, OfBladesIsTheMeanOfTheFourierTransformOfThePupil) {
  for (const double degrees : {0.0, 15.0}) {
    const Lens lens = double_gauss(11, degrees > 0 ? 8 : 6);
    const DiffractionPsf psf = diffraction_psf(lens, star(degrees), {.pixels = 1024, .half_width_mm = 2 * half_mm});
    const auto picture = starburst(lens, star(degrees), psf.centre);
    double power = 0;
    for (const double value : psf.irradiance) power += value;
    // The middle quarter, in which the transform loses little light between its samples.
    const auto expected =
        sectors([&](std::size_t i) { return psf.irradiance[(i / side + 256) * 1024 + i % side + 256] / power; }, side);
    const auto found = sectors([&](std::size_t i) { return picture[i]; }, side);
    EXPECT_NEAR(sum(found) / sum(expected), 1, 0.08);
    for (std::size_t k = 0; k < 12; ++k) EXPECT_NEAR(found[k], expected[k], 0.2 * sum(expected) / 12) << k;
  }
}

// An error at a corner of the pupil sends light out of the spikes, whose half width is 2 degrees at 0.2 mm.
TEST(Starburst, OfSixBladesLiesInSixSpikes) {
  const Lens lens = double_gauss(11, 6);
  for (int azimuth = 5; azimuth < 360; azimuth += 90) {
    FieldPoint field = star(7);
    field.azimuth_rad = radians(azimuth);
    const auto picture = starburst(lens, field, diffraction_psf(lens, field, {.pixels = 64}).centre);
    double all = 0, outside = 0;
    for (int i = 0; i < side * side; ++i) {
      const double x = i % side + 0.5 - side / 2, y = side / 2 - (i / side + 0.5);
      if (std::hypot(x, y) * 2 * half_mm < 0.2 * side) continue;
      const float light = picture[static_cast<std::size_t>(i)];
      all += light;
      if (std::abs(std::remainder(degrees(std::atan2(y, x)), 60)) > 4) outside += light;
    }
    EXPECT_LT(outside, 1e-3 * all) << azimuth;
  }
}

}  // namespace starburst_test
}  // namespace petzval
