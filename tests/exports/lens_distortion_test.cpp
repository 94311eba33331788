// SPDX-License-Identifier: Apache-2.0
#include "petzval/exports/distortion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../low_discrepancy.hpp"
#include "distorting_lenses.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {
namespace lens_distortion_test {

using testing::BallAndPlate;
using testing::data_lens;
using testing::expect_error;
using testing::small_film;

double far_apart(const Vec2<double>& a, const Vec2<double>& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Uniform image positions.
std::vector<Vec2<double>> places(const Film& film, int count = 60) {
  std::vector<Vec2<double>> result;
  const testing::Kronecker<2> random(3);
  for (int i = 0; i < count; ++i) {
    const auto point = random(static_cast<std::size_t>(i));
    result.push_back({point[0] * film.columns, point[1] * film.rows});
  }
  return result;
}

TEST(LensDistortion, IsZeroForLinearModels) {
  const Film film = small_film(36);
  for (const ModelKind model : {ModelKind::pinhole, ModelKind::thin, ModelKind::thick}) {
    SCOPED_TRACE(name(model));
    const LensDistortion distortion(Camera(data_lens("biogon_35mm_f2.8"), film, {.model = model}));
    for (const Vec2<double>& at : places(film)) {
      const auto shown = distortion.distorted(at), back = distortion.undistorted(at);
      ASSERT_TRUE(shown && back);
      EXPECT_LT(far_apart(*shown, at), 2e-6);
      EXPECT_LT(far_apart(*back, at), 2e-6);
    }
  }
}

TEST(LensDistortion, KeepsTheScaleOnTheAxis) {
  // In the phone lens, odd aspheric terms change the slope of chief rays at 1e-3 rad from the axis.
  for (const auto& [id, within] : {std::pair("phone_5.6mm_f3.5", 1e-4), std::pair("fisheye_8mm_f2.8", 1e-6),
                                   std::pair("tessar_100mm_f2.8", 1e-6)}) {
    const Lens lens = data_lens(id);
    for (const double size : {1.0, 0.1}) {
      Film film = default_film(lens, testing::data_prescription(id).image_diagonal_mm);
      film.width_mm *= size, film.height_mm *= size;
      const auto focal_length = [&](ModelKind model) {
        return LensDistortion(Camera(lens, film, {.model = model})).pinhole().focal_length_mm.y;
      };
      const double expected = focal_length(ModelKind::thick);
      EXPECT_NEAR(focal_length(ModelKind::exact_double), expected, within * expected) << id << ' ' << size;
    }
  }
}

TEST(LensDistortion, IsZeroForABallWithACentralStop) {
  const Film film = small_film(18);
  const LensDistortion distortion(Camera(BallAndPlate{}.lens(), film, {.model = ModelKind::exact_double}));
  EXPECT_NEAR(distortion.pinhole().focal_length_mm.x, BallAndPlate{}.focal_length_mm(), 1e-6);
  EXPECT_NEAR(distortion.pinhole().focal_length_mm.y, BallAndPlate{}.focal_length_mm(), 1e-6);
  EXPECT_NEAR(distortion.pinhole().z_mm, BallAndPlate::radius_mm, 1e-9);
  for (const Vec2<double>& at : places(film)) {
    const auto shown = distortion.distorted(at);
    ASSERT_TRUE(shown);
    EXPECT_LT(far_apart(*shown, at), 1e-4);
  }
}

TEST(LensDistortion, PlateFollowsSnellsLaw) {
  const Film film = small_film(24);
  const BallAndPlate plate{.plate_mm = 8};
  const LensDistortion distortion(Camera(plate.lens(), film, {.model = ModelKind::exact_double}));
  const double focal_length = plate.focal_length_mm(), pixel = film.pixel_mm();
  EXPECT_NEAR(distortion.pinhole().focal_length_mm.x, focal_length, 2e-5);
  double most = 0;
  for (const Vec2<double>& at : places(film)) {
    const Vec2<double> from_axis = at - distortion.centre();
    const double undistorted = std::hypot(from_axis.x, from_axis.y) * pixel;
    const double distorted = plate.height_mm(undistorted / focal_length);
    const auto shown = distortion.distorted(at);
    ASSERT_TRUE(shown);
    EXPECT_LT(far_apart(*shown, distortion.centre() + from_axis * (distorted / undistorted)), 1e-4);
    most = std::max(most, std::abs(distorted - undistorted) / pixel);
  }
  EXPECT_GT(most, 5);
}

// A plate behind a stop has no focal length, but forms an image.
TEST(LensDistortion, NeedsNoFocalLength) {
  Prescription p;
  p.name = "plate";
  p.surfaces = {{.thickness = 10, .semi_diameter = 0.1, .stop = true},
                {.thickness = 6, .medium = {.nd = 1.5}, .semi_diameter = 30},
                {.thickness = 14, .semi_diameter = 30}};
  const Lens lens = compile(p);
  EXPECT_TRUE(first_order(lens).afocal);
  const LensDistortion distortion(Camera(lens, small_film(12), {.model = ModelKind::exact_double}), -1000.0);
  EXPECT_NEAR(distortion.pinhole().focal_length_mm.x, 24 + 6 / 1.5, 1e-4);
}

// The reference aims chief rays at the stop from the scene.
TEST(LensDistortion, EqualsExactChiefRays) {
  for (const char* id : {"double_gauss_100mm_f2_28deg", "biogon_35mm_f2.8", "zoom_14-30mm_f4:wide"}) {
    for (const double focus : {1000.0, std::numeric_limits<double>::infinity()}) {
      SCOPED_TRACE(id + std::string(", ") + std::to_string(focus));
      const Lens lens = with_focus(data_lens(id), focus);
      const Film film = small_film(36);
      const LensDistortion distortion(Camera(lens, film, {.model = ModelKind::exact_double}));
      const Pinhole& pinhole = distortion.pinhole();
      EXPECT_NEAR(1 / pinhole.subject_z_mm, -1 / focus, 1e-12);
      EXPECT_EQ(pinhole.z_mm, pupils(lens).entrance.z);
      for (const Vec2<double>& at : places(film)) {
        const auto shown = distortion.distorted(at);
        ASSERT_TRUE(shown);
        const Vec2<double> tangent = (at - distortion.centre()) / distortion.focal_length_px();
        const AimedRay chief = chief_ray(lens, {.field_rad = std::atan(std::hypot(tangent.x, tangent.y)),
                                                .z = pinhole.subject_z_mm,
                                                .azimuth_rad = std::atan2(tangent.x, -tangent.y)});
        ASSERT_TRUE(chief);
        const Ray<double>& ray = chief.end.ray;
        const double along = (lens.film_z() - ray.origin.z) / ray.direction.z;
        EXPECT_LT(far_apart(*shown, film.raster({ray.origin.x + along * ray.direction.x,
                                                 ray.origin.y + along * ray.direction.y})),
                  1e-4);
      }
    }
  }
}

TEST(LensDistortion, InverseRoundTrips) {
  Film tilted = small_film(36), shifted = small_film(24);
  tilted.tilt_rad = 0.03, tilted.swing_rad = -0.02;
  shifted.shift_x_mm = 5, shifted.shift_y_mm = -3;
  struct Case {
    std::string lens;
    Film film;
  };
  for (const auto& [id, film] :
       {Case{"double_gauss_100mm_f2_28deg", small_film(36)}, Case{"fisheye_10mm_f4", small_film(20)},
        Case{"anamorphic_60mm_2x", small_film(24)}, Case{"catadioptric_mangin_1000mm_f7.5", small_film(36)},
        Case{"double_gauss_100mm_f2_28deg", tilted}, Case{"biogon_35mm_f2.8", shifted}}) {
    for (const ModelKind model : {ModelKind::exact_double, ModelKind::exact_float}) {
      SCOPED_TRACE(id + ", " + std::string(name(model)));
      const LensDistortion distortion(Camera(data_lens(id), film, {.model = model}));
      std::vector<Vec2<double>> all = places(film, 25);
      for (const double x : {0.0, 0.0 + film.columns}) all.insert(all.end(), {{x, 0}, {x, 0.0 + film.rows}});
      for (const Vec2<double>& at : all) {
        const auto seen = distortion.undistorted(at);
        ASSERT_TRUE(seen) << at.x << ' ' << at.y;
        const auto again = distortion.distorted(*seen);
        ASSERT_TRUE(again) << at.x << ' ' << at.y;
        EXPECT_LT(far_apart(*again, at), model == ModelKind::exact_double ? 1e-6 : 5e-3);
      }
    }
  }
}

TEST(LensDistortion, ScalesWithLensAndFilm) {
  Prescription p = testing::data_prescription("biogon_35mm_f2.8");
  const Film film = small_film(36);
  const LensDistortion one(Camera(compile(p), film, {.model = ModelKind::exact_double}));
  const LensDistortion two(Camera(compile(scale(p, 2)), small_film(72), {.model = ModelKind::exact_double}));
  EXPECT_NEAR(two.pinhole().focal_length_mm.x / one.pinhole().focal_length_mm.x, 2, 1e-7);
  for (const Vec2<double>& at : places(film, 20)) {
    EXPECT_LT(far_apart(one.distorted(at).value(), two.distorted(at).value()), 1e-4);
  }
}

TEST(LensDistortion, FollowsTheAxisOfAShiftedFilm) {
  const Lens lens = data_lens("biogon_35mm_f2.8");
  const Film film = small_film(24);
  Film shifted = film;
  shifted.shift_x_mm = 5, shifted.shift_y_mm = -3;
  const LensDistortion there(Camera(lens, shifted, {.model = ModelKind::exact_double}));
  const LensDistortion here(Camera(lens, film, {.model = ModelKind::exact_double}));
  EXPECT_NEAR(there.pinhole().centre_mm.x, 5, 1e-9);
  EXPECT_NEAR(there.pinhole().centre_mm.y, 3, 1e-9);
  EXPECT_EQ(here.pinhole().centre_mm, Vec2<double>(0, 0));
  const Vec2<double> by = there.centre() - here.centre();
  for (const Vec2<double>& at : places(film, 20)) {
    EXPECT_LT(far_apart(here.distorted(at).value() + by, there.distorted(at + by).value()), 1e-3);
  }
}

TEST(LensDistortion, KeepsTheSqueezeOfAnamorphicLenses) {
  const Lens lens = data_lens("anamorphic_60mm_2x");
  const LensDistortion distortion(Camera(lens, small_film(24), {.model = ModelKind::exact_double}));
  const Vec2<double> focal_length = distortion.pinhole().focal_length_mm;
  EXPECT_NEAR(focal_length.y / focal_length.x, squeeze(lens), 0.01);  // the ratio of the focal lengths
}

TEST(LensDistortion, ReportsTheFieldOfItsFilm) {
  const Film film = small_film(24);
  const LensDistortion fisheye(Camera(data_lens("fisheye_8mm_f2.8"), film));
  EXPECT_GT(fisheye.widest_field_rad(), 1.55);
  const Film wide = small_film(36);
  const LensDistortion biogon(Camera(data_lens("biogon_35mm_f2.8"), wide, {.model = ModelKind::exact_double}));
  const auto corner = biogon.undistorted({0, 0});
  ASSERT_TRUE(corner);
  const Vec2<double> tangent = (*corner - biogon.centre()) / biogon.focal_length_px();
  EXPECT_NEAR(biogon.widest_field_rad(), std::atan(std::hypot(tangent.x, tangent.y)), 0.02);
  // For any farthest corner.
  for (const double x : {4.0, -4.0}) {
    for (const double y : {3.0, -3.0}) {
      Film shifted = small_film(20);
      shifted.shift_x_mm = x, shifted.shift_y_mm = y;
      const Camera camera(data_lens("biogon_35mm_f2.8"), shifted, {.model = ModelKind::exact_double});
      const CameraRay far = camera.sample({.film = {x < 0 ? -14.0 : 14.0, y < 0 ? y - 20 / 3.0 : y + 20 / 3.0}});
      EXPECT_NEAR(LensDistortion(camera).widest_field_rad(), std::acos(-far.ray.direction.z), 0.003) << x << ' ' << y;
    }
  }
}

TEST(LensDistortion, DarkPositionsAreNullopt) {
  const LensDistortion fisheye(Camera(data_lens("fisheye_8mm_f2.8"), small_film(36)));
  EXPECT_FALSE(fisheye.undistorted({1, 1}));
  EXPECT_TRUE(fisheye.undistorted({240, 150}));
  EXPECT_FALSE(fisheye.undistorted({-20, 160}));  // outside the film
}

TEST(LensDistortion, OverscanContainsTheFieldOfTheFilm) {
  const Film film = small_film(36);
  const LensDistortion barrel(Camera(data_lens("zoom_14-30mm_f4:wide"), film, {.model = ModelKind::exact_double}));
  const double size = overscan(barrel);
  const auto corner = barrel.undistorted({0, 0});
  ASSERT_TRUE(corner);
  EXPECT_NEAR(size, std::max(1 - 2 * corner->x / film.columns, 1 - 2 * corner->y / film.rows), 1e-9);
  EXPECT_GT(size, 1.05);
  const LensDistortion none(Camera(data_lens("zoom_14-30mm_f4:wide"), film, {.model = ModelKind::pinhole}));
  EXPECT_NEAR(overscan(none), 1, 1e-8);
}

TEST(LensDistortion, RefusesLensesWithoutAPinhole) {
  const Lens lens = data_lens("biogon_35mm_f2.8");
  const auto behind = [&] { LensDistortion(Camera(lens, small_film(36)), 5.0); };
  expect_error(behind, {lens.name(), "distortion", "subject", 5});
  Film beside = small_film(4);
  beside.shift_x_mm = 5;
  const auto without_axis = [&] { overscan(LensDistortion(Camera(lens, beside))); };
  expect_error(without_axis, {lens.name(), "axis"});
}

}  // namespace lens_distortion_test
}  // namespace petzval
