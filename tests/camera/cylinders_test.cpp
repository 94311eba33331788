// SPDX-License-Identifier: Apache-2.0
// Polynomial cameras of lenses with cylinders, compared with exact cameras.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <string>

#include "../data_lenses.hpp"
#include "camera_samples.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace cylinders_test {

using testing::random_samples;

const Film film{.width_mm = 20, .height_mm = 14};

Lens anamorphic(double f_number = 0) {
  const Lens open = testing::data_lens("anamorphic_60mm_2x");
  return with_focus(f_number > 0 ? with_f_number(open, f_number) : open, 3000, {.origin = DistanceOrigin::film});
}

TEST(Cylinders, SamplesOfPolynomialsPassTheExactLens) {
  for (const double f_number : {0.0, 4.0, 8.0, 16.0, 32.0}) {
    const Lens lens = anamorphic(f_number);
    const Camera camera(lens, film, {.model = ModelKind::polynomial(7)});
    auto samples = random_samples(film, 10000);
    samples.run(camera);
    EXPECT_EQ(std::count(samples.fates.begin(), samples.fates.end(), RayFate::transmitted), 10000) << f_number;
    const Camera exact(lens, film, {.model = ModelKind::exact_double});
    int passed = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Ray<double> ray = samples.ray(i);
      passed += exact.importance({ray.origin, -ray.direction}).fate == RayFate::transmitted;
    }
    EXPECT_GT(passed, 0.95 * 10000) << f_number;
  }
}

// In each section, rays cross the plane of the entrance pupil at p with slopes s. At the distance `away` from this
// plane they miss the axis by s + p / away, seen from the pupil; the mean square is smallest at away = -pp / ps.
TEST(Cylinders, PolynomialsFocusWithExactRaysInBothSections) {
  for (const double f_number : {0.0, 4.0}) {
    const Lens lens = anamorphic(f_number);
    const double pupil_z = pupils(lens).entrance.z;
    const auto sharpest = [&](ModelKind model, int axis) {
      const Camera camera(lens, film, {.model = model});
      double ss = 0, ps = 0, pp = 0;
      constexpr int count = 16384;
      for (int i = 0; i < count; ++i) {
        const double u = std::fmod(i * 0.7548776662466927, 1), v = std::fmod(i * 0.5698402909980532, 1);
        const CameraRay r = camera.sample({.film = {}, .pupil_u = u, .pupil_v = v});
        if (!r) continue;
        const auto& [o, d] = r.ray;
        const double s = d[axis] / d.z, p = o[axis] + (pupil_z - o.z) * s;
        ss += r.weight * s * s, ps += r.weight * p * s, pp += r.weight * p * p;
      }
      const double half_depth = std::sqrt((1.05 * 1.05 - 1) * (ss - ps * ps / pp) / pp);
      return std::array{-ps / pp, half_depth};
    };
    for (const int axis : {0, 1}) {
      const auto [exact, half_depth] = sharpest(ModelKind::exact_double, axis);
      for (const ModelKind model : {ModelKind::polynomial(3), ModelKind::polynomial(5), ModelKind::polynomial(7),
                                    ModelKind::polynomial(9), ModelKind::polynomial(11)}) {
        EXPECT_NEAR(sharpest(model, axis)[0], exact, half_depth) << name(model) << " along "
                                                                 << "xy"[axis];
      }
    }
  }
}

TEST(Cylinders, PolynomialsWorkBetweenCompiledWavelengths) {
  const GlassCatalogue glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Prescription prescription = testing::data_prescription("anamorphic_60mm_2x");
  const auto compiled = [&](std::span<const double> nm) {
    return compile(prescription, nm, {.glasses = &glasses, .missing_glass = MissingGlass::abbe});
  };
  const Camera camera(compiled(std::array{440.0, 500.0, 560.0, 620.0, 680.0}), film,
                      {.model = ModelKind::polynomial(7)});
  const Camera own(compiled(std::array{587.5618}), film, {.model = ModelKind::polynomial(7)});
  const double pixel = film.width_mm / film.columns;
  auto samples = random_samples(film, 500);
  samples.run(own);
  int compared = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.fates[i] != RayFate::transmitted) continue;
    const Ray<double> ray = samples.ray(i);
    const Importance back = camera.importance({ray.origin, -ray.direction}, Wavelength::nm(587.5618));
    if (back.fate == RayFate::outside_fit || back.fate == RayFate::vignetted) continue;
    ++compared;
    EXPECT_LT(std::hypot(back.film.x - samples.film_x[i], back.film.y - samples.film_y[i]), 0.05 * pixel);
  }
  EXPECT_GT(compared, 450);
}

}  // namespace cylinders_test
}  // namespace petzval
