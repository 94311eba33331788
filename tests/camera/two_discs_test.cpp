// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/bokeh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "petzval/camera/camera.hpp"

namespace petzval {
namespace two_discs_test {

using testing::data_lens;
using testing::expect_error;

// Errors are larger on larger films: 5 % for a Tessar on twice the film, 7 % for a fisheye of 180 degrees.
TEST(TwoDiscs, FitThePupilsOfRealLenses) {
  constexpr double film_24x36 = 21.64;
  for (const auto& [id, radius] :
       {std::pair{"double_gauss_100mm_f2.0", film_24x36}, std::pair{"double_gauss_100mm_f1.35", film_24x36},
        std::pair{"tessar_100mm_f3.5", film_24x36}, std::pair{"fisheye_10mm_f4", 11.0}}) {
    const TwoDiscs discs = fit_two_discs(data_lens(id), radius);
    EXPECT_LT(discs.error, 0.03) << id;
    EXPECT_EQ(discs.errors.size(), discs.film_mm.size());
    EXPECT_GE(discs.lens_ratio, 1) << id;
    EXPECT_GT(std::abs(discs.rate_of_change), 0.05) << id;
  }
}

// As controls of a thin lens they give the vignetting of the exact lens.
TEST(TwoDiscs, AreControlsOfACamera) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const Film film{.width_mm = 36, .height_mm = 24};
  const TwoDiscs discs = fit_two_discs(lens, film.width_mm / 2);
  const auto light = [&](const Camera& camera, double x) {
    double sum = 0;
    constexpr std::size_t count = 4096;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [u, v] = testing::fibonacci_point(i, count);
      sum += camera.sample({.film = {x, 0}, .pupil_u = u, .pupil_v = v}).weight / count;
    }
    return sum;
  };
  const BokehControls eye{.lens_ratio = discs.lens_ratio, .rate_of_change = discs.rate_of_change};
  const Camera thin(lens, film, {.model = ModelKind::thin, .bokeh = eye}),
      plain(lens, film, {.model = ModelKind::thin});
  const Camera exact(lens, film, {.model = ModelKind::exact_float});
  const double wanted = light(exact, 17) / light(exact, 0);
  EXPECT_NEAR(light(thin, 17) / light(thin, 0), wanted, 0.05);
  EXPECT_GT(light(plain, 17) / light(plain, 0), wanted + 0.2);
}

/// Radius of the beam towards a distant point of the axis, mm.
double beam_radius(const Camera& camera) {
  double largest = 0;
  constexpr std::size_t count = 16384;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [u, v] = testing::fibonacci_point(i, count);
    const CameraRay ray = camera.sample({.film = {0, 0}, .pupil_u = u, .pupil_v = v});
    if (ray.weight > 0) largest = std::max(largest, std::hypot(ray.ray.origin.x, ray.ray.origin.y));
  }
  return largest;
}

// The fit holds for film points; the header states by how much the pupils of distant points are smaller.
TEST(TwoDiscs, ExceedPupilsOfFarPointsAsStated) {
  for (const auto& [id, larger] : {std::pair{"tessar_100mm_f2.8", 0.026}, std::pair{"double_gauss_100mm_f2.0", 0.055},
                                   std::pair{"double_gauss_100mm_f1.35", 0.144}}) {
    const Lens lens = data_lens(id);
    const Film film{.width_mm = 36, .height_mm = 24};
    const double ratio = beam_radius(Camera(lens, film, {.model = ModelKind::thin_two_disc})) /
                         beam_radius(Camera(lens, film, {.model = ModelKind::exact_double}));
    EXPECT_NEAR(ratio * ratio - 1, larger, 0.01) << id;
  }
}

TEST(TwoDiscs, RefuseInvalidInput) {
  const Lens lens = data_lens("tessar_100mm_f2.8");
  for (const double radius : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_error([&] { fit_two_discs(lens, radius); }, {lens.name(), "film_radius", radius});
  }
  const Lens anamorphic = data_lens("anamorphic_60mm_2x");
  expect_error([&] { fit_two_discs(anamorphic, 10); }, {anamorphic.name(), "fit_two_discs"});
}

}  // namespace two_discs_test
}  // namespace petzval
