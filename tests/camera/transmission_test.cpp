// SPDX-License-Identifier: Apache-2.0
// Weights of cameras with and without the light that surfaces reflect.
#include <gtest/gtest.h>

#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/focus/focus.hpp"

namespace petzval {
namespace transmission_test {

const std::vector<double> visible{440, 500, 546.074, 587.5618, 650};
const Film still{.width_mm = 36, .height_mm = 24, .columns = 360, .rows = 240};
const Film tilted{.width_mm = 36, .height_mm = 24, .columns = 360, .rows = 240, .tilt_rad = 0.1};

Lens double_gauss() {
  return with_focus(compile(testing::data_prescription("double_gauss_100mm_f1.35"), visible), 3000,
                    {.origin = DistanceOrigin::front_vertex});
}

CameraSample drawn(std::uint32_t k, const Film& film) {
  const auto uv3 = owen_sobol(k, 3);
  const double a = uv3.x, b = uv3.y;
  const auto uv4 = owen_sobol(k, 4);
  const double u = uv4.x, v = uv4.y;
  return {.film = {film.width_mm * (a - 0.5), film.height_mm * (b - 0.5)}, .pupil_u = u, .pupil_v = v};
}

CameraOptions with_light(ModelKind model) { return {.model = model, .transmission = true}; }

TEST(Transmission, OfExactRaysIsThatOfTheLens) {
  const Lens lens = double_gauss();
  for (const Film& film : {still, tilted}) {
    for (const ModelKind model : {ModelKind::exact_double, ModelKind::exact_float}) {
      const Camera bare(lens, film, {.model = model}), lit(lens, film, with_light(model));
      EXPECT_LT(lit.transmission_error(), 1e-3);
      EXPECT_EQ(bare.transmission_error(), 0);
      int rays = 0;
      for (std::uint32_t k = 0; k < 200; ++k) {
        CameraSample sample = drawn(k, film);
        sample.wavelength = k % visible.size();
        const CameraRay a = bare.sample(sample), b = lit.sample(sample);
        ASSERT_EQ(a.fate, b.fate);
        if (!a) continue;
        ++rays;
        const Ray<double> to_film{b.ray.origin, -b.ray.direction};
        const double exact = transmittance(lens, to_film, sample.wavelength).value();
        EXPECT_NEAR(b.weight / a.weight, exact, lit.transmission_error() + 1e-5);
        EXPECT_EQ(a.pdf_direction, b.pdf_direction);
        EXPECT_NEAR(lit.sample_differential(sample).sample.weight, b.weight, 2e-6 * b.weight);
        // The scene side.
        const Importance from = bare.importance(to_film, sample.wavelength),
                         to = lit.importance(to_film, sample.wavelength);
        ASSERT_EQ(from.fate, to.fate);
        if (from) {
          EXPECT_NEAR(to.we / from.we, b.weight / a.weight, 2e-4);
        }
      }
      EXPECT_GT(rays, 100);
    }
  }
}

/// Mean weight over the pupil of a film point.
double light_at(const Camera& camera, const FilmPoint& film, Wavelength wavelength) {
  double sum = 0;
  for (std::uint32_t k = 0; k < 256; ++k) {
    const auto uv5 = owen_sobol(k, 5);
    const double u = uv5.x, v = uv5.y;
    sum += camera.sample({.film = film, .pupil_u = u, .pupil_v = v, .wavelength = wavelength}).weight;
  }
  return sum / 256;
}

TEST(Transmission, OfFittedModelsIsThatOfExactRays) {
  for (const Coating& coating : {Coating{}, Coating::quarter_wave()}) {
    const Lens lens = with_coating(double_gauss(), coating);
    const Camera bare(lens, still, {.model = ModelKind::exact_double}),
        exact(lens, still, with_light(ModelKind::exact_double));
    for (const ModelKind model :
         {ModelKind::thick, ModelKind::thin, ModelKind::thin_two_disc, ModelKind::pinhole, ModelKind::polynomial(5)}) {
      const Camera without(lens, still, {.model = model}), camera(lens, still, with_light(model));
      EXPECT_LT(camera.transmission_error(), 0.02) << name(model);
      for (const FilmPoint film : {FilmPoint{0, 0}, FilmPoint{10, 4}, FilmPoint{-12, 8}}) {
        for (const std::size_t w : {0u, 3u}) {
          const double part = light_at(camera, film, w) / light_at(without, film, w);
          EXPECT_NEAR(part, light_at(exact, film, w) / light_at(bare, film, w), model.is_first_order() ? 0.01 : 0.004)
              << name(model);
        }
      }
    }
  }
}

TEST(Transmission, IsTheSameOnBothSidesOfFittedModels) {
  const Lens lens = double_gauss();
  for (const ModelKind model : {ModelKind::thick, ModelKind::thin_two_disc, ModelKind::polynomial(5)}) {
    const Camera bare(lens, tilted, {.model = model}), lit(lens, tilted, with_light(model));
    int rays = 0;
    for (std::uint32_t k = 0; k < 100; ++k) {
      const CameraSample sample = drawn(k, tilted);
      const CameraRay a = bare.sample(sample), b = lit.sample(sample);
      if (!a || !b) continue;
      const Ray<double> to_film{b.ray.origin, -b.ray.direction};
      const Importance from = bare.importance(to_film), to = lit.importance(to_film);
      if (!from || !to) continue;
      ++rays;
      EXPECT_NEAR(to.we / from.we, b.weight / a.weight, 1e-6) << name(model);
    }
    EXPECT_GT(rays, 50);
  }
}

TEST(Transmission, KeepsTheTintOfTheLens) {
  const Lens lens = double_gauss();
  CameraOptions options = with_light(ModelKind::exact_double);
  options.normalisation = Normalisation::unity_on_axis;
  const Camera tinted(lens, still, options);
  EXPECT_NEAR(light_at(tinted, {}, {}), 1, 1e-2);
  EXPECT_LT(light_at(tinted, {}, 0), 0.99 * light_at(tinted, {}, 4));  // glass reflects more blue light
  options.normalisation = Normalisation::unity_at_each_wavelength;
  const Camera white(lens, still, options);
  EXPECT_NEAR(light_at(white, {}, 0), light_at(white, {}, 4), 4e-3);
}

TEST(Transmission, OfAnamorphicLensesIsFitted) {
  const Lens lens = with_focus(
      compile(testing::data_prescription("anamorphic_60mm_2x"), visible, {.missing_glass = MissingGlass::abbe}), 3000);
  const Camera exact(lens, still, with_light(ModelKind::exact_double)),
      bare(lens, still, {.model = ModelKind::exact_double});
  const Camera thick(lens, still, with_light(ModelKind::thick)), without(lens, still, {.model = ModelKind::thick});
  EXPECT_LT(thick.transmission_error(), 0.05);
  for (const FilmPoint film : {FilmPoint{0, 0}, FilmPoint{8, 5}}) {
    EXPECT_NEAR(light_at(thick, film, {}) / light_at(without, film, {}),
                light_at(exact, film, {}) / light_at(bare, film, {}), 0.02);
  }
}

TEST(Transmission, IsRefusedByTables) {
  const Camera camera(double_gauss(), still, with_light(ModelKind::exact_float));
  testing::expect_error([&] { camera_table(camera); }, {"transmission"});
}

}  // namespace transmission_test
}  // namespace petzval
