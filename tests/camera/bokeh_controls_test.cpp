// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/bokeh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "camera_samples.hpp"
#include "iris/iris_shape.hpp"
#include "iris/iris_weights.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "settings.hpp"

namespace petzval {
namespace bokeh_controls_test {

using testing::data_lens;
using testing::expect_error;
using testing::mapped;
using testing::ring;
using testing::Samples;

const Film film{.width_mm = 36, .height_mm = 24};
const BokehControls soft{.weight_distribution = -4, .weight_strength = 0.8};

template <class T>
Samples<T> some_samples(const Film& on, std::size_t count) {
  Samples<T> samples;
  const testing::Kronecker<4> random(5);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [x, y, u, v] = random(i);
    samples.add(on.width_mm * (x - 0.5), on.height_mm * (y - 0.5), u, v);
  }
  return samples;
}

TEST(BokehControls, DefaultsChangeNoBit) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2.0"), 2.8);
  for (const ModelKind model : models()) {
    auto as_before = some_samples<float>(film, 500), same = as_before;
    as_before.run(Camera(lens, film, {.model = model}));
    for (const BokehControls& none : {BokehControls{}, BokehControls{.weight_strength = 0.9},
                                      BokehControls{.weight_distribution = 5, .weight_strength = 0}}) {
      const Camera camera(lens, film, {.model = model, .bokeh = none});
      same.run(camera);
      EXPECT_EQ(same.weights, as_before.weights) << name(model);
      EXPECT_EQ(same.dx, as_before.dx) << name(model);
      EXPECT_EQ(same.pdf_direction, as_before.pdf_direction) << name(model);
    }
  }
}

TEST(BokehControls, LensElementsAreBladesOfTheIris) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  auto samples = some_samples<double>(film, 300), same = samples;
  samples.run(Camera(lens, film, {.model = ModelKind::thick, .bokeh = {.blades = 6}}));
  same.run(Camera(with_iris(lens, {.blades = 6}), film, {.model = ModelKind::thick}));
  EXPECT_EQ(samples.weights, same.weights);
  EXPECT_EQ(samples.dx, same.dx);
}

/// Position of a camera ray on the stop, in semi-diameters of the stop; nullopt if the ray misses the stop.
std::optional<Vec2<double>> at_stop(const Lens& lens, const Ray<double>& from_lens) {
  std::optional<Vec2<double>> found;
  const std::size_t stop = *lens.stop();
  trace<double>(lens, {from_lens.origin - from_lens.direction * -10.0, -from_lens.direction}, {.apertures = false},
                [&](int surface, const Vec3<double>& p) {
                  if (surface == static_cast<int>(stop)) found = {p.x, p.y};
                });
  if (found) *found /= lens.surfaces()[stop].semi_diameter;
  return found;
}

class RealLens : public ::testing::TestWithParam<const char*> {};

// The importance with controls divided by the importance without them is the weight at the stop point of the ray.
// Camera samples have the same weights and densities.
TEST_P(RealLens, WeightsApplyAtTheStop) {
  const Lens open = data_lens(GetParam());
  for (const Iris& iris : {Iris{}, Iris{.blades = 5, .rotation_rad = 0.3}}) {
    const Lens lens = with_iris(open, iris);
    for (const BokehControls& controls : {ring, soft, mapped()}) {
      const iris_detail::IrisWeights weights(iris, controls.edge(), controls.weight_map, 0, "");
      for (const ModelKind model : {ModelKind::exact_double, ModelKind::polynomial(7)}) {
        const Film small{.width_mm = 18, .height_mm = 12};
        const Camera camera(lens, small, {.model = model, .bokeh = controls});
        const Camera plain(lens, small, {.model = model});
        const testing::Kronecker<4> random(7);
        int seen = 0;
        // Stop points are interpolated by fitted polynomials; the polynomial model also has approximate rays.
        const double near = model == ModelKind::exact_double ? 0.02 : 0.1;
        for (std::uint32_t i = 0; i < 400; ++i) {
          const auto [x, y, u, v] = random(i);
          const CameraSample s{.film = {18 * x - 9, 12 * y - 6}, .pupil_u = u, .pupil_v = v};
          const CameraRay r = camera.sample(s);
          if (!r) continue;
          const auto stop = at_stop(lens, r.ray);
          ASSERT_TRUE(stop);
          const double weight = weights.at(*stop);
          const Importance back = camera.importance({r.ray.origin, -r.ray.direction});
          const Importance even = plain.importance({r.ray.origin, -r.ray.direction});
          if (!back || !even || back.pdf_pupil == 0) continue;
          ++seen;
          EXPECT_NEAR(back.we / even.we, weight, near * (weight + 0.1)) << GetParam() << name(model) << iris.blades;
          EXPECT_NEAR(back.we / (back.pdf_position * back.pdf_direction) / r.weight, 1, 0.05);
          EXPECT_NEAR(back.pdf_pupil / r.pdf_pupil, 1, 0.05);
        }
        EXPECT_GT(seen, 200);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BokehControls, RealLens,
                         ::testing::Values("double_gauss_100mm_f1.35", "fisheye_8mm_f2.8", "anamorphic_60mm_2x",
                                           "mirror_newton_200mm_f8"));

// The map is bright in one half or quarter of the stop; the mean stop point of the rays lies there in every model.
TEST(BokehControls, MapHasOneOrientationInAllModels) {
  for (const char* id : {"double_gauss_100mm_f2.0", "telephoto_100mm_f5.6"}) {
    const Lens lens = data_lens(id);
    const Film point{.width_mm = 0.02, .height_mm = 0.02};
    for (const int half : {0, 1, 2}) {
      BokehControls controls;
      controls.weight_map = {64, 64, {}, false};
      for (int i = 0; i < 64 * 64; ++i) {
        const bool right = i % 64 >= 32, low = i / 64 >= 32;
        controls.weight_map.values.push_back((half == 0 ? right : half == 1 ? low : right && low) ? 1.0f : 0.0f);
      }
      for (const ModelKind model : models()) {
        if (model == ModelKind::pinhole) continue;
        const Camera camera(lens, point, {.model = model, .bokeh = controls});
        const Camera plain(lens, point, {.model = model});
        double sum_x = 0, sum_y = 0, light = 0, all = 0;
        constexpr std::size_t count = 2000;
        for (std::size_t i = 0; i < count; ++i) {
          const auto [u, v] = testing::fibonacci_point(i, count);
          const CameraRay r = camera.sample({.film = {}, .pupil_u = u, .pupil_v = v});
          all += plain.sample({.film = {}, .pupil_u = u, .pupil_v = v}).weight;
          if (!r) continue;
          const auto stop = at_stop(lens, r.ray);
          if (!stop) continue;
          light += r.weight, sum_x += r.weight * stop->x, sum_y += r.weight * stop->y;
        }
        const double expected = half == 2 ? 0.25 : 0.5;
        EXPECT_NEAR(light / all, expected, 0.02) << name(model);
        constexpr double of_half_disc = 0.4244;  // 4 / 3 pi
        EXPECT_NEAR(sum_x / light, half == 1 ? 0 : of_half_disc, 0.06) << name(model);
        EXPECT_NEAR(sum_y / light, half == 0 ? 0 : -of_half_disc, 0.06) << name(model);
      }
    }
  }
}

// At f/11 all parts of the pupil have nearly equal irradiance; at f/2 rays through the rim carry 12 % less than the
// axial ray.
TEST(BokehControls, WeightsKeepTheExposureOfEveryModel) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2.0"), 11);
  const Film point{.width_mm = 0.02, .height_mm = 0.02};
  for (const ModelKind model : models()) {
    const auto light = [&](const BokehControls& controls) {
      const Camera camera(lens, point, {.model = model, .bokeh = controls});
      double sum = 0, squares = 0;
      constexpr std::size_t count = 1 << 14;
      for (std::size_t i = 0; i < count; ++i) {
        const auto [u, v] = testing::fibonacci_point(i, count);
        const double weight = camera.sample({.film = {}, .pupil_u = u, .pupil_v = v}).weight;
        sum += weight / count, squares += weight * weight / count;
      }
      return std::array{sum, squares / (sum * sum) - 1};
    };
    const auto plain = light({});
    for (const BokehControls& controls : {ring, soft}) {
      const auto [own, variance] = light(controls);
      EXPECT_NEAR(own / plain[0], 1, model >= ModelKind::polynomial(3) ? 0.01 : 0.002)
          << name(model) << controls.weight_distribution;
      // Samples follow the weights.
      EXPECT_LT(variance, plain[1] + 0.25) << name(model) << controls.weight_distribution;
    }
  }
}

/// Pupils that are clipped by a rim, for each model.
class CatsEyes : public ::testing::TestWithParam<ModelKind> {};

TEST_P(CatsEyes, FilmAndSceneSideAgree) {
  const ModelKind model = GetParam();
  const Lens open = with_f_number(data_lens("double_gauss_100mm_f2.0"), 4);
  for (const Iris& iris : {Iris{}, Iris{.blades = 6, .rotation_rad = 0.2}}) {
    const Lens lens = with_iris(open, iris);
    for (const bool keep_light : {false, true}) {
      const BokehControls controls{
          .lens_ratio = 1.1, .rate_of_change = 0.9, .keep_light = keep_light, .weight_distribution = 4};
      const Camera camera(lens, film, {.model = model, .bokeh = controls});
      const testing::Kronecker<4> random(11);
      int seen = 0, lost = 0;
      for (std::uint32_t i = 0; i < 1000; ++i) {
        const auto [x, y, u, v] = random(i);
        const CameraSample s{.film = {36 * x - 18, 24 * y - 12}, .pupil_u = u, .pupil_v = v};
        const CameraRay r = camera.sample(s);
        lost += !r;
        if (!r) continue;
        const Importance back = camera.importance({r.ray.origin, -r.ray.direction});
        if (!back || back.pdf_pupil == 0) continue;
        ++seen;
        EXPECT_NEAR(back.we / (back.pdf_position * back.pdf_direction) / r.weight, 1, 0.05);
        EXPECT_NEAR(back.pdf_pupil / r.pdf_pupil, 1, 0.05);
      }
      EXPECT_GT(seen, model == ModelKind::pinhole ? -1 : 940) << name(model) << iris.blades;  // no ray meets a pinhole
      EXPECT_LT(lost, 40) << name(model) << iris.blades;  // cat's eyes are sampled directly
    }
  }
}

TEST_P(CatsEyes, ExposureFollowsTheAreaOrIsKept) {
  const ModelKind model = GetParam();
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2.0"), 8);
  const auto light = [&](const BokehControls& controls, const FilmPoint& at) {
    const Camera camera(lens, film, {.model = model, .bokeh = controls});
    double sum = 0;
    constexpr std::size_t count = 4096;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [u, v] = testing::fibonacci_point(i, count);
      sum += camera.sample({.film = at, .pupil_u = u, .pupil_v = v}).weight / count;
    }
    return sum;
  };
  // The intersection of unit discs with centres 1 apart has the area 2 acos(1/2) - sqrt(3) / 2, in any direction.
  const double share = (2 * std::acos(0.5) - std::sqrt(0.75)) / std::acos(-1.0);
  for (const FilmPoint& at : {FilmPoint{9, 0}, FilmPoint{0, 9}, FilmPoint{-9, 0}}) {
    const double plain = light({}, at);
    EXPECT_NEAR(light({.lens_ratio = 1, .rate_of_change = 2}, at) / plain, share, 0.02) << name(model);
    EXPECT_NEAR(light({.lens_ratio = 1, .rate_of_change = 2, .keep_light = true}, at) / plain, 1, 0.02) << name(model);
  }
  EXPECT_NEAR(light({.lens_ratio = 1, .rate_of_change = 2}, {}) / light({}, {}), 1, 0.01);
}

// Connections to a scene of radiance 1 and camera samples estimate the same irradiance.
TEST_P(CatsEyes, ConnectionsEqualFilmSamples) {
  const ModelKind model = GetParam();
  const Lens open = with_f_number(data_lens("double_gauss_100mm_f2.0"), 4);
  Film tilted = film;
  tilted.tilt_rad = 0.05;
  for (const Film& on : {film, tilted}) {
    for (const auto& [iris, keep_light] : {std::pair{Iris{}, false}, std::pair{Iris{.blades = 6}, true}}) {
      const Camera camera(
          with_iris(open, iris), on,
          {.model = model,
           .bokeh = {.lens_ratio = 1.1, .rate_of_change = 1.2, .keep_light = keep_light, .weight_distribution = 4}});
      const testing::Kronecker<4> random(13);
      double seen = 0, connected = 0;
      constexpr int count = 20000;
      constexpr double side = 1200, z = -3000;  // luminous square that fills the image, mm
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto [x, y, u, v] = random(i);
        seen += camera.sample({.film = {36 * x - 18, 24 * y - 12}, .pupil_u = u, .pupil_v = v}).weight / count;
        const ImportanceSample s = camera.sample_importance({side * (2 * x - 1), side * (2 * y - 1), z}, u, v);
        if (s) connected += 4 * side * side * s.importance.we * s.direction.z / s.pdf / count;
      }
      EXPECT_NEAR(connected / seen, 1, 0.04) << name(model) << iris.blades << on.tilted();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BokehControls, CatsEyes,
                         ::testing::Values(ModelKind::pinhole, ModelKind::thin, ModelKind::thin_two_disc,
                                           ModelKind::thick, ModelKind::polynomial(5), ModelKind::exact_float,
                                           ModelKind::exact_double));

TEST(BokehControls, ActOnThePupilOfAStopWithoutARim) {
  Prescription p = testing::data_prescription("double_gauss_100mm_f2.0");
  for (auto& surface : p.surfaces) {
    if (surface.stop) surface.semi_diameter.reset();
  }
  const Lens lens = compile(p);
  const Film point{.width_mm = 0.02, .height_mm = 0.02};
  const auto light = [&](const BokehControls& controls) {
    const Camera camera(lens, point, {.bokeh = controls});
    double sum = 0;
    constexpr std::size_t count = 1 << 12;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [u, v] = testing::fibonacci_point(i, count);
      sum += camera.sample({.film = {}, .pupil_u = u, .pupil_v = v}).weight / count;
    }
    return sum;
  };
  EXPECT_NEAR(light({.weight_distribution = 5, .weight_strength = 0.7}) / light({}), 1, 0.05);
}

TEST(BokehControls, RefuseBadInput) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const auto with = [&](const BokehControls& controls) {
    return [&lens, controls] { Camera(lens, film, {.model = ModelKind::thin, .bokeh = controls}); };
  };
  expect_error(with({.blades = 2}), {lens.name(), 2});
  expect_error(with({.blades = 21}), {lens.name(), 21});
  expect_error(with({.weight_distribution = std::nan("")}), {lens.name(), "nan"});
  expect_error(with({.weight_distribution = 1e4}), {lens.name(), 1e4});
  expect_error(with({.weight_distribution = 2, .weight_strength = 1e300}), {lens.name(), 1e300});
  expect_error(with({.lens_ratio = -1}), {lens.name(), -1});
  expect_error(with({.weight_map = {1, 1, {0}}}), {lens.name(), "map", "iris"});
  const Camera weighted(lens, film, {.model = ModelKind::thin, .bokeh = ring});
  expect_error([&] { camera_table(weighted); }, {lens.name(), "weights"});
}

}  // namespace bokeh_controls_test
}  // namespace petzval
