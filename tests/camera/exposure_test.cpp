// SPDX-License-Identifier: Apache-2.0
// A camera in a scene of radiance 1: the mean weight of the samples of a film point is its irradiance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

#include "../data_lenses.hpp"
#include "camera_samples.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace exposure_test {

double mean_weight(const Camera& camera, const FilmPoint& film, std::uint32_t count = 4096, std::uint32_t seed = 3,
                   std::uint16_t wavelength = 0) {
  testing::Samples<double> samples;
  samples.wavelengths.assign(count, wavelength);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto uv = owen_sobol(i, seed);
    const double u = uv.x, v = uv.y;
    samples.add(film.x, film.y, u, v);
  }
  samples.run(camera);
  double sum = 0;
  for (const double w : samples.weights) sum += w;
  return sum / count;
}

/// Films within the declared fields of the lenses.
struct Case {
  const char* id;
  double half_width;  ///< film, mm
};

TEST(WhiteFurnace, ExactModelsHaveTheIrradianceOfTheLens) {
  for (const auto& [id, half_width] :
       {Case{"double_gauss_100mm_f2.0", 30}, Case{"tessar_100mm_f3.5", 30}, Case{"fisheye_10mm_f4", 9},
        Case{"modern_50mm_f1.0", 18}, Case{"catadioptric_mangin_1000mm_f7.5", 15}, Case{"eye_gullstrand_le_grand", 4},
        Case{"anamorphic_60mm_2x", 10}}) {
    const Lens lens = testing::data_lens(id);
    const Film film{.width_mm = 2 * half_width, .height_mm = 2 * half_width};
    for (const ModelKind model : {ModelKind::exact_float, ModelKind::exact_double}) {
      const Camera camera(lens, film, {.model = model});
      const double axis = film_irradiance(lens, {});
      for (const FilmPoint& part :
           {FilmPoint{0, 0}, FilmPoint{0, 0.5}, FilmPoint{-0.31, 0.77}, FilmPoint{0.95, -0.9}}) {
        const FilmPoint point{part.x * half_width, part.y * half_width};
        EXPECT_NEAR(mean_weight(camera, point) / axis, film_irradiance(lens, point) / axis, 3e-3)
            << id << ' ' << name(model) << " at " << point.x << ", " << point.y;
      }
    }
  }
}

// Pupils of the models have the irradiance of the exact lens: wide open, stopped down, with blades, and around an
// obscuration.
TEST(WhiteFurnace, EveryModelHasTheIrradianceOfTheLensOnTheAxis) {
  const Iris blades{.blades = 6, .roundness = -0.6, .rotation_rad = 0.1};
  const auto at = [](const char* id, double f_number) { return with_f_number(testing::data_lens(id), f_number); };
  for (const Lens& lens :
       {with_focus(at("double_gauss_100mm_f2.0", 2.8), 3000), testing::data_lens("modern_58mm_f0.95"),
        testing::data_lens("fisheye_10mm_f4"), at("telephoto_200mm_f1.8", 16),
        testing::data_lens("catadioptric_mangin_1000mm_f7.5"), testing::data_lens("anamorphic_60mm_2x"),
        with_iris(at("tessar_100mm_f2.8", 8), blades), with_iris(at("double_gauss_100mm_f2.0", 2.9), blades),
        with_iris(at("anamorphic_60mm_2x", 5.6), blades)}) {
    const double real = film_irradiance(lens, {});
    for (const ModelKind model : models()) {
      if (!lens.rotationally_symmetric() && (model == ModelKind::pinhole || model == ModelKind::thin_two_disc))
        continue;
      const Camera camera(lens, {.width_mm = 10, .height_mm = 8}, {.model = model});
      EXPECT_NEAR(mean_weight(camera, {}) / real, 1, 5e-3) << lens.name() << ' ' << name(model);
    }
  }
}

TEST(WhiteFurnace, FittedPupilsHaveTheIrradianceOfTheLensOverTheField) {
  for (const auto& [id, half_width] : {Case{"modern_58mm_f0.95", 12}, Case{"retrofocus_100mm_f2.8", 18},
                                       Case{"fisheye_10mm_f4", 5}, Case{"phone_5.6mm_f3.5", 2.2}}) {
    for (const Iris& iris : {Iris{}, Iris{.blades = 6, .rotation_rad = 0.1}}) {
      const Lens lens = with_iris(with_f_number(testing::data_lens(id), 4.2), iris);
      const Film film{.width_mm = 2 * half_width, .height_mm = 2 * half_width};
      for (const ModelKind model : {ModelKind::thin_two_disc, ModelKind::polynomial(3)}) {
        // Two discs do not describe the cut pupil of the phone lens with blades.
        if (iris.blades > 0 && model == ModelKind::thin_two_disc && half_width < 3) continue;
        const Camera camera(lens, film, {.model = model});
        for (const double part : {0.3, 0.7, 0.97}) {
          const FilmPoint point{0.6 * part * half_width, 0.8 * part * half_width};
          EXPECT_NEAR(mean_weight(camera, point) / film_irradiance(lens, point), 1, 0.02)
              << id << ' ' << name(model) << ' ' << iris.blades;
        }
      }
    }
  }
}

// Film cells of lenses with cylinders, up to the edge of the light.
TEST(WhiteFurnace, CylindersHaveTheIrradianceOfTheLens) {
  for (const auto& [id, f_number, half_width, point] :
       {std::tuple{"cylinder_3.9mm", 0.0, 0.7, FilmPoint{0.4, -0.6}},
        std::tuple{"cylinder_3.9mm", 0.0, 3.0, FilmPoint{-2.9, -2.9}},
        std::tuple{"cylinder_3.9mm", 16.0, 0.7, FilmPoint{-0.5, 0.7}},
        std::tuple{"anamorphic_60mm_2x", 0.0, 18.0, FilmPoint{-16.9, -5.8}},
        std::tuple{"anamorphic_60mm_2x", 0.0, 18.0, FilmPoint{17.6, 0.3}},
        std::tuple{"anamorphic_60mm_2x", 45.0, 14.4, FilmPoint{12.46, 0}},
        std::tuple{"anamorphic_60mm_2x", 64.0, 14.4, FilmPoint{-14.3, 0.3}},
        std::tuple{"anamorphic_60mm_2x", 11.0, 12.0, FilmPoint{8, 11.5}}}) {
    const Lens open = testing::data_lens(id), lens = f_number > 0 ? with_f_number(open, f_number) : open;
    const Camera camera(lens, {.width_mm = 2 * half_width, .height_mm = 2 * half_width},
                        {.model = ModelKind::exact_double});
    EXPECT_NEAR(mean_weight(camera, point, 1 << 16, 7) / film_irradiance(lens, point), 1, 2e-3)
        << id << ' ' << f_number;
  }
}

// The stated error is the maximum over many film points; other points may exceed it slightly.
TEST(WhiteFurnace, StatedExposureErrorHolds) {
  const Lens lens = with_focus(testing::data_lens("double_gauss_100mm_f2_28deg"), 3000);
  const std::array points{FilmPoint{1.2, -3.4}, FilmPoint{3.1, 5.7},  FilmPoint{-9.4, 2.2},
                          FilmPoint{0, -11.9},  FilmPoint{17.5, 0.3}, FilmPoint{-17.9, 11.8}};
  const ErrorSamples samples{.depths_z = {-3000}, .film_points = 256};
  double least = 1, most = 0;
  for (const ModelKind model : models()) {
    const double stated = model_error(lens, {}, model, samples).exposure;
    const Camera camera(lens, {}, {.model = model});
    for (const FilmPoint& point : points) {
      EXPECT_NEAR(mean_weight(camera, point) / film_irradiance(lens, point), 1, 1.1 * stated + 2e-3)
          << name(model) << " at " << point.x << ", " << point.y;
    }
    least = std::min(least, stated), most = std::max(most, stated);
  }
  EXPECT_LT(least, 5e-3);
  EXPECT_GT(most, 0.1);
}

TEST(WhiteFurnace, UnityOnAxisGivesWeightOne) {
  const Lens lens = testing::data_lens("tessar_100mm_f2.8");
  for (const ModelKind model : models()) {
    const CameraOptions options{.model = model, .normalisation = Normalisation::unity_on_axis};
    const Camera camera(lens, {}, options), absolute(lens, {}, {.model = model});
    EXPECT_NEAR(mean_weight(camera, {}), 1, 1e-3) << name(model);
    EXPECT_NEAR(mean_weight(camera, {10, 10}) / mean_weight(camera, {}),
                mean_weight(absolute, {10, 10}) / mean_weight(absolute, {}), 1e-9)
        << name(model);
    if (model < ModelKind::exact_float) continue;
    const double scale = mean_weight(camera, {10, 10}) / mean_weight(absolute, {10, 10});
    EXPECT_NEAR(scale * film_irradiance(lens, {}), 1, 6e-4) << name(model);
  }
}

// The irradiance on the axis depends on the wavelength: the tint of the lens.
TEST(WhiteFurnace, UnityAtEachWavelengthRemovesTheTint) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens lens = compile(testing::data_prescription("ball_10mm"), std::array{440.0, 587.5618, 650.0},
                            {.glasses = &glasses, .missing_glass = MissingGlass::abbe});
  const Film film{.width_mm = 1, .height_mm = 1};
  const auto light = [&](const Camera& camera, std::uint16_t w) { return mean_weight(camera, {}, 16384, 3, w); };
  for (const ModelKind model : {ModelKind::thin, ModelKind::exact_double}) {
    const Camera absolute(lens, film, {.model = model});
    const Camera tinted(lens, film, {.model = model, .normalisation = Normalisation::unity_on_axis});
    const Camera white(lens, film, {.model = model, .normalisation = Normalisation::unity_at_each_wavelength});
    EXPECT_GT(std::abs(light(absolute, 0) / light(absolute, 1) - 1), 2e-3) << name(model);
    EXPECT_NEAR(light(tinted, 1), 1, 2e-3) << name(model);
    for (const std::uint16_t w : {0, 1, 2}) {
      EXPECT_NEAR(light(tinted, w) / light(tinted, 1), light(absolute, w) / light(absolute, 1), 1e-9) << name(model);
      EXPECT_NEAR(light(white, w), 1, 2e-3) << name(model);
      // Importance has the same unit.
      const Ray<double> ray{{0.01, 0, -1000}, {0, 0, 1}};
      const double we = absolute.importance(ray, w).we / light(absolute, w);
      EXPECT_NEAR(tinted.importance(ray, w).we / light(tinted, w), we, 1e-9 * we) << name(model);
      EXPECT_NEAR(white.importance(ray, w).we / light(white, w), we, 1e-9 * we) << name(model);
    }
  }
}

// Tables have 32 strips from the axis to the corner. Rings at the borders would show in the mean over all strips at
// one position within a strip.
TEST(WhiteFurnace, TablesShowNoRings) {
  constexpr int strips = 32, places = 16, count = 4096;
  for (const auto& [id, half_width] :
       {Case{"double_gauss_100mm_f2.0", 28}, Case{"catadioptric_mangin_1000mm_f7.5", 15}}) {
    const Lens lens = testing::data_lens(id);
    const Film film{.width_mm = 2 * half_width, .height_mm = 2 * half_width};
    const Camera camera(lens, film, {.model = ModelKind::exact_float});
    // The irradiance of the lens at every fourth radius; linear interpolation is accurate to 1e-4.
    const auto side_of = [&](double i) { return film.radius_mm() / std::numbers::sqrt2 * i / (strips * places); };
    std::vector<double> irradiance;
    for (int i = 0; i <= strips * places; i += 4) irradiance.push_back(film_irradiance(lens, {side_of(i), side_of(i)}));
    std::mt19937 random(7);
    std::uniform_real_distribution<float> one;
    std::array<double, places> by_place{};
    double before = 0, before_noise = 0, variance = 0;
    for (int i = 0; i < strips * places; ++i) {
      const double side = side_of(i + 0.5);
      testing::Samples<float> samples;
      for (int k = 0; k < count; ++k) samples.add(side, side, one(random), one(random));
      samples.run(camera);
      double sum = 0, squares = 0;
      for (const double w : samples.weights) sum += w, squares += w * w;
      const auto below = static_cast<std::size_t>(i / 4);
      const double expected = std::lerp(irradiance[below], irradiance[below + 1], (i % 4 + 0.5) / 4);
      const double exposure = sum / count / expected;
      const double noise = std::sqrt((squares / count - sum / count * sum / count) / count) / expected;
      if (i > 0) {
        EXPECT_LT(std::abs(exposure - before), 5 * std::hypot(noise, before_noise)) << id << ' ' << i;
      }
      before = exposure, before_noise = noise;
      by_place[static_cast<std::size_t>(i % places)] += exposure / strips;
      variance += noise * noise / (strips * places);
    }
    const double sigma = std::sqrt(variance / strips);
    for (const double exposure : by_place) EXPECT_NEAR(exposure, 1, 4 * sigma + 5e-4) << id;
    const auto [least, most] = std::minmax_element(by_place.begin(), by_place.end());
    EXPECT_LT(*most - *least, 6 * sigma) << id;
  }
}

}  // namespace exposure_test
}  // namespace petzval
