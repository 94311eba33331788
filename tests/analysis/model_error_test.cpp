// SPDX-License-Identifier: Apache-2.0
#include "petzval/analysis/choose_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "camera/exact_model.hpp"
#include "camera/paraxial_model.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace model_error_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_tokens;
constexpr double infinity = std::numeric_limits<double>::infinity();

Lens focused(const std::string& id, double distance, double f_number = 0) {
  Lens lens = data_lens(id);
  if (f_number > 0) lens = with_f_number(lens, f_number);
  return with_focus(lens, distance, {.origin = DistanceOrigin::film});
}

ErrorSamples at(const Lens& lens, std::vector<double> distances, std::uint32_t seed = 0) {
  ErrorSamples samples;
  for (const double d : distances) samples.depths_z.push_back(lens.film_z() - d);
  samples.film_points = 64;
  samples.seed = seed;
  return samples;
}

TEST(ModelError, ExactDoubleIsZero) {
  for (const char* id : {"double_gauss_52mm_f1.8", "anamorphic_60mm_2x", "fisheye_8mm_f2.8"}) {
    const Lens lens = focused(id, 3000);
    const ModelError error = model_error(lens, {}, ModelKind::exact_double, at(lens, {1500, infinity}));
    EXPECT_EQ(error.all.max_mm, 0) << id;
    EXPECT_EQ(error.all.max_of_blur, 0) << id;
    EXPECT_EQ(error.pupil_shape, 0) << id;
    EXPECT_EQ(error.exposure, 0) << id;
    EXPECT_GT(error.all.rays, 1000u) << id;
  }
}

/// Hits in float lie within 0.01 or 0.02 um of hits in double.
TEST(ModelError, ExactFloatIsRounding) {
  for (const double f_number : {2.0, 4.0}) {
    const Lens lens = focused("double_gauss_52mm_f1.8", 3000, f_number);
    const ModelError error = model_error(lens, {}, ModelKind::exact_float, at(lens, {1500, 3000, infinity}));
    EXPECT_GT(error.all.rms_mm, 1e-6);
    EXPECT_LT(error.all.rms_mm, 1e-5);
    EXPECT_LT(error.all.max_mm, 4e-5);
    EXPECT_LT(error.pupil_shape, 1e-3);
  }
}

TEST(ModelError, IsAlsoInPixels) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 3000);
  Film film;
  const RayErrors fine = model_error(lens, film, ModelKind::thick, at(lens, {1500, infinity})).all;
  EXPECT_DOUBLE_EQ(fine.max_px, fine.max_mm / (36.0 / 3840));
  film.columns /= 4, film.rows /= 4;
  const RayErrors coarse = model_error(lens, film, ModelKind::thick, at(lens, {1500, infinity})).all;
  EXPECT_EQ(coarse.max_mm, fine.max_mm);
  EXPECT_DOUBLE_EQ(coarse.rms_px * 4, fine.rms_px);
  EXPECT_LE(fine.rms_mm, fine.p99_mm);
  EXPECT_LE(fine.p99_mm, fine.max_mm);
}

/// Computed from the definition: rays of both models through the rim of the pupil of the film corner.
TEST(ModelError, EqualsDistanceInThePlaneTimesMagnification) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 3000, 5.6);
  const camera_detail::ExactModel<double> exact(lens, 22);
  const camera_detail::ParaxialModel thick(ModelKind::thick, lens, 22);
  const FilmPupilTable& thick_pupils = thick.pupils();
  const double z = lens.film_z() - 3000;

  constexpr std::size_t count = 2000;
  std::vector<double> fx(count, 18), fy(count, 12), px(count), py(count);
  for (std::size_t i = 0; i < count; ++i) {
    const PupilSample s = exact.pupils().sample({18, 12}, static_cast<double>(i % 100) / 100,
                                                0.9 + 0.1 * static_cast<double>(i / 100) / 20);
    px[i] = s.x, py[i] = s.y;
  }
  // The last three lines pass through one point of the pupil, from the corner and two neighbours.
  constexpr double step = 0.01;
  const Vec2<double> middle = exact.pupils().middle({18, 12});
  for (std::size_t i = count - 3; i < count; ++i) px[i] = middle.x, py[i] = middle.y;
  fx[count - 2] -= step, fy[count - 1] -= step;

  const TwoPlaneRays<const double> lines{fx.data(), fy.data(), px.data(), py.data()};
  const auto hits = [&](const auto& model, std::vector<RayFate>& fates) {
    std::vector<double> v(6 * count);
    const RayArrays<double> rays{&v[0], &v[count], &v[2 * count], &v[3 * count], &v[4 * count], &v[5 * count]};
    model.to_scene(count, lines, {}, rays, fates.data());
    std::vector<std::array<double, 2>> places(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = (z - rays.z[i]) / rays.dz[i];
      places[i] = {rays.x[i] + t * rays.dx[i], rays.y[i] + t * rays.dy[i]};
    }
    return places;
  };
  std::vector<RayFate> fates(count), thick_fates(count);
  const auto a = hits(exact, fates), b = hits(thick, thick_fates);
  const auto apart = [](const auto& p, const auto& q) { return std::hypot(p[0] - q[0], p[1] - q[1]); };
  const double magnification = (apart(a[count - 3], a[count - 2]) + apart(a[count - 3], a[count - 1])) / (2 * step);
  double largest = 0;
  for (std::size_t i = 0; i < count - 3; ++i) {
    if (fates[i] != RayFate::transmitted || !thick_pupils.contains({18, 12}, px[i], py[i])) continue;
    largest = std::max(largest, apart(a[i], b[i]) / magnification);
  }
  EXPECT_NEAR(magnification, (3000 - 60) / 52.0, 5);
  EXPECT_NEAR(model_error(lens, {}, ModelKind::thick, at(lens, {3000})).all.max_mm / largest, 1, 0.05);
}

/// A thin lens of weak power: first order is exact in the limit, and errors fall with the square of the size.
TEST(ModelError, FirstOrderFallsWithTheCubeOfTheSize) {
  const Lens lens = with_focus(testing::front_stop_lens(4), 3000, {.origin = DistanceOrigin::film});
  const Lens stopped = with_focus(testing::front_stop_lens(2), 3000, {.origin = DistanceOrigin::film});
  const Film film{.width_mm = 8, .height_mm = 6}, half{.width_mm = 4, .height_mm = 3};
  const double large = model_error(lens, film, ModelKind::thick, at(lens, {3000})).all.max_mm;
  const double small = model_error(stopped, half, ModelKind::thick, at(stopped, {3000})).all.max_mm;
  EXPECT_NEAR(large / small, 8, 0.4);
}

TEST(ModelError, PolynomialsFallWithTheDegree) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 3000, 2);
  double before = infinity;
  for (const ModelKind model :
       {ModelKind::thick, ModelKind::polynomial(3), ModelKind::polynomial(5), ModelKind::polynomial(7),
        ModelKind::polynomial(9), ModelKind::polynomial(11), ModelKind::exact_float}) {
    const ModelError error = model_error(lens, {}, model, at(lens, {1500, 3000, infinity}));
    EXPECT_LT(error.all.max_mm, 0.5 * before) << name(model);
    before = error.all.max_mm;
  }
}

/// Two sets of samples find the same largest errors.
TEST(ModelError, IsNearlyIndependentOfSamples) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 3000);
  for (const ModelKind model : {ModelKind::thick, ModelKind::polynomial(5), ModelKind::polynomial(9)}) {
    std::vector<ModelError> found;
    for (const std::uint32_t seed : {0, 1, 2}) {
      ErrorSamples samples = at(lens, {1500, infinity}, seed);
      samples.film_points = 256;
      found.push_back(model_error(lens, {}, model, samples));
    }
    for (const ModelError& e : found) {
      EXPECT_NEAR(e.all.max_mm / found[0].all.max_mm, 1, 0.06) << name(model);
      EXPECT_NEAR(e.all.rms_mm / found[0].all.rms_mm, 1, 0.03) << name(model);
      EXPECT_NEAR(e.pupil_shape, found[0].pupil_shape, 0.002 + 0.03 * found[0].pupil_shape) << name(model);
      EXPECT_NEAR(e.exposure, found[0].exposure, 0.002 + 0.03 * found[0].exposure) << name(model);
    }
  }
}

/// The error of a pinhole is half the blur plus the first-order error of the chief ray; for large blurs the first term
/// dominates.
TEST(ModelError, PinholeIsHalfTheBlurFarFromFocus) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 1000, 5.6);
  const ModelError error = model_error(lens, {.width_mm = 6, .height_mm = 4}, ModelKind::pinhole, at(lens, {infinity}));
  EXPECT_NEAR(error.all.max_of_blur, 0.5, 0.03);
  EXPECT_EQ(error.pupil_shape, 1);
}

TEST(ModelError, DistinguishesWavelengths) {
  const auto glasses = GlassCatalogue::load(std::filesystem::path(PETZVAL_TEST_DATA) / "glass");
  const Lens lens = with_focus(compile(data_prescription("cooke_triplet_50mm_f5"), std::array{486.1, 587.6, 656.3},
                                       {.glasses = &glasses, .missing_glass = MissingGlass::abbe}),
                               3000, {.origin = DistanceOrigin::film});
  ErrorSamples samples = at(lens, {3000, infinity});
  const ModelError all = model_error(lens, {}, ModelKind::polynomial(5), samples);
  ASSERT_EQ(all.wavelength.size(), 3u);
  samples.wavelengths = {2};
  const ModelError red = model_error(lens, {}, ModelKind::polynomial(5), samples);
  ASSERT_EQ(red.wavelength.size(), 1u);
  EXPECT_EQ(red.all.max_mm, all.wavelength[2].max_mm);
  EXPECT_NEAR(red.all.rms_mm, all.wavelength[2].rms_mm, 1e-12);
  double largest = 0;
  std::size_t rays = 0;
  for (const RayErrors& e : all.wavelength) largest = std::max(largest, e.max_mm), rays += e.rays;
  EXPECT_EQ(all.all.max_mm, largest);
  EXPECT_EQ(all.all.rays, rays);
}

/// Wide fields, which see planes edge-on, and mirrors with a central obscuration have finite errors.
TEST(ModelError, IsFiniteForEveryKindOfLens) {
  for (const char* id : {"fisheye_6.3mm_f2.8", "catadioptric_mangin_1000mm_f7.5", "anamorphic_60mm_2x",
                         "mirror_newton_200mm_f8", "hologon_15mm_f8"}) {
    const Lens lens = focused(id, 20000);
    const Film film{.width_mm = 12, .height_mm = 8};
    for (const ModelKind model : {ModelKind::thick, ModelKind::exact_float}) {
      if (model == ModelKind::thick && !lens.rotationally_symmetric()) continue;
      const ModelError error = model_error(lens, film, model, at(lens, {10000, 1e8, infinity}));
      for (const double x : {error.all.rms_mm, error.all.p99_mm, error.all.max_mm, error.all.max_of_blur,
                             error.pupil_shape, error.exposure}) {
        EXPECT_TRUE(std::isfinite(x)) << id << ' ' << name(model);
      }
      EXPECT_GT(error.all.rays, 1000u) << id;
      EXPECT_LT(error.all.max_mm, model == ModelKind::exact_float ? 2e-3 : infinity) << id;
    }
  }
}

TEST(ModelError, RefusesInvalidInput) {
  const Lens lens = focused("double_gauss_52mm_f1.8", 3000);
  const auto refusal = [&](const Film& film, ModelKind model, const ErrorSamples& samples) {
    return testing::message([&] { model_error(lens, film, model, samples); });
  };
  expect_tokens(refusal({}, ModelKind::thick, {}), {"no depths"});
  for (const double z : {0.0, 10.0, std::nan("")}) {
    expect_tokens(refusal({}, ModelKind::thick, {.depths_z = {z}}), {z, "front"});
  }
  expect_tokens(refusal({}, ModelKind::thick, {.depths_z = {-1000}, .wavelengths = {1}}), {"wavelength", 1});
  for (const std::size_t points :
       {std::size_t{0}, (std::size_t{1} << 20) + 1, std::numeric_limits<std::size_t>::max()}) {
    expect_tokens(refusal({}, ModelKind::thick, {.depths_z = {-1000}, .film_points = points}), {"film points", points});
  }
  expect_tokens(refusal({.width_mm = 0}, ModelKind::thick, {.depths_z = {-1000}}), {"film", 0, 24});
  expect_tokens(refusal({.tilt_rad = 0.1}, ModelKind::thick, {.depths_z = {-1000}}), {"tilt_rad", 0.1});
  const Lens cylinders = focused("anamorphic_60mm_2x", 3000);
  EXPECT_THROW(model_error(cylinders, {}, ModelKind::pinhole, at(cylinders, {3000})), Error);
}

}  // namespace model_error_test
}  // namespace petzval
