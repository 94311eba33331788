// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/distortion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "distorting_lenses.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace brown_conrady_test {

using testing::BallAndPlate;
using testing::data_lens;
using testing::expect_error;
using testing::small_film;

constexpr std::array directions{BrownConradyDirection::to_undistorted, BrownConradyDirection::to_distorted};
constexpr std::array forms{RadialForm::polynomial, RadialForm::rational};

LensDistortion distortion_of(const Lens& lens, const Film& film) {
  return LensDistortion(Camera(lens, film, {.model = ModelKind::exact_double}));
}

TEST(BrownConrady, PinholeHasNoDistortion) {
  const LensDistortion none(Camera(data_lens("biogon_35mm_f2.8"), small_film(36), {.model = ModelKind::pinhole}));
  for (const auto direction : directions) {
    for (const auto form : forms) {
      const BrownConrady fit = fit_brown_conrady(none, direction, form);
      for (const double k : fit.k) EXPECT_NEAR(k, 0, 1e-6);
      EXPECT_LT(fit.largest_px, 1e-5);
    }
  }
}

// A plate of index n refracts a field of tangent x to tan' = x / n (1 + x^2 (1 - 1 / n^2))^(-1/2), whose term of x^3
// gives k1.
TEST(BrownConrady, FindsTheCoefficientOfAPlate) {
  const BallAndPlate plate{.plate_mm = 8};
  const double n = BallAndPlate::plate_index;
  const double k1 = -plate.plate_mm / (2 * n * plate.focal_length_mm()) * (1 - 1 / (n * n));
  const LensDistortion distortion = distortion_of(plate.lens(), small_film(12));
  const BrownConrady out = fit_brown_conrady(distortion, BrownConradyDirection::to_distorted, RadialForm::polynomial);
  const BrownConrady in = fit_brown_conrady(distortion, BrownConradyDirection::to_undistorted, RadialForm::polynomial);
  EXPECT_NEAR(out.k[0], k1, 1e-3 * std::abs(k1));
  EXPECT_NEAR(in.k[0], -k1, 1e-3 * std::abs(k1));
  EXPECT_NEAR(out.field_rad, std::atan(std::hypot(6, 4) / plate.focal_length_mm()), 0.01);
}

struct Case {
  std::string lens;
  double film_mm;
  double polynomial_px, rational_px;  ///< largest errors on films of 480 pixels
};

void PrintTo(const Case& test, std::ostream* out) { *out << test.lens; }

class BrownConradyFits : public ::testing::TestWithParam<Case> {};

// Errors are measured with exact chief rays from the scene, at points that the fit does not use.
TEST_P(BrownConradyFits, PredictChiefRaysWithinTheirError) {
  const auto& [id, film_mm, polynomial_px, rational_px] = GetParam();
  const Lens lens = data_lens(id);
  const Film film = small_film(film_mm);
  const LensDistortion distortion = distortion_of(lens, film);
  const double px = distortion.focal_length_px().x;
  for (const auto direction : directions) {
    for (const auto form : forms) {
      SCOPED_TRACE(std::string(name(direction)) + (form == RadialForm::rational ? " rational" : " polynomial"));
      const BrownConrady fit = fit_brown_conrady(distortion, direction, form);
      EXPECT_LT(fit.largest_px, form == RadialForm::rational ? rational_px : polynomial_px);
      EXPECT_LE(fit.rms_px, fit.largest_px);
      const testing::Kronecker<2> random(5);
      for (std::uint32_t i = 0; i < 60; ++i) {
        const auto point = random(i);
        const double field = fit.field_rad * 0.999 * point[0], tangent = std::tan(field);
        const AimedRay chief = chief_ray(lens, {field, distortion.pinhole().subject_z_mm, 6 * point[1]});
        if (!chief) continue;
        const Ray<double>& ray = chief.end.ray;
        const double along = (lens.film_z() - ray.origin.z) / ray.direction.z;
        const double height =
            std::hypot(ray.origin.x + along * ray.direction.x, ray.origin.y + along * ray.direction.y);
        const double distorted = height / fit.pinhole.focal_length_mm.x;
        const double error = direction == BrownConradyDirection::to_undistorted ? fit.radius(distorted) - tangent
                                                                                : fit.radius(tangent) - distorted;
        EXPECT_LT(std::abs(error) * px, 1.1 * fit.largest_px + 1e-4) << "field " << field;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, BrownConradyFits,
                         ::testing::Values(Case{"double_gauss_100mm_f2_28deg", 36, 0.001, 1e-4},
                                           Case{"biogon_35mm_f2.8", 36, 0.06, 2e-4},
                                           Case{"zoom_14-30mm_f4:wide", 36, 0.6, 0.3},
                                           Case{"fisheye_10mm_f4", 16, 1.5, 1e-3},
                                           Case{"retrofocus_100mm_f2", 120, 0.1, 1e-3},
                                           Case{"catadioptric_mangin_1000mm_f7.5", 36, 0.01, 1e-3}));

TEST(BrownConrady, HasNoPoleWithinTheFilm) {
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    if (!lens.rotationally_symmetric() || p.id.find("fisheye") != std::string::npos) continue;
    SCOPED_TRACE(p.id);
    const LensDistortion distortion =
        distortion_of(lens, small_film(0.83 * std::min(p.image_diagonal_mm.value_or(400), image_circle_mm(lens, 0.1))));
    for (const auto direction : directions) {
      const BrownConrady fit = fit_brown_conrady(distortion, direction);
      // The range ends at the edge of the field, whose radius differs between both images.
      const double tangent = std::tan(fit.field_rad), step = tangent / 200;
      const bool in = direction == BrownConradyDirection::to_undistorted;
      double r = 0;
      for (int i = 0; i < 400 && (in ? fit.radius(r) : r) < tangent; ++i, r += step) {
        EXPECT_GT(1 + r * r * (fit.k[3] + r * r * (fit.k[4] + r * r * fit.k[5])), 0);
      }
      EXPECT_GE(r, tangent / 2);
      EXPECT_LT(fit.largest_px, 4);  // of 480 pixels
      EXPECT_GT(fit.rises_to_rad, fit.field_rad);
    }
  }
}

// Hosts may evaluate outside the image or in float, and get a monotonic continuation.
TEST(BrownConrady, TermsAreBoundedAndRadiiAreMonotonic) {
  int number = 0;
  for (const Prescription& p : testing::data_prescriptions()) {
    if (number++ % 4 != 0) continue;  // every fourth suffices
    const Lens lens = compile(p);
    if (!lens.rotationally_symmetric() || p.id.find("fisheye") != std::string::npos) continue;
    SCOPED_TRACE(p.id);
    const LensDistortion distortion =
        distortion_of(lens, small_film(0.83 * std::min(p.image_diagonal_mm.value_or(400), image_circle_mm(lens, 0.1))));
    for (const auto direction : directions) {
      const BrownConrady fit = fit_brown_conrady(distortion, direction);
      const bool in = direction == BrownConradyDirection::to_undistorted;
      // The largest radius of the fit, in the image from which the fit maps.
      double largest = 0;
      for (const auto& corner : {Vec2<double>{0, 0}, Vec2<double>{240, 0}, Vec2<double>{0, 160}}) {
        const auto other = distortion.undistorted(corner);
        if (!other) continue;
        const Vec2<double> at = ((in ? corner : *other) - distortion.centre()) / distortion.focal_length_px();
        largest = std::max(largest, std::hypot(at.x, at.y));
      }
      for (std::size_t j = 0; j < fit.k.size(); ++j) {
        EXPECT_LE(std::abs(fit.k[j]) * std::pow(largest, 2.0 * static_cast<double>(j % 3 + 1)), 100.001);
      }
      double before = 0;
      for (double r = largest / 100; r < 4 * largest; r += largest / 100) {
        const double found = fit.radius(r);
        if (std::atan(in ? found : r) > 0.9 * fit.rises_to_rad) break;
        ASSERT_GT(found, before) << r / largest;
        before = found;
      }
    }
  }
}

// Cases in which a linear fit has a pole or is not the least-squares fit.
TEST(BrownConrady, FindsTheRationalLeastSquaresFit) {
  using enum BrownConradyDirection;
  for (const auto& [id, direction, rms_px] :
       {std::tuple("tessar_100mm_f5.5_1902", to_distorted, 0.03), std::tuple("heliar_100mm_f4", to_distorted, 0.001),
        std::tuple("biotar_100mm_f1.4", to_undistorted, 0.05)}) {
    const Lens lens = data_lens(id);
    const LensDistortion distortion =
        distortion_of(lens, default_film(lens, testing::data_prescription(id).image_diagonal_mm));
    EXPECT_LT(fit_brown_conrady(distortion, direction).rms_px, rms_px) << id;
  }
}

TEST(BrownConrady, RefusesOtherDistortions) {
  Film tilted = small_film(36);
  tilted.tilt_rad = 0.01;
  for (const auto& [id, film, word] :
       {std::tuple("anamorphic_60mm_2x", small_film(24), "cylinders"),
        std::tuple("fisheye_8mm_f2.8", small_film(24), "fisheye"),
        std::tuple("fisheye_6.3mm_f2.8", small_film(24), "fisheye"), std::tuple("biogon_35mm_f2.8", tilted, "film")}) {
    const LensDistortion distortion(Camera(data_lens(id), film));
    expect_error([&] { fit_brown_conrady(distortion); }, {data_lens(id).name(), word});
  }
}

// Blades bend no ray; the centre of a pupil of five blades differs slightly from the centre of a disc.
TEST(BrownConrady, IsNearlyIndependentOfBlades) {
  const Lens lens = data_lens("biogon_35mm_f2.8");
  const auto fit = [](const Lens& l) { return fit_brown_conrady(distortion_of(l, small_film(36))); };
  const BrownConrady bladed = fit(with_iris(lens, {.blades = 5})), round = fit(lens);
  for (std::size_t i = 0; i < round.k.size(); ++i) EXPECT_NEAR(bladed.k[i], round.k[i], 1e-3);
  EXPECT_NEAR(bladed.largest_px, round.largest_px, 0.01);
}

TEST(BrownConrady, NamesItsDirection) {
  EXPECT_EQ(name(BrownConradyDirection::to_undistorted), "Brown-Conrady D-U");
  EXPECT_EQ(name(BrownConradyDirection::to_distorted), "Brown-Conrady U-D");
}

}  // namespace brown_conrady_test
}  // namespace petzval
