// SPDX-License-Identifier: Apache-2.0
// Tilted films: pupils and exposures, compared with rays traced from their points by other code.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "camera_parts.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/surface_box.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace tilted_exposure_test {

using testing::pose_of;
using testing::random_samples;
using testing::Samples;
using testing::shifted;
using testing::tilted_by;
using testing::wide;

const Film square{.width_mm = 16, .height_mm = 16};

struct Case {
  std::string lens;
  double f_number;  ///< 0 if wide open
  Film film;
  double tilt_deg, swing_deg;
  double useful;  ///< smallest fraction of samples that pass

  Lens focused() const {
    const Lens open = testing::data_lens(lens);
    return f_number > 0 ? with_f_number(open, f_number) : open;
  }
  Film tilted_film() const { return tilted_by(film, tilt_deg, swing_deg); }
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.lens << " at f/" << c.f_number << ", " << c.tilt_deg << " and " << c.swing_deg << " degrees";
}

/// Traced rays from a film point through points of a plane across the axis: true if a ray passes, and the irradiance
/// per area of the plane.
struct Traced {
  std::vector<bool> passes;
  std::vector<double> per_area;
};

Traced traced(const Lens& lens, const Film& pose, const FilmPoint& film, double z,
              const std::vector<std::array<double, 2>>& places) {
  const Vec3<double> from = pose.position(film), normal = pose.normal();
  std::vector<Ray<double>> rays;
  Traced result;
  for (const auto& [x, y] : places) {
    const Vec3<double> along = Vec3<double>{x, y, z} - from;
    const double length = glm::length(along);
    const double towards = along.z < 0 ? 1 : -1;
    rays.push_back({{x, y, z}, along * (towards / length)});
    result.per_area.push_back(std::abs(along.z) * glm::dot(along, normal) * -towards / std::pow(length, 4));
  }
  std::vector<TracedRay<double>> ends(rays.size());
  trace<double>(lens, rays, ends.data(), {.travel = Travel::to_scene});
  for (std::size_t i = 0; i < ends.size(); ++i) {
    result.passes.push_back(ends[i].transmitted() && result.per_area[i] > 0);
  }
  return result;
}

class TiltedFilms : public ::testing::TestWithParam<Case> {};

TEST_P(TiltedFilms, SamplesPassAndCoverThePupil) {
  const Lens lens = GetParam().focused();
  const testing::CameraParts parts(lens, GetParam().tilted_film(), ModelKind::exact_double);
  const Camera camera(lens, GetParam().tilted_film(), {.model = ModelKind::exact_double});
  const camera_detail::TiltedFilm& tilted = *parts.tilted;
  const Film pose = pose_of(lens, camera.film());
  const double z = parts.pupils().space().pupil_z;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit;
  double useful = 0, worst = 1, missed = 0;
  int lit = 0;
  constexpr int points = 24, samples = 1500;
  const auto film_points = random_samples(camera.film(), points, 9);
  for (int i = 0; i < points; ++i) {
    const FilmPoint corner = camera.film().point(i % 2 * camera.film().columns, i / 2 * camera.film().rows);
    const FilmPoint film = i < 4 ? corner : FilmPoint{film_points.film_x[i], film_points.film_y[i]};
    const FilmPoint key = tilted.plane(0).virtual_point(film);
    if (tilted.pupils().area(key) == 0) continue;
    std::vector<std::array<double, 2>> inside, beside, box;
    const Vec2<double> middle = tilted.pupils().middle(key);
    double reach = 0;
    for (int k = 0; k < samples; ++k) {
      const PupilSample s = tilted.pupils().sample(key, unit(random), unit(random));
      const PupilSample edge = tilted.pupils().sample(key, unit(random), 1);
      const double out = std::sqrt(1 + 0.1 * unit(random));
      inside.push_back({s.x, s.y});
      beside.push_back({middle.x + out * (edge.x - middle.x), middle.y + out * (edge.y - middle.y)});
      reach = std::max(reach, std::hypot(edge.x - middle.x, edge.y - middle.y));
    }
    for (int k = 0; k < samples; ++k) {
      box.push_back({middle.x + 1.5 * reach * (2 * unit(random) - 1), middle.y + 1.5 * reach * (2 * unit(random) - 1)});
    }
    const auto part = [&](const std::vector<bool>& passes) {
      return static_cast<double>(std::count(passes.begin(), passes.end(), true)) / samples;
    };
    const auto in = traced(lens, pose, film, z, inside).passes;
    if (part(in) == 0) continue;
    ++lit;
    useful += part(in);
    worst = std::min(worst, part(in));
    const auto out = traced(lens, pose, film, z, beside).passes, all = traced(lens, pose, film, z, box).passes;
    for (int k = 0; k < samples; ++k) {
      const auto outside = [&](const std::array<double, 2>& p) { return !tilted.pupils().contains(key, p[0], p[1]); };
      if (out[k] && outside(beside[k])) missed += 0.1 / samples;
      if (all[k] && outside(box[k])) missed += 1 / (points * part(all) * samples);
    }
  }
  ASSERT_GT(lit, points / 2);
  RecordProperty("useful", std::to_string(useful / lit));
  RecordProperty("worst", std::to_string(worst));
  EXPECT_GT(useful / lit, GetParam().useful);
  EXPECT_LE(missed / lit, 1e-5);
}

/// Irradiance of a film point in a scene of radiance 1, by a grid of rays through the plane of the last vertex.
double irradiance(const Lens& lens, const Film& pose, const FilmPoint& point) {
  const pupil_detail::SurfaceBox face = pupil_detail::last_surface_box(lens);
  // A coarse grid over the last surface finds the pupil, a fine grid over the pupil integrates.
  std::array<double, 2> low{-1.6 * face.half, -1.6 * face.half}, high{1.6 * face.half, 1.6 * face.half};
  double sum = 0;
  for (const int side : {200, 600}) {
    const std::array<double, 2> step{(high[0] - low[0]) / side, (high[1] - low[1]) / side};
    std::vector<std::array<double, 2>> grid;
    for (int i = 0; i < side * side; ++i) {
      grid.push_back({low[0] + step[0] * (i % side + 0.5), low[1] + step[1] * (i / side + 0.5)});
    }
    const auto [passes, per_area] = traced(lens, pose, point, face.vertex_z, grid);
    std::swap(low, high);
    sum = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (!passes[i]) continue;
      sum += per_area[i] * step[0] * step[1];
      for (const std::size_t k : {0u, 1u}) {
        low[k] = std::min(low[k], grid[i][k] - step[k]);
        high[k] = std::max(high[k], grid[i][k] + step[k]);
      }
    }
  }
  return sum;
}

double mean_weight(const Camera& camera, const FilmPoint& film) {
  Samples<double> samples;
  constexpr std::uint32_t count = 32768;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto uv = owen_sobol(i, 5);
    const double u = uv.x, v = uv.y;
    samples.add(film.x, film.y, u, v);
  }
  samples.run(camera);
  double sum = 0;
  for (const double w : samples.weights) sum += w / count;
  return sum;
}

void expect_exposures(const Lens& lens, const Film& film) {
  constexpr double corner = 0.45;
  const Camera camera(lens, film, {.model = ModelKind::exact_double});
  for (const auto& [x, y] : {std::array{0.0, 0.0}, {corner, corner}, {-0.4, corner}, {0.1, -0.48}}) {
    const FilmPoint point{film.shift_x_mm + x * film.width_mm, film.shift_y_mm + y * film.height_mm};
    EXPECT_NEAR(mean_weight(camera, point) / irradiance(lens, pose_of(lens, film), point), 1, 2e-3)
        << point.x << ", " << point.y;
  }
}

TEST_P(TiltedFilms, ExposureEqualsTracedRays) { expect_exposures(GetParam().focused(), GetParam().tilted_film()); }

INSTANTIATE_TEST_SUITE_P(
    Films, TiltedFilms,
    ::testing::Values(Case{"double_gauss_100mm_f2.0", 0, wide, 8, 0, 0.95},
                      Case{"double_gauss_100mm_f2.0", 0, wide, 20, 0, 0.90},
                      Case{"double_gauss_100mm_f2.0", 4, wide, 0, -8, 0.95},
                      Case{"double_gauss_100mm_f2.0", 22, shifted, 12, 15, 0.95},
                      Case{"double_gauss_100mm_f2.0", 2.8, shifted, -20, 10, 0.90},
                      Case{"tessar_100mm_f2.8", 0, shifted, 8, 8, 0.95}, Case{"fisheye_10mm_f4", 0, square, 8, 4, 0.90},
                      Case{"anamorphic_60mm_2x", 0, {.width_mm = 20, .height_mm = 14}, 6, 6, 0.95},
                      Case{"anamorphic_60mm_2x", 32, {.width_mm = 20, .height_mm = 14}, -5, 6, 0.95},
                      Case{"catadioptric_mangin_1000mm_f7.5", 0, {.width_mm = 20, .height_mm = 20}, 8, 0, 0.9}));

// With the exit pupil at infinity, pupils lie in the plane of the last vertex.
TEST(TiltedFilm, TelecentricExposureEqualsTracedRays) {
  Prescription p;
  p.name = "telecentric";
  p.surfaces = {{.thickness = 98.6, .semi_diameter = 8, .stop = true},
                {.radius = 102.16, .thickness = 4, .medium = {.nd = 1.5168}, .semi_diameter = 30},
                {.radius = -102.16, .thickness = 98.6, .semi_diameter = 30}};
  expect_exposures(compile(p), tilted_by({.width_mm = 20, .height_mm = 20}, 15, -10));
}

// Tilt changes the exposure error of each model by less than 0.8 %.
TEST(TiltedFilm, TiltKeepsTheExposureErrorOfEveryModel) {
  const Lens lens = with_f_number(testing::data_lens("double_gauss_100mm_f2.0"), 4);
  const Film film = tilted_by(wide, 10, 5);
  const Camera exact(lens, film, {.model = ModelKind::exact_double}),
      upright(lens, wide, {.model = ModelKind::exact_double});
  for (const ModelKind model : models()) {
    const Camera tilted(lens, film, {.model = model}), straight(lens, wide, {.model = model});
    for (const FilmPoint& point : {FilmPoint{0, 0}, FilmPoint{-17, 11}, FilmPoint{16, -4}}) {
      const double error = mean_weight(tilted, point) / mean_weight(exact, point) - 1;
      const double upright_error = mean_weight(straight, point) / mean_weight(upright, point) - 1;
      EXPECT_NEAR(error, upright_error, 8e-3) << name(model) << " at " << point.x << ", " << point.y;
    }
  }
}

TEST(TiltedFilm, PinholeSamplesAllPass) {
  for (const double tilt : {0.01, 20.0}) {
    const Camera camera(testing::data_lens("double_gauss_100mm_f2.0"), tilted_by(shifted, tilt, tilt / 2),
                        {.model = ModelKind::pinhole});
    auto samples = random_samples(camera.film(), 20000);
    samples.run(camera);
    EXPECT_EQ(std::count(samples.fates.begin(), samples.fates.end(), RayFate::transmitted), 20000) << tilt;
  }
}

// All lengths are scaled by a power of two.
TEST(TiltedFilm, WeightsAreIndependentOfTheUnit) {
  const Prescription phone = scale(testing::data_prescription("phone_5.6mm_f3.5"), 0.03);
  const Film film = tilted_by({.width_mm = 0.06, .height_mm = 0.04}, 20, 14);
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thick, ModelKind::exact_double}) {
    for (const auto normalisation : {Normalisation::irradiance, Normalisation::unity_on_axis}) {
      std::vector<std::vector<double>> weights;
      for (const double unit : {1.0, 64.0}) {
        Film scaled = film;
        scaled.width_mm *= unit, scaled.height_mm *= unit;
        const Camera camera(compile(scale(phone, unit)), scaled, {.model = model, .normalisation = normalisation});
        auto samples = random_samples(scaled, 500);
        samples.run(camera);
        weights.push_back(samples.weights);
      }
      for (std::size_t i = 0; i < weights[0].size(); ++i) {
        EXPECT_NEAR(weights[1][i], weights[0][i], 1e-9 * weights[0][i]) << name(model) << ", sample " << i;
      }
    }
  }
}

TEST(TiltedFilm, UnityOnAxisGivesWeightOne) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thick, ModelKind::exact_float}) {
    const CameraOptions options{.model = model, .normalisation = Normalisation::unity_on_axis};
    EXPECT_NEAR(mean_weight(Camera(lens, tilted_by(wide, 15, 0), options), {}), 1, 1e-3) << name(model);
  }
}

}  // namespace tilted_exposure_test
}  // namespace petzval
