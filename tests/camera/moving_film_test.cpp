// SPDX-License-Identifier: Apache-2.0
// Films that travel while the shutter is open: focus pulls.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "camera_parts.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace moving_film_test {

using testing::shifted;
using testing::tilted_by;

struct Case {
  const char* id;
  Film film;
};

/// Focus pulls from 3 m to infinity, reversed for the tilted film.
std::vector<Case> cases() {
  std::vector<Case> result{{"double_gauss_100mm_f2.0", shifted},
                           {"double_gauss_100mm_f2.0", tilted_by(shifted, 6, -4)},
                           {"fisheye_8mm_f2.8", {.width_mm = 10, .height_mm = 8}}};
  for (auto& [id, film] : result) {
    const Lens lens = testing::data_lens(id);
    const double near_z = with_focus(lens, 3000).film_z(), far_z = with_focus(lens, 1e9).film_z();
    film.z_mm = film.tilted() ? far_z : near_z;
    film.travel_mm = film.tilted() ? near_z - far_z : far_z - near_z;
  }
  return result;
}

double mean_weight(const Camera& camera, const FilmPoint& point, double time) {
  constexpr std::size_t count = 8192;
  const testing::Kronecker<2> random(5);
  double sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [u, v] = random(i);
    sum += camera.sample({.film = point, .pupil_u = u, .pupil_v = v, .time = time}).weight / count;
  }
  return sum;
}

// First-order models are fitted to the irradiance at time 0; over the travel their irradiance changes slightly
// differently from the exact lens.
TEST(MovingFilm, ExposureEqualsExposureOfAStillFilm) {
  for (const auto& [id, film] : cases()) {
    const Lens lens = testing::data_lens(id);
    for (const ModelKind model :
         {ModelKind::thin, ModelKind::thin_two_disc, ModelKind::polynomial(5), ModelKind::exact_double}) {
      SCOPED_TRACE(std::string(id) + " " + std::string(name(model)));
      const double tolerance = model == ModelKind::thin ? 1.5e-2 : model == ModelKind::exact_double ? 2e-3 : 5e-3;
      const Camera moving(lens, film, {.model = model});
      for (const double time : {0.0, 0.4, 1.0}) {
        const Camera still(lens, film.at(time), {.model = model});
        for (const auto& [column, row] : {std::array{0.5, 0.5}, std::array{0.1, 0.3}, std::array{0.99, 0.99}}) {
          const FilmPoint point = film.point(column * film.columns, row * film.rows);
          EXPECT_NEAR(mean_weight(moving, point, time) / mean_weight(still, point, 0), 1, tolerance);
        }
      }
    }
  }
}

// Closed-form pupils that are not discs, on a film that travels by 1e-9 mm.
TEST(MovingFilm, KeepsPupilsWithoutRotationalSymmetry) {
  const Lens lens =
      with_iris(testing::data_lens("double_gauss_100mm_f2.0"), {.blades = 3, .roundness = 0.3, .rotation_rad = 0.2});
  for (const Lens& own : {testing::data_lens("anamorphic_60mm_2x"), lens}) {
    for (const ModelKind model : {ModelKind::thin, ModelKind::thick}) {
      SCOPED_TRACE(own.name() + " " + std::string(name(model)));
      const Film film{.width_mm = 24, .height_mm = 16};
      Film moving = film;
      moving.travel_mm = 1e-9;
      const Camera still(own, film, {.model = model}), travels(own, moving, {.model = model});
      for (const FilmPoint& point : {FilmPoint{0, 0}, FilmPoint{10, 0}, FilmPoint{0, 7}, FilmPoint{-8, 5}}) {
        const double wanted = mean_weight(still, point, 0);
        ASSERT_GT(wanted, 0);
        EXPECT_NEAR(mean_weight(travels, point, 0.5) / wanted, 1, 5e-3) << point.x << " " << point.y;
      }
    }
  }
}

// A still film sees the rays of the moving film at the same film point with the same importance.
TEST(MovingFilm, RaysEqualRaysOfAStillFilm) {
  for (const auto& [id, film] : cases()) {
    const Lens lens = testing::data_lens(id);
    const Camera moving(lens, film, {.model = ModelKind::exact_double});
    std::vector<Camera> stills;
    for (const double time : {0.0, 0.5, 1.0}) {
      stills.emplace_back(lens, film.at(time), CameraOptions{ModelKind::exact_double});
    }
    const testing::Kronecker<5> random(2);
    int passed = 0;
    for (std::uint32_t i = 0; i < 400; ++i) {
      const auto [a, b, u, v, part] = random(i);
      const double time = static_cast<int>(part * 3) / 2.0;
      const FilmPoint point = film.point(a * film.columns, b * film.rows);
      const CameraRay ray = moving.sample({.film = point, .pupil_u = u, .pupil_v = v, .time = time});
      if (!ray) continue;
      ++passed;
      const Camera& still = stills[static_cast<std::size_t>(2 * time)];
      const Ray<double> from_scene{ray.ray.origin, -ray.ray.direction};
      const Importance seen = still.importance(from_scene), own = moving.importance(from_scene, {}, time);
      for (const Importance& importance : {seen, own}) {
        ASSERT_TRUE(importance);
        EXPECT_NEAR(std::hypot(importance.film.x - point.x, importance.film.y - point.y), 0, 1e-9);
        EXPECT_NEAR(importance.we / seen.we, 1, 1e-12);
      }
      EXPECT_NEAR(own.we / (own.pdf_position * own.pdf_direction) / ray.weight, 1, 1e-9);
      EXPECT_NEAR(own.pdf_pupil / ray.pdf_pupil, 1, 1e-9);
    }
    EXPECT_GT(passed, 300) << id;
  }
}

TEST(MovingFilm, ImportanceEqualsWeightOfSamples) {
  const auto [id, film] = cases()[0];
  const Lens lens = testing::data_lens(id);
  for (const ModelKind model : models()) {
    if (model == ModelKind::pinhole) continue;
    SCOPED_TRACE(name(model));
    const Camera camera(lens, film, {.model = model});
    auto samples = testing::random_samples(film, 100);
    const double precision = model == ModelKind::exact_float ? 1e-4 : 1e-7;
    int passed = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      CameraSample sample = samples.one(i);
      sample.time = static_cast<double>(i) / 99;
      const CameraRay ray = camera.sample(sample);
      if (!ray) continue;
      const Importance own = camera.importance({ray.ray.origin, -ray.ray.direction}, {}, sample.time);
      if (!own) continue;  // on the rim
      ++passed;
      EXPECT_NEAR(std::hypot(own.film.x - sample.film.x, own.film.y - sample.film.y), 0, 100 * precision);
      EXPECT_NEAR(own.we / (own.pdf_position * own.pdf_direction) / ray.weight, 1, precision);
    }
    EXPECT_GT(passed, 80);
  }
}

TEST(MovingFilm, DifferentialsEqualFiniteDifferences) {
  const auto [id, film] = cases()[1];
  const Camera camera(testing::data_lens(id), film, {.model = ModelKind::exact_double});
  const testing::CameraParts parts(camera);
  const auto samples = testing::random_samples(film, 50);
  constexpr double step = 1e-4;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    CameraSample s = samples.one(i);
    s.time = 0.8;
    const auto by = camera.sample_differential(s);
    const CameraRay a = camera.sample(parts.moved(s, -step, 0)), b = camera.sample(parts.moved(s, step, 0));
    if (!by.sample || !a || !b) continue;
    EXPECT_NEAR(glm::length((b.ray.direction - a.ray.direction) / (2 * step) - by.by_film_x.direction), 0, 1e-5);
  }
}

TEST(MovingFilm, RefusesTravelIntoTheLens) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const double last_z = lens.surfaces().back().vertex_z;
  const auto camera = [&](double travel) {
    return [&lens, travel] { Camera(lens, {.travel_mm = travel}, {.model = ModelKind::thin}); };
  };
  EXPECT_NO_THROW(camera(0.5)());
  testing::expect_error(camera(last_z - 1 - lens.film_z()), {lens.name(), "film", last_z});
  testing::expect_error(camera(std::numeric_limits<double>::quiet_NaN()), {lens.name(), "film", "travel_mm", "nan"});
}

}  // namespace moving_film_test
}  // namespace petzval
