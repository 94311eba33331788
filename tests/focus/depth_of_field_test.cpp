// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/focus.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {
namespace depth_of_field_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_error;
using enum FocusCriterion;
using enum DistanceOrigin;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr auto criteria = {thin, paraxial, min_rms, min_max};

/// A 50 mm singlet without thickness at f/10.
Lens thin_singlet(double semi_diameter = 2.5) {
  Prescription p;
  p.name = "thin singlet";
  p.surfaces = {{.radius = 51.68, .medium = {.nd = 1.5168}, .semi_diameter = semi_diameter, .stop = true},
                {.radius = -51.68, .semi_diameter = 2 * semi_diameter}};
  return compile(p);
}

TEST(BlurDiameter, ThinCriterionEqualsTheFormula) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const FirstOrder data = first_order(lens);
  const double f = data.effective_focal_length, diameter = pupils(lens).entrance.diameter;
  for (const double focused : {500.0, 2000.0, infinity}) {
    const Lens set = with_focus(lens, focused, {thin});
    for (const double subject : {150.0, 300.0, 1999.0, 3e4, infinity}) {
      const double expected =
          thin_lens_blur_diameter(f, diameter, subject + data.rear_principal_z, focused + data.rear_principal_z);
      EXPECT_NEAR(blur_diameter(set, subject, {thin}).value(), expected, 1e-12 * (1 + expected))
          << focused << " " << subject;
    }
  }
}

TEST(BlurDiameter, ParaxialCriterionEqualsTheConeOfTheExitPupil) {
  for (const char* id : {"double_gauss_100mm_f2.0", "retrofocus_100mm_f2", "mirror_newton_200mm_f8", "cylinder_3.9mm",
                         "eye_gullstrand_le_grand"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const Meridian meridian = main_meridian(lens);
    const Pupil exit = pupils(lens, 0, meridian).exit;
    for (const double subject : {300.0, 5000.0, infinity}) {
      const double image_z = paraxial_image_z(lens, -subject, 0, meridian);
      for (const double shift : {-0.3, 0.0, 0.2}) {
        const double cone = std::abs(exit.diameter * shift / (image_z - exit.z));
        EXPECT_NEAR(blur_diameter(with_film(lens, image_z + shift), subject, {paraxial}).value(), cone,
                    1e-12 * (1 + exit.diameter));
      }
    }
  }
}

TEST(BlurDiameter, AllCriteriaAgreeForAThinLens) {
  const Lens lens = thin_singlet(1.25);
  const double f = first_order(lens).effective_focal_length;
  const Lens set = with_focus(lens, 1000);
  for (const double subject : {300.0, 600.0, 4000.0, infinity}) {
    const double expected = thin_lens_blur_diameter(f, 2.5, subject, 1000);
    for (const FocusCriterion criterion : criteria) {
      // Spherical aberration at f/20 is a few micrometres; eight times that at f/10.
      EXPECT_NEAR(blur_diameter(set, subject, {criterion}).value(), expected, 0.004) << name(criterion) << subject;
    }
  }
}

TEST(DepthOfField, HasTheBlurAtItsLimits) {
  for (const char* id :
       {"double_gauss_100mm_f2.0", "modern_41mm_f1.45", "telephoto_100mm_f5.6", "anamorphic_60mm_2x"}) {
    for (const FocusCriterion criterion : criteria) {
      for (const DistanceOrigin origin : {front_vertex, film, front_principal}) {
        SCOPED_TRACE(std::string(id) + ' ' + std::string(name(criterion)) + ' ' + std::string(name(origin)));
        const FocusOptions options{criterion, origin};
        const double distance = 3000, blur = 0.2;
        const Lens lens = with_focus(data_lens(id), distance, options);
        const DepthOfField depth = depth_of_field(lens, blur, options);
        ASSERT_TRUE(depth) << name(depth.status);
        EXPECT_LT(depth.near_distance, distance);
        EXPECT_GT(depth.far_distance, distance);
        EXPECT_NEAR(blur_diameter(lens, depth.near_distance, options).value(), blur, 1e-9 * blur);
        if (std::isfinite(depth.far_distance)) {
          EXPECT_NEAR(blur_diameter(lens, depth.far_distance, options).value(), blur, 1e-9 * blur);
        } else {
          EXPECT_LE(blur_diameter(lens, infinity, options).value(), blur);
        }
        const DepthOfField wider = depth_of_field(lens, 1.5 * blur, options);
        EXPECT_LT(wider.near_distance, depth.near_distance);
      }
    }
  }
}

TEST(DepthOfField, ThinLensEqualsTheTextbook) {
  // Near and far limit: U D f / (D f +- c (U - f)), distances from the lens.
  const Lens lens = thin_singlet();
  const double f = first_order(lens).effective_focal_length, diameter = 5, u = 2000, c = 0.05;
  const DepthOfField depth = depth_of_field(with_focus(lens, u, {thin}), c, {thin});
  EXPECT_NEAR(depth.near_distance, u * diameter * f / (diameter * f + c * (u - f)), 1e-5);
  EXPECT_NEAR(depth.far_distance, u * diameter * f / (diameter * f - c * (u - f)), 1e-5);
}

TEST(DepthOfField, IsEmptyIfTheFocusIsTooBlurred) {
  const Lens lens = with_focus(data_lens("singlet_50mm_biconvex"), 2000, {min_rms});
  const double sharpest = blur_diameter(lens, 2000, {min_rms}).value();
  EXPECT_EQ(depth_of_field(lens, 0.99 * sharpest, {min_rms}).status, FocusStatus::too_blurred);
  EXPECT_TRUE(depth_of_field(lens, 1.01 * sharpest, {min_rms}));
  EXPECT_TRUE(depth_of_field(with_focus(lens, 2000, {paraxial}), 1e-6, {paraxial}));
  EXPECT_EQ(hyperfocal(lens, 1e-3, {min_rms}).status, FocusStatus::too_blurred);
}

TEST(DepthOfField, FilmTooFarInIncludesInfinity) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const Lens inside = with_film(lens, first_order(lens).rear_focal_z - 0.01);
  const DepthOfField depth = depth_of_field(inside, 0.03, {paraxial});
  EXPECT_TRUE(depth);
  EXPECT_EQ(depth.far_distance, infinity);
  EXPECT_GT(depth.near_distance,
            depth_of_field(with_film(lens, first_order(lens).rear_focal_z), 0.03, {paraxial}).near_distance);
}

TEST(DepthOfField, ReachesTheLensForLargeLimits) {
  const DepthOfField depth = depth_of_field(with_focus(data_lens("double_gauss_100mm_f2.0"), 1000), 1e4, {paraxial});
  ASSERT_TRUE(depth);
  EXPECT_NEAR(depth.near_distance, 0, 1e-9);
  EXPECT_EQ(depth.far_distance, infinity);
}

TEST(Hyperfocal, IsTheNearestFocusWithInfinityAtTheLimit) {
  for (const char* id : {"double_gauss_100mm_f2.0", "telephoto_100mm_f5.6", "fisheye_8mm_f2.8"}) {
    for (const FocusCriterion criterion : criteria) {
      SCOPED_TRACE(std::string(id) + ' ' + std::string(name(criterion)));
      const FocusOptions options{criterion, front_principal};
      const double blur = 0.15;
      const Lens lens = data_lens(id);
      const FocusSolution at = hyperfocal(lens, blur, options);
      ASSERT_TRUE(at) << name(at.status);
      const Lens set = with_film(lens, at.film_z);
      EXPECT_NEAR(blur_diameter(set, infinity, options).value(), blur, 1e-9 * blur);
      EXPECT_NEAR(with_focus(lens, at.distance, options).film_z(), at.film_z, 1e-12 * at.film_z);
      EXPECT_EQ(depth_of_field(set, blur, options).far_distance, infinity);

      const auto far = [&](double distance) {
        return depth_of_field(with_focus(lens, distance, options), blur, options).far_distance;
      };
      EXPECT_EQ(far(at.distance * 1.001), infinity);
      EXPECT_LT(far(at.distance * 0.999), infinity);

      // The near limit is about half the hyperfocal distance: closer if the pupil is near the principal plane and the
      // aberrations are small compared with the blur.
      const double near = depth_of_field(set, blur * (1 + 1e-9), options).near_distance;
      EXPECT_NEAR(near / at.distance, 0.5, 0.12);
    }
  }
}

TEST(Hyperfocal, RunsToInfinityAsTheBlurGoesToZero) {
  for (const FocusCriterion criterion : {thin, paraxial}) {
    const Lens lens = data_lens("double_gauss_52mm_f1.8");
    double before = 0;
    for (const double blur : {1e-2, 1e-6, 1e-10, 1e-16, 1e-100, 5e-324}) {
      const FocusSolution at = hyperfocal(lens, blur, {criterion});
      ASSERT_EQ(at.status, FocusStatus::solved) << blur;
      EXPECT_TRUE(at.distance > before || (blur < 1e-12 && at.distance > 1e12)) << blur << " " << at.distance;
      before = at.distance;
    }
  }
}

TEST(Hyperfocal, ThinLensEqualsTheTextbook) {
  const Lens lens = thin_singlet();
  const double f = first_order(lens).effective_focal_length, diameter = 5, c = 0.03;
  const FocusSolution at = hyperfocal(lens, c, {thin});
  EXPECT_NEAR(at.distance, f + diameter * f / c, 1e-5);
  const Lens set = with_film(lens, at.film_z);
  EXPECT_NEAR(depth_of_field(set, c * (1 + 1e-12), {thin}).near_distance, at.distance / 2, 1e-5);
}

TEST(DepthOfField, ScalesWithTheLens) {
  const Prescription p = data_prescription("double_gauss_100mm_f2.0");
  const Lens lens = compile(p), twice = compile(scale(p, 2));
  for (const FocusCriterion criterion : criteria) {
    const auto depth = depth_of_field(with_focus(lens, 1500, {criterion}), 0.1, {criterion});
    const auto doubled = depth_of_field(with_focus(twice, 3000, {criterion}), 0.2, {criterion});
    EXPECT_NEAR(doubled.near_distance, 2 * depth.near_distance, 1e-8 * depth.near_distance);
    EXPECT_NEAR(doubled.far_distance, 2 * depth.far_distance, 1e-8 * depth.far_distance);
    EXPECT_NEAR(hyperfocal(twice, 0.2, {criterion}).distance, 2 * hyperfocal(lens, 0.1, {criterion}).distance, 1e-4);
  }
}

TEST(Breathing, FollowsTheChiefRayThroughTheExitPupil) {
  for (const char* id : {"double_gauss_100mm_f2.0", "retrofocus_100mm_f2", "telephoto_100mm_f5.6"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const double infinite = first_order(lens).rear_focal_z, exit_z = pupils(lens).exit.z;
    EXPECT_EQ(breathing(lens, infinite, {paraxial}).value(), 0);
    const double near = solve_focus(lens, 1000).film_z;
    EXPECT_NEAR(breathing(lens, near, {paraxial}).value(), (near - exit_z) / (infinite - exit_z) - 1, 1e-13);
    // The image grows as the film moves away from the exit pupil.
    EXPECT_GT(breathing(lens, near, {paraxial}).value() * (infinite - exit_z), 0);
    EXPECT_GT(std::abs(breathing(lens, solve_focus(lens, 700, {paraxial}).film_z, {paraxial}).value()),
              std::abs(breathing(lens, near, {paraxial}).value()));
  }
}

TEST(Breathing, IsZeroForTelecentricLenses) {
  Prescription p = data_prescription("singlet_50mm_biconvex");
  const Lens bare = compile(p);
  // The stop in the front focal plane.
  for (SurfaceRow& row : p.surfaces) row.stop = false;
  p.surfaces.insert(
      p.surfaces.begin(),
      SurfaceRow{.radius = 0, .thickness = -first_order(bare).front_focal_z, .semi_diameter = 3, .stop = true});
  const Lens lens = compile(p);
  EXPECT_EQ(breathing(lens, solve_focus(lens, 300).film_z), 0);
}

TEST(DepthOfField, ReportsMissingInput) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  for (const double blur : {0.0, -1.0, std::nan(""), infinity}) {
    expect_error([&] { depth_of_field(lens, blur); }, {lens.name(), "blur", blur});
    expect_error([&] { hyperfocal(lens, blur); }, {lens.name(), "blur", blur});
  }
  expect_error([&] { blur_diameter(lens, 0); }, {lens.name(), "subject", 0});
  expect_error([&] { blur_diameter(lens, 10, {paraxial, film}); }, {lens.name(), "subject"});
  expect_error([&] { breathing(lens, std::nan("")); }, {lens.name(), "film_z", "nan"});

  const Lens closed = with_semi_diameter(lens, pupils(lens).stop, 0);
  EXPECT_EQ(depth_of_field(closed, 0.03, {min_rms}).status, FocusStatus::no_rays);
  EXPECT_EQ(hyperfocal(closed, 0.03, {min_max}).status, FocusStatus::no_rays);
  EXPECT_EQ(blur_diameter(closed, 1000, {min_rms}), std::nullopt);
  // A pinhole to first order has no blur.
  EXPECT_EQ(blur_diameter(closed, 1000, {paraxial}), 0);
  EXPECT_EQ(depth_of_field(closed, 0.03, {paraxial}).far_distance, infinity);
  EXPECT_EQ(hyperfocal(closed, 0.03, {paraxial}).distance, nearest_focus(lens, {paraxial}).distance);

  Prescription window = data_prescription("singlet_50mm_biconvex");
  for (SurfaceRow& row : window.surfaces) row.radius = 0;
  const Lens afocal = compile(window);
  EXPECT_EQ(depth_of_field(afocal, 0.03).status, FocusStatus::afocal);
  EXPECT_EQ(hyperfocal(afocal, 0.03).status, FocusStatus::afocal);
  EXPECT_EQ(blur_diameter(afocal, 1000), std::nullopt);
  EXPECT_EQ(breathing(afocal, 100), std::nullopt);
  EXPECT_EQ(solve_subject(afocal, 100).status, FocusStatus::afocal);
}

TEST(Breathing, IsNulloptWithoutRaysFromInfinity) {
  const Lens open = data_lens("double_gauss_100mm_f2.0");
  const Lens closed = with_semi_diameter(open, *open.stop(), 0);
  for (const FocusCriterion criterion : {min_rms, min_max}) {
    EXPECT_EQ(solve_focus(closed, infinity, {criterion}).status, FocusStatus::no_rays);
    EXPECT_EQ(breathing(closed, closed.film_z(), {criterion}), std::nullopt);
    EXPECT_NE(breathing(open, closed.film_z(), {criterion}), std::nullopt);
  }
}

// A mirror of 3 um radius; images of near subjects end before the film.
TEST(SolveSubject, ReportsWhereImagesEnd) {
  Prescription p;
  p.name = "images that end";
  p.surfaces = {{.radius = -2.338e7, .thickness = 3.8507},
                {.thickness = -1.52739, .conic = -7.65522, .aspheric = {{3, -5.3819e-06}, {4, -0.000540155}}},
                {.radius = 2.03036e9, .thickness = 0.221654, .semi_diameter = 19.3602},
                {.radius = -0.00291459,
                 .thickness = 144.906,
                 .conic = -11.9661,
                 .aspheric = {{4, 4.60954e-06}, {7, 8.76873e-10}},
                 .mirror = true}};
  const Lens lens = compile(p);
  for (const FocusCriterion criterion : {min_rms, min_max}) {
    const FocusSolution found = solve_subject(lens, lens.film_z(), {criterion});
    EXPECT_EQ(found.status, FocusStatus::unreachable);
    EXPECT_FALSE(std::isnan(found.subject_z) || std::isnan(found.distance));
    depth_of_field(lens, 0.03, {criterion});
  }
}

}  // namespace depth_of_field_test
}  // namespace petzval
