// SPDX-License-Identifier: Apache-2.0
// Rays from the film and connections to the lens give the same irradiance for a small light.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"

namespace petzval {
namespace reciprocity_test {

constexpr double pi = std::numbers::pi;
constexpr std::uint32_t replicates = 16, samples = 1 << 14;

/// A uniform square light perpendicular to the axis.
struct Light {
  Vec3<double> centre;
  double side;
};

struct Estimate {
  double mean = 0, sigma = 0;
};

/// Mean and standard deviation of the mean over independent shifts of the sample points.
template <class Once>
Estimate estimate(const Once& once) {
  double sum = 0, squares = 0;
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const double value = once(r);
    sum += value, squares += value * value;
  }
  const double mean = sum / replicates;
  return {mean, std::sqrt(std::max(squares / replicates - mean * mean, 0.0) / (replicates - 1))};
}

/// Mean irradiance of the film by connections from the light, and the bounding box of its image.
struct SceneSide {
  Estimate irradiance;
  double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9;
};

SceneSide from_light(const Camera& camera, const Light& light) {
  SceneSide result;
  result.irradiance = estimate([&](std::uint32_t replicate) {
    const testing::Kronecker<4> random(2 * replicate);
    double sum = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const auto [a, b, u, v] = random(i);
      const Vec3<double> point = light.centre + Vec3<double>{a - 0.5, b - 0.5, 0} * light.side;
      const ImportanceSample s = camera.sample_importance(point, u, v);
      if (!s) continue;
      sum += s.importance.we * std::abs(s.direction.z) / s.pdf * light.side * light.side / samples;
      const FilmPoint& f = s.importance.film;
      result.low_x = std::min(result.low_x, f.x), result.high_x = std::max(result.high_x, f.x);
      result.low_y = std::min(result.low_y, f.y), result.high_y = std::max(result.high_y, f.y);
    }
    return sum;
  });
  return result;
}

/// Mean irradiance of the film by camera samples within the image of the light.
Estimate from_film(const Camera& camera, const Light& light, const SceneSide& scene) {
  const double margin_x = 0.02 * (scene.high_x - scene.low_x), margin_y = 0.02 * (scene.high_y - scene.low_y);
  const double left = scene.low_x - margin_x, width = scene.high_x + margin_x - left;
  const double bottom = scene.low_y - margin_y, height = scene.high_y + margin_y - bottom;
  constexpr std::uint32_t count = 4 * samples;
  std::array<std::vector<double>, 11> v;
  for (auto& values : v) values.resize(count);
  const auto at = [&](std::size_t k) { return v[k].data(); };
  return estimate([&](std::uint32_t replicate) {
    const testing::Kronecker<4> random(2 * replicate + 1);
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto [a, b, p, q] = random(i);
      v[0][i] = left + a * width, v[1][i] = bottom + b * height;
      v[2][i] = p, v[3][i] = q;
    }
    camera.sample<double>(count, {at(0), at(1), at(2), at(3)}, {{at(4), at(5), at(6), at(7), at(8), at(9)}, at(10)});
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double t = (light.centre.z - v[6][i]) / v[9][i];
      const double x = v[4][i] + t * v[7][i] - light.centre.x, y = v[5][i] + t * v[8][i] - light.centre.y;
      if (t > 0 && std::max(std::abs(x), std::abs(y)) <= light.side / 2) sum += v[10][i];
    }
    return sum / count * width * height / camera.film().area_mm2();
  });
}

const Film wide{.width_mm = 36, .height_mm = 24}, square{.width_mm = 24, .height_mm = 24},
    retina{.width_mm = 6, .height_mm = 6};

struct Case {
  std::string lens;
  Film film;
  double degrees, distance;  ///< field angle of the light, distance from the front vertex in mm
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.lens << " at " << c.degrees; }

void expect_reciprocity(const Lens& lens, const Film& film, const CameraOptions& options, double degrees,
                        double distance, double tolerance = 0, double side = 0.04, double precision = 2e-3) {
  const Camera camera(lens, film, options);
  const double angle = degrees * pi / 180;
  // Off the meridional planes, so that no symmetry hides an error.
  const Light light{{0.3 * distance * std::sin(angle), 0.954 * distance * std::sin(angle), -distance * std::cos(angle)},
                    side * distance};
  const SceneSide scene = from_light(camera, light);
  const Estimate film_side = from_film(camera, light, scene);
  ASSERT_GT(scene.irradiance.mean, 0);
  const double sigma = std::hypot(scene.irradiance.sigma, film_side.sigma);
  EXPECT_LT(3 * sigma, precision * film_side.mean);
  EXPECT_NEAR(scene.irradiance.mean, film_side.mean, 4 * sigma + tolerance * film_side.mean)
      << "sigma " << sigma / film_side.mean << ", ratio less 1 " << scene.irradiance.mean / film_side.mean - 1;
  ::testing::Test::RecordProperty("ratio_less_1", std::to_string(scene.irradiance.mean / film_side.mean - 1));
}

class Reciprocity : public ::testing::TestWithParam<Case> {};

TEST_P(Reciprocity, HoldsForExactRays) {
  const auto& [id, film, degrees, distance] = GetParam();
  const Lens lens = testing::data_lens(id);
  for (const ModelKind model : {ModelKind::exact_float, ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    expect_reciprocity(lens, film, {.model = model}, degrees, distance);
  }
}

TEST(Reciprocity, HoldsForUnityOnAxis) {
  expect_reciprocity(testing::data_lens("eye_gullstrand_le_grand"), retina,
                     {.model = ModelKind::exact_float, .normalisation = Normalisation::unity_on_axis}, 3, 300);
}

TEST(Reciprocity, HoldsUnderWater) {
  Prescription p = testing::data_prescription("tessar_100mm_f2.8");
  p.object_space.nd = 1.333;
  p.surfaces.back().thickness = 150;
  expect_reciprocity(compile(p), wide, {.model = ModelKind::exact_double}, 3, 900, 0, 0.04, 1e-2);
}

// The last lens has water in image space.
INSTANTIATE_TEST_SUITE_P(
    Lenses, Reciprocity,
    ::testing::Values(Case{"double_gauss_100mm_f2_28deg", wide, 0, 2500},
                      Case{"double_gauss_100mm_f2_28deg", wide, 6, 2500}, Case{"tessar_100mm_f2.8", wide, 0, 900},
                      Case{"tessar_100mm_f2.8", wide, 6, 900}, Case{"fisheye_8mm_f2.8", square, 0, 600},
                      Case{"fisheye_8mm_f2.8", square, 70, 600}, Case{"eye_gullstrand_le_grand", retina, 5, 300}));

TEST(Reciprocity, HoldsCloseToTheLens) {
  expect_reciprocity(testing::data_lens("double_gauss_100mm_f2_28deg"), wide, {.model = ModelKind::exact_double}, 3,
                     120, 0, 0.5, 5e-3);
}

TEST(Reciprocity, HoldsForCylinders) {
  for (const ModelKind model : {ModelKind::thin, ModelKind::thick, ModelKind::polynomial(7), ModelKind::exact_double}) {
    SCOPED_TRACE(name(model));
    expect_reciprocity(testing::data_lens("anamorphic_60mm_2x"), wide, {.model = model}, 5, 3000,
                       model == ModelKind::polynomial(7) ? 1e-3 : 0, 0.04, 1e-2);
  }
}

TEST(Reciprocity, HoldsForModelsWithoutRims) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  for (const ModelKind model :
       {ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::thick, ModelKind::polynomial(7)}) {
    SCOPED_TRACE(name(model));
    // Polynomials conserve etendue within their fit error.
    expect_reciprocity(lens, wide, {.model = model}, 6, 2500, model == ModelKind::polynomial(7) ? 1e-3 : 0);
  }
}

TEST(Reciprocity, HoldsForAnIrisWithEdges) {
  const Lens lens = with_iris(testing::data_lens("double_gauss_100mm_f2_28deg"),
                              {.blades = 5, .roundness = 0.5, .rotation_rad = 0.3});
  const Film tilted{.width_mm = 36, .height_mm = 24, .tilt_rad = 0.15, .swing_rad = -0.1};
  expect_reciprocity(lens, wide, {.model = ModelKind::polynomial(7)}, 6, 2500, 1e-3, 0.04, 4e-3);
  for (const ModelKind model :
       {ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::thick, ModelKind::exact_float}) {
    SCOPED_TRACE(name(model));
    expect_reciprocity(lens, wide, {.model = model}, 6, 2500, 0, 0.04, 4e-3);
    expect_reciprocity(lens, tilted, {.model = model}, 6, 2500, 0, 0.04, 4e-3);
  }
}

// Defocused lights, with distances and extents from the surface.
TEST(Reciprocity, HoldsForFocalSurfaces) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  Film tilted{.width_mm = 36, .height_mm = 24, .tilt_rad = 0.1, .swing_rad = -0.07};
  Film placed = wide;
  placed.z_mm = tilted.z_mm = lens.film_z();
  std::vector<FocalPoint> points(4);
  points[0].film_point = {-9, -3}, points[0].inverse_distance = 1 / 1500., points[0].extent_stops = 0.5;
  points[1].film_point = {8, -9}, points[1].inverse_distance = 0, points[1].extent_stops = 1;
  points[2].film_point = {-3, 8}, points[2].inverse_distance = 1 / 4000.;
  points[3].film_point = {-1, -11}, points[3].inverse_distance = 1 / 2500.;
  const ExpressiveLens expressive{.power = {{0, 1}, {0.7, 1.01}, {1, 0.98}},
                                  .film_offsets = {{{0, 0}, 0}, {{14, 3}, 0.7}, {{-14, 4}, -0.5}}};
  for (const ModelKind model : {ModelKind::thin, ModelKind::thick, ModelKind::thin_two_disc}) {
    SCOPED_TRACE(name(model));
    for (const Film& film : {placed, tilted}) {
      const CameraOptions options{
          .model = model, .focal_surface = FocalSurface(thick_lens(lens), film, points), .expressive = expressive};
      expect_reciprocity(lens, film, options, 6, 2500, 0, 0.04, 5e-3);
    }
  }
}

TEST(Reciprocity, HoldsForTiltedFilms) {
  constexpr double degree = pi / 180;
  const Film eight{.width_mm = 36, .height_mm = 24, .tilt_rad = 8 * degree, .swing_rad = -3 * degree};
  const Film twenty{
      .width_mm = 36, .height_mm = 24, .shift_x_mm = 2, .tilt_rad = -5 * degree, .swing_rad = 20 * degree};
  const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  for (const auto& [film, model] :
       {std::pair{eight, ModelKind::thin_two_disc}, std::pair{eight, ModelKind::exact_float},
        std::pair{twenty, ModelKind::pinhole}, std::pair{twenty, ModelKind::thick},
        std::pair{twenty, ModelKind::polynomial(7)}, std::pair{twenty, ModelKind::exact_double}}) {
    SCOPED_TRACE(name(model));
    expect_reciprocity(lens, film, {.model = model}, 6, 2500, model == ModelKind::polynomial(7) ? 1e-3 : 0);
  }
  // Far off the axis a pinhole ray differs from the mean ray of the pupil that it represents.
  expect_reciprocity(lens, {.width_mm = 30, .height_mm = 30, .shift_y_mm = -14, .tilt_rad = 20 * degree},
                     {.model = ModelKind::pinhole}, 13, 2500);
  expect_reciprocity(testing::data_lens("fisheye_8mm_f2.8"),
                     {.width_mm = 16, .height_mm = 16, .tilt_rad = 6 * degree, .swing_rad = 6 * degree},
                     {.model = ModelKind::exact_double}, 50, 600, 0, 0.04, 3e-3);
  for (const ModelKind model : {ModelKind::polynomial(7), ModelKind::exact_double}) {
    expect_reciprocity(testing::data_lens("anamorphic_60mm_2x"),
                       {.width_mm = 20, .height_mm = 14, .tilt_rad = 8 * degree, .swing_rad = 4 * degree},
                       {.model = model}, 3, 3000, model == ModelKind::polynomial(7) ? 1e-3 : 0, 0.04, 1e-2);
  }
}

}  // namespace reciprocity_test
}  // namespace petzval
