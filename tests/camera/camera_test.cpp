// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "../message.hpp"
#include "camera_parts.hpp"
#include "camera_samples.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "settings.hpp"
#include "tilted_films.hpp"

namespace petzval {
namespace camera_test {

using testing::expect_error;
using testing::random_samples;
using testing::Samples;
using testing::tilted_by;

Lens focused(const char* id) { return with_focus(testing::data_lens(id), 3000, {.origin = DistanceOrigin::film}); }

/// Tolerance between single rays and batches.
double precision(ModelKind model) { return model == ModelKind::exact_double ? 1e-11 : 2e-5; }

TEST(Camera, MovedFromCameraStaysValid) {
  Camera camera(focused("double_gauss_100mm_f2.0"), {});
  const CameraSample sample{.film = {3, 4}, .pupil_u = 0.3, .pupil_v = 0.6};
  const CameraRay wanted = camera.sample(sample);
  ASSERT_TRUE(wanted);
  const Camera moved = std::move(camera);
  for (const Camera& each : {std::as_const(camera), moved}) {
    const CameraRay ray = each.sample(sample);
    EXPECT_EQ(ray.ray.origin, wanted.ray.origin);
    EXPECT_EQ(ray.weight, wanted.weight);
  }
}

TEST(Camera, ShiftMovesTheFilm) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  const Camera shifted(lens, {.width_mm = 10, .height_mm = 10, .shift_x_mm = 12}, {.model = ModelKind::exact_double});
  const Camera wide(lens, {.width_mm = 36, .height_mm = 36}, {.model = ModelKind::exact_double});
  EXPECT_EQ(shifted.sample({{6.9, 0}, 0.5, 0.5}).fate, RayFate::outside_film);
  const CameraRay a = shifted.sample({{16.9, 4.9}, 0.5, 0.5}), b = wide.sample({{16.9, 4.9}, 0.5, 0.5});
  EXPECT_EQ(a.fate, RayFate::transmitted);
  EXPECT_NEAR(glm::length(a.ray.direction - b.ray.direction), 0, 5e-3);  // their tables have different steps
}

TEST(Camera, FilmZReplacesTheLensFilmZ) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  Film film{.shift_y_mm = 3, .z_mm = lens.film_z() + 1.5, .tilt_rad = 0.1};
  const Camera camera(lens, film, {.model = ModelKind::thick});
  EXPECT_EQ(camera.lens().film_z(), *film.z_mm);
  EXPECT_EQ(camera.film().z(), *film.z_mm);
  const Lens moved = with_film(lens, *film.z_mm);
  film.z_mm.reset();
  const Camera same(moved, film, {.model = ModelKind::thick});
  EXPECT_EQ(same.film().z(), moved.film_z());
  const CameraSample sample{film.point(1000, 700), 0.3, 0.8};
  EXPECT_TRUE(camera.sample(sample));
  EXPECT_EQ(camera.sample(sample).ray.origin, same.sample(sample).ray.origin);
  EXPECT_EQ(camera.sample(sample).ray.direction, same.sample(sample).ray.direction);
}

TEST(Camera, MarginSeesTheScene) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  for (const ModelKind model : {ModelKind::thick, ModelKind::polynomial(5), ModelKind::exact_double}) {
    Film film{.width_mm = 24, .height_mm = 16, .columns = 240, .rows = 160};
    const CameraSample beside{.film = film.point(-2, 80), .pupil_u = 0.3, .pupil_v = 0.4};
    EXPECT_EQ(Camera(lens, film, {.model = model}).sample(beside).fate, RayFate::outside_film);
    film.margin_mm = 0.3;
    const Camera camera(lens, film, {.model = model});
    const CameraRay ray = camera.sample(beside);
    ASSERT_TRUE(ray) << name(model);
    EXPECT_EQ(ray.pdf_film, 1 / (24. * 16));
    // Reciprocity holds on the margin: the importance divided by the densities equals the weight.
    const Importance back = camera.importance({ray.ray.origin, -ray.ray.direction});
    ASSERT_TRUE(back) << name(model);
    EXPECT_NEAR(back.raster.x, -2, 1e-3);
    EXPECT_NEAR(back.we / (back.pdf_position * back.pdf_direction), ray.weight, 2e-3 * ray.weight) << name(model);
    EXPECT_EQ(camera.sample({.film = film.point(-3.1, 80)}).fate, RayFate::outside_film);
  }
}

TEST(Camera, BatchDifferentialsEqualSingleDifferentials) {
  const Camera camera(focused("double_gauss_100mm_f2.0"), {.columns = 360, .rows = 240},
                      {.model = ModelKind::exact_double});
  const auto samples = random_samples(camera.film(), 9);
  std::array<std::vector<double>, 19> out;
  for (auto& values : out) values.resize(samples.size());
  const auto arrays = [&](std::size_t k) {
    const auto at = [&](std::size_t i) { return out[k + i].data(); };
    return RayArrays<double>{at(0), at(1), at(2), at(3), at(4), at(5)};
  };
  camera.sample_differentials<double>(
      samples.size(), {samples.film_x.data(), samples.film_y.data(), samples.pupil_u.data(), samples.pupil_v.data()},
      {arrays(0), out[18].data()}, arrays(6), arrays(12));
  // Rows of the raster run down, columns to the right: the picture is upright.
  const double column = camera.film().width_mm / 360, row = camera.film().height_mm / 240;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CameraRayDifferential one = camera.sample_differential(samples.one(i));
    EXPECT_NEAR(out[18][i], one.sample.weight, 1e-9);
    if (!one.sample) continue;
    const double x = one.by_film_x.direction.x * column, y = one.by_film_y.direction.y * row;
    EXPECT_GT(out[9][i], 0);
    EXPECT_NEAR(out[9][i], std::abs(x), 1e-9 * std::abs(x));
    EXPECT_LT(out[16][i], 0);
    EXPECT_NEAR(out[16][i], -std::abs(y), 1e-9 * std::abs(y));
  }
}

TEST(Camera, FilmContainsItsEdges) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  const testing::Kronecker<4> random(1);
  for (std::uint32_t i = 0; i < 40; ++i) {
    const auto [a, b, c, d] = random(i);
    const Film film{.width_mm = 5 + 20 * a, .height_mm = 5 + 15 * b, .shift_x_mm = 9 * c, .shift_y_mm = -9 * d};
    const Camera camera(lens, film, {.model = ModelKind::thick});
    Samples<float> rounded;
    for (const double column : {0.0, 0.5 * film.columns, 1.0 * film.columns}) {
      for (const double row : {0.0, 0.5 * film.rows, 1.0 * film.rows}) {
        const FilmPoint point = film.point(column, row);
        EXPECT_TRUE(film.contains(point));
        EXPECT_TRUE(camera.sample({point, 0.3, 0.6}));
        rounded.add(point.x, point.y, 0.3, 0.6);
      }
    }
    rounded.run(camera);
    for (const RayFate fate : rounded.fates) EXPECT_EQ(fate, RayFate::transmitted);
  }
}

// A sample (film x, y, u, v) and its ray in the scene (x, y and direction cosines) are coordinates of the same point of
// phase space. As etendue is conserved, the Jacobian between them is the weight n'^2 cos / pdf.
TEST(Camera, ConservesEtendue) {
  const double angle = 0.2;
  for (const auto& [id, film] :
       {std::pair{"double_gauss_100mm_f2.0", Film{.width_mm = 14, .height_mm = 14}},
        std::pair{"double_gauss_100mm_f2.0", Film{.shift_y_mm = 4, .tilt_rad = angle, .swing_rad = -angle}},
        std::pair{"fisheye_10mm_f4", Film{.width_mm = 14, .height_mm = 14}},
        std::pair{"fisheye_10mm_f4", Film{.width_mm = 14, .height_mm = 14, .tilt_rad = angle}},
        std::pair{"eye_gullstrand_le_grand", Film{.width_mm = 3, .height_mm = 3}},
        std::pair{"modern_50mm_f1.0", Film{.width_mm = 14, .height_mm = 14}}}) {
    const Lens lens = testing::data_lens(id);
    const Camera camera(lens, film, {.model = ModelKind::exact_double});
    const auto samples = random_samples(camera.film(), 40);
    int checked = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const CameraSample s = samples.one(i);
      const CameraRay middle = camera.sample(s);
      if (!middle) continue;
      constexpr double h = 1e-5;
      std::array<std::array<double, 4>, 4> j{};
      bool whole = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto moved = [&](double by) {
          CameraSample t = s;
          (k == 0 ? t.film.x : k == 1 ? t.film.y : k == 2 ? t.pupil_u : t.pupil_v) += by;
          const CameraRay r = camera.sample(t);
          whole = whole && r.fate == RayFate::transmitted;
          // Intersection with the plane across the axis through the origin of the central ray.
          const double t_plane = (middle.ray.origin.z - r.ray.origin.z) / r.ray.direction.z;
          const Vec3<double> p = r.ray.origin + t_plane * r.ray.direction;
          return std::array{p.x, p.y, r.ray.direction.x, r.ray.direction.y};
        };
        const auto after = moved(h), before = moved(-h);
        for (std::size_t row = 0; row < 4; ++row) j[row][k] = (after[row] - before[row]) / (2 * h);
      }
      // Differences across the edge of the pupil are skipped.
      if (!whole) continue;
      const auto minor = [&](std::size_t r0, std::size_t r1, std::size_t c0, std::size_t c1) {
        return j[r0][c0] * j[r1][c1] - j[r0][c1] * j[r1][c0];
      };
      const double determinant = minor(0, 1, 0, 1) * minor(2, 3, 2, 3) - minor(0, 1, 0, 2) * minor(2, 3, 1, 3) +
                                 minor(0, 1, 0, 3) * minor(2, 3, 1, 2) + minor(0, 1, 1, 2) * minor(2, 3, 0, 3) -
                                 minor(0, 1, 1, 3) * minor(2, 3, 0, 2) + minor(0, 1, 2, 3) * minor(2, 3, 0, 1);
      EXPECT_NEAR(std::abs(determinant) / middle.weight, 1, 2e-5) << id << ' ' << i;
      ++checked;
    }
    EXPECT_GT(checked, 25) << id;
  }
}

/// Compares differentials with finite differences of samples, for all models.
void expect_differences(const Film& film) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  for (const ModelKind model : models()) {
    const Camera camera(lens, film, {.model = model});
    // Differences of float rays are noise, so the model in double is the reference.
    const Camera reference(lens, film, {.model = model == ModelKind::exact_float ? ModelKind::exact_double : model});
    const auto samples = random_samples(camera.film(), 40);
    const testing::CameraParts parts(reference);
    int checked = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const CameraSample s = samples.one(i);
      const CameraRayDifferential d = camera.sample_differential(s);
      const CameraRay same = camera.sample(s);
      EXPECT_EQ(d.sample.fate, same.fate);
      EXPECT_NEAR(d.sample.weight, same.weight, precision(model) * same.weight);
      if (!d.sample) continue;
      constexpr double h = 1e-4;
      for (const bool by_x : {true, false}) {
        const auto moved = [&](double by) { return reference.sample(parts.moved(s, by_x ? by : 0, by_x ? 0 : by)); };
        const CameraRay after = moved(h), before = moved(-h);
        if (!after || !before) continue;
        const Ray<double>& derivative = by_x ? d.by_film_x : d.by_film_y;
        const Vec3<double> direction = (after.ray.direction - before.ray.direction) / (2 * h);
        const Vec3<double> origin = (after.ray.origin - before.ray.origin) / (2 * h);
        const double bound = model == ModelKind::exact_float ? 1e-4 : 1e-7;
        EXPECT_NEAR(glm::length(derivative.direction - direction), 0, bound) << name(model) << ' ' << i;
        EXPECT_NEAR(glm::length(derivative.origin - origin), 0, 100 * bound) << name(model) << ' ' << i;
        ++checked;
      }
    }
    EXPECT_GT(checked, 50) << name(model);
  }
}

TEST(Camera, DifferentialsEqualFiniteDifferences) {
  expect_differences({});
  expect_differences(tilted_by(testing::shifted, 10, -6));
}

void expect_lost(const Camera& camera, const CameraSample& sample, RayFate fate) {
  const CameraRay one = camera.sample(sample);
  const CameraRayDifferential d = camera.sample_differential(sample);
  EXPECT_EQ(one.fate, fate) << name(camera.model());
  EXPECT_EQ(d.sample.fate, fate) << name(camera.model());
  EXPECT_EQ(one.weight, 0);
  for (const Ray<double>& ray : {one.ray, d.sample.ray, d.by_film_x, d.by_film_y}) {
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(ray.origin[k]) && std::isfinite(ray.direction[k]));
  }
  for (const double value : {one.pdf_film, one.pdf_pupil, one.pdf_direction}) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(one.pdf_film > 0, fate != RayFate::outside_film);
}

TEST(Camera, InvalidSamplesHaveFates) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const Lens lens = focused("double_gauss_100mm_f2.0");
  const auto fates = [&](ModelKind model, const Film& film) {
    const Camera camera(lens, film, {.model = model});
    for (const FilmPoint& point : {FilmPoint{18.01, 0}, FilmPoint{0, -12.01}, FilmPoint{nan, 0}, FilmPoint{0, nan},
                                   FilmPoint{inf, 0}, FilmPoint{1e300, -1e300}}) {
      expect_lost(camera, {point, 0.5, 0.5}, RayFate::outside_film);
    }
    expect_lost(camera, {{1, 2}, nan, 0.5}, RayFate::vignetted);
    expect_lost(camera, {{1, 2}, 0.5, nan}, RayFate::vignetted);
    expect_lost(camera, {{1, 2}, inf, 0.5}, RayFate::vignetted);
    expect_lost(camera, {{1, 2}, 0.5, 0.5, 1}, RayFate::outside_spectrum);
    expect_lost(camera, {{1, 2}, 0.5, 0.5, 1u << 20}, RayFate::outside_spectrum);
    // Corners of the film and of the unit square are valid.
    for (const double u : {0.0, 1.0}) {
      const CameraRay corner = camera.sample({{18, -12}, u, 1 - u});
      EXPECT_NE(corner.fate, RayFate::outside_film);
      EXPECT_NE(corner.fate, RayFate::invalid);
    }
  };
  for (const ModelKind model : models()) {
    fates(model, {});
    fates(model, {.tilt_rad = 0.15, .swing_rad = -0.1});
  }
}

TEST(Camera, ClosedStopIsDark) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  const Lens shut = with_semi_diameter(lens, pupils(lens).stop, 0);
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::thick,
                                ModelKind::exact_float, ModelKind::exact_double}) {
    expect_lost(Camera(shut, {}, {.model = model}), {{3, 4}, 0.3, 0.6}, RayFate::vignetted);
  }
}

TEST(Camera, FisheyeSeesBeyond90Degrees) {
  const Lens lens = testing::data_lens("fisheye_6.3mm_f2.8");
  const Film film{.width_mm = 24, .height_mm = 24};
  const Camera camera(lens, film, {.model = ModelKind::exact_double});
  auto samples = random_samples(film, 20000);
  samples.run(camera);
  int beyond = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& [origin, direction] = samples.ray(i);
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(std::isfinite(origin[k]) && std::isfinite(direction[k]));
    beyond += samples.fates[i] == RayFate::transmitted && direction.z > 0;
  }
  EXPECT_GT(beyond, 100);  // rays of fields beyond 90 degrees run towards +z
}

TEST(ModelKind, NamesRoundTrip) {
  EXPECT_EQ(models().size(), 11u);
  for (const ModelKind model : models()) EXPECT_EQ(model_named(name(model)), model) << name(model);
  for (const char* none : {"", "custom", "Thin", "thin ", "polynomial_4", "polynomial"}) {
    EXPECT_FALSE(model_named(none)) << none;
  }
}

TEST(Camera, RefusesInvalidModels) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  expect_error([&] { Camera(lens, {}, {.model = ModelKind::polynomial(4)}); }, {lens.name(), "degree", 4});
  for (const int degree : {-1, 0, 4, 13}) {
    expect_error([&] { Camera(lens, {}, {.model = ModelKind::polynomial(degree)}); }, {"degree", degree});
  }
}

TEST(Camera, RefusesInvalidNormalisation) {
  const Lens lens = focused("double_gauss_100mm_f2.0");
  const CameraOptions options{.model = ModelKind::thin, .normalisation = static_cast<Normalisation>(9)};
  expect_error([&] { Camera(lens, {}, options); }, {lens.name(), "normalisation", 9, "unity_on_axis"});
}

TEST(Camera, RefusesInvalidFilms) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [&](const Film& film) { return [&lens, film] { Camera(lens, film); }; };
  expect_error(with({.width_mm = 0}), {"film", "width_mm", 0});
  expect_error(with({.height_mm = -24}), {"film", "height_mm", -24});
  expect_error(with({.width_mm = nan}), {"film", "width_mm", "nan"});
  expect_error(with({.columns = 0}), {"film", "columns", 0});
  expect_error(with({.rows = -1}), {"film", "rows", -1});
  expect_error(with({.shift_x_mm = nan}), {"film", "shift_x_mm", "nan"});
  expect_error(with({.tilt_rad = nan}), {"film", "tilt_rad", "nan"});
  expect_error(with({.swing_rad = -1.6}), {"film", "swing_rad", -1.6});
  // Films inside or in front of the glass, upright or tilted, given by the film or by the prescription.
  const double last_z = lens.surfaces().back().vertex_z;
  for (const double z : {last_z, last_z - 5, -20.0}) {
    expect_error(with({.z_mm = z}), {lens.name(), "film", z, last_z});
    expect_error(with({.z_mm = z, .tilt_rad = 0.1}), {lens.name(), "film", z, last_z});
    Prescription prescription = testing::data_prescription("tessar_100mm_f2.8");
    prescription.surfaces.back().thickness = z - last_z;
    expect_error([&] { Camera(compile(prescription), {}); }, {lens.name(), "film", last_z});
  }
  // Behind the vertex of a concave last surface a small film fits; a large one meets the surface.
  const Lens hollow = testing::data_lens("petzval_100mm_f1.25");
  const double hollow_z = hollow.surfaces().back().vertex_z + 0.5;
  const Film small{.width_mm = 2, .height_mm = 2, .z_mm = hollow_z}, large{.width_mm = 46.9, .z_mm = hollow_z};
  EXPECT_NO_THROW(Camera(hollow, small, {.model = ModelKind::thin}));
  expect_error([&] { Camera(hollow, large, {.model = ModelKind::thin}); }, {hollow.name(), "film", "last surface"});
  // Behind a mirror the light runs towards -z.
  const Lens mirror = testing::data_lens("mirror_newton_200mm_f8");
  EXPECT_NO_THROW(Camera(mirror, {.width_mm = 2, .height_mm = 2, .z_mm = -190}));
  expect_error([&] { Camera(mirror, {.width_mm = 2, .height_mm = 2, .z_mm = 190}); }, {mirror.name(), "film", 190});
  const Lens anamorphic = testing::data_lens("anamorphic_60mm_2x");
  expect_error([&] { Camera(anamorphic, {}, {.model = ModelKind::pinhole}); }, {anamorphic.name(), "pinhole"});
}

TEST(Camera, StopWithoutRimIsLimitedByOtherRims) {
  const auto [marked, unmarked] = testing::without_the_rim_of_its_stop(testing::open_singlet(10));
  const Lens endless = compile(testing::open_singlet());
  const Film film{.width_mm = 12, .height_mm = 8};
  for (const ModelKind model : models()) {
    SCOPED_TRACE(name(model));
    const Camera camera(marked, film, {.model = model}), same(unmarked, film, {.model = model});
    auto samples = random_samples(film, 64), wanted = samples;
    samples.run(camera), wanted.run(same);
    EXPECT_EQ(samples.weights, wanted.weights);
    EXPECT_GT(std::accumulate(samples.weights.begin(), samples.weights.end(), 0.0), 64 * 0.1);
    EXPECT_EQ(testing::message([&] { Camera(endless, film, {.model = model}); }),
              testing::message([&] { pupils(endless); }));
  }
}

}  // namespace camera_test
}  // namespace petzval
