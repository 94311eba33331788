// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/lens_metadata.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "../data_lenses.hpp"
#include "distorting_lenses.hpp"
#include "petzval/analysis/transmittance.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace lens_metadata_test {

using testing::data_lens;
using testing::data_prescription;
using testing::small_film;

LensState state_of(const Lens& lens) {
  return lens_state(LensDistortion(Camera(lens, small_film(24), {.model = ModelKind::exact_double})));
}

TEST(LensMetadata, IdentityEqualsThePrescription) {
  const Prescription p = data_prescription("biogon_35mm_f2.8");
  EXPECT_EQ(identity_of(p).model, p.name);
  EXPECT_EQ(identity_of(p).nominal_focal_length_mm, p.focal_length_mm);
}

TEST(LensMetadata, StateEqualsTheFocusedLens) {
  const Lens lens =
      with_focus(with_f_number(data_lens("double_gauss_100mm_f2_28deg"), 4), 2000, {.origin = DistanceOrigin::film});
  const LensState state = state_of(lens);
  EXPECT_EQ(state.effective_focal_length_mm, first_order(lens).effective_focal_length);
  EXPECT_NEAR(state.f_number, 4, 0.01);
  EXPECT_NEAR(state.focus_distance_mm, 2000, 1e-6);
  EXPECT_EQ(state.entrance_pupil_offset_mm, lens.film_z() - pupils(lens).entrance.z);
  // For paraxial chief rays, the magnification of a point at distance s from the entrance pupil is F / s.
  EXPECT_GT(state.pinhole_focal_length_mm, state.effective_focal_length_mm);
  const Lens far = with_focus(lens, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isinf(state_of(far).focus_distance_mm));
  EXPECT_NEAR(state_of(far).pinhole_focal_length_mm, first_order(lens).effective_focal_length, 0.3);
}

TEST(LensMetadata, AreaFNumberIncludesBladesAndObscurations) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2_28deg"), 4);
  const LensState round = state_of(lens), square = state_of(with_iris(lens, {.blades = 4}));
  EXPECT_NEAR(round.area_f_number, round.f_number, 2e-3 * round.f_number);
  // The square inscribed in a circle has 2 / pi of its area.
  EXPECT_NEAR(square.area_f_number / square.f_number, std::sqrt(std::numbers::pi / 2), 3e-3);
  const LensState mirrors = state_of(data_lens("catadioptric_mangin_1000mm_f7.5"));
  EXPECT_GT(mirrors.area_f_number, 1.05 * mirrors.f_number);
}

TEST(LensMetadata, TNumberIsAbsentWithoutCoatings) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f2_28deg"), 4);
  EXPECT_FALSE(state_of(lens).t_number);
  for (const Coating& coating : {Coating{}, Coating::quarter_wave()}) {
    const Lens coated = with_coating(lens, coating);
    const LensState state = state_of(coated);
    const double light = transmittance(coated, FieldPoint{.z = -std::numeric_limits<double>::infinity()}).value();
    EXPECT_LT(light, 0.97);
    EXPECT_EQ(state.t_number.value(), state.area_f_number / std::sqrt(light));
  }
}

// Irradiance through a small stop at the centre of a ball falls as cos^4: (1 + x^2)^-2 = 1 - 2 x^2 + 3 x^4 - ...
TEST(ExposureFalloff, BallFollowsCosineToTheFourth) {
  const testing::BallAndPlate ball;
  const double focal_length = ball.focal_length_mm();
  const ExposureFalloff falloff = fit_exposure_falloff(ball.lens(), small_film(6));
  EXPECT_NEAR(falloff.coefficients[0] * focal_length * focal_length, 2, 0.02);
  EXPECT_LT(falloff.largest_error, 1e-3);
  EXPECT_NEAR(falloff.light(3), std::pow(1 + 9 / (focal_length * focal_length), -2), 1e-3);
  EXPECT_EQ(falloff.light(0), 1);
}

TEST(ExposureFalloff, EqualsIrradianceWithinItsError) {
  for (const char* id : {"double_gauss_100mm_f2_28deg", "biogon_35mm_f2.8", "anamorphic_60mm_2x"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const Film film = small_film(30);
    const ExposureFalloff falloff = fit_exposure_falloff(lens, film);
    EXPECT_LT(falloff.largest_error, 0.2);  // a polynomial cannot follow the edge of an image circle
    if (!lens.rotationally_symmetric()) continue;
    for (const double part : {0.11, 0.43, 0.77, 0.98}) {
      const double radius = part * film.radius_mm();
      const double light = film_irradiance(lens, {radius, 0}) / film_irradiance(lens, {});
      EXPECT_NEAR(falloff.light(radius), light, 1.3 * falloff.largest_error + 1e-3);
    }
  }
}

}  // namespace lens_metadata_test
}  // namespace petzval
