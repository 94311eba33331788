// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/autofocus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../film_at.hpp"
#include "focus/image_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace autofocus_test {

using testing::data_lens;
using testing::expect_error;
using testing::film_at;
using enum FocusStatus;
using enum FocusCriterion;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

FocusTarget at(double x, double y, double z, double blur_mm = 0, double weight = 1) {
  return {{{x, y, z}, false}, blur_mm, weight};
}

TEST(Autofocus, ThinLensFollowsItsFormula) {
  const IdealLens lens = thin_lens(50, 2);
  EXPECT_NEAR(autofocus(lens, std::vector{at(0, 0, -2000)}, film_at(60)).film.z(), 51.282051282051282, 1e-12 * 51);
  EXPECT_NEAR(autofocus(lens, std::vector{at(0, 0, -500)}, film_at(60)).film.z(), 55.555555555555556, 1e-12 * 55);
  // Ill-conditioned: rounding of 50.0001 is 7e-15, relative to the 1e-4 that matter.
  EXPECT_NEAR(autofocus(lens, std::vector{at(0, 0, -50.0001)}, film_at(60)).film.z(), 25000050, 25000050 * 1e-10);
  for (const double z : {-50.0, -49.0, 0.0, 10.0}) {
    const Autofocus none = autofocus(lens, std::vector{at(0, 0, z)}, film_at(60));
    EXPECT_EQ(none.status, no_targets) << z;
    EXPECT_EQ(none.film.z(), 60);
    EXPECT_EQ(none.blurs[0].status, TargetStatus::no_image);
    EXPECT_TRUE(std::isnan(none.blurs[0].blur_mm));
  }
}

TEST(Autofocus, OneAxialTargetEqualsSolveFocus) {
  for (const char* id : {"double_gauss_100mm_f2.0", "telephoto_100mm_f5.6", "retrofocus_100mm_f2.8", "fisheye_8mm_f2.8",
                         "zoom_57-143mm_f2.8:tele", "anamorphic_60mm_2x"}) {
    const Lens lens = data_lens(id);
    const std::size_t wavelength = lens.primary_wavelength();
    for (const double distance : {2000.0, 1e5, 1e12, infinity}) {
      SCOPED_TRACE(std::string(id) + " at " + std::to_string(distance));
      for (const auto criterion : {thin, paraxial}) {
        const IdealLens ideal = criterion == thin ? thin_lens(lens, wavelength) : thick_lens(lens, wavelength);
        const Autofocus focus = autofocus(ideal, std::vector{at(0, 0, -distance)}, film_at(lens.film_z()));
        EXPECT_TRUE(focus);
        const double expected = solve_focus(lens, distance, {.criterion = criterion}).film_z;
        EXPECT_NEAR(focus.film.z(), expected, 1e-12 * std::abs(expected));
        EXPECT_NEAR(focus.rms_mm, 0, 1e-12);
      }
    }
  }
}

TEST(Autofocus, ExactRaysEqualSolveFocusWithinTheirNoise) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  struct Case {
    std::size_t rays;
    double rms_mm, max_mm;
  };
  for (const auto& [rays, rms_mm, max_mm] : {Case{256, 0.016, 0.08}, Case{1024, 0.007, 0.06}}) {
    const ImageRays bundles(lens, 22, rays);
    for (const double degrees : {0.0, 3.0, 6.0, 9.5, 10.0, 10.5, 11.0}) {
      const double field = degrees * std::numbers::pi / 180;
      for (const double distance : {1500.0, 1e4, 1e9}) {
        const double y = (pupils(lens).entrance.z + distance) * std::tan(field);
        for (const auto& [criterion, tolerance] : {std::pair(min_rms, rms_mm), std::pair(min_max, max_mm)}) {
          const FocusOptions options{.criterion = criterion, .fields = {{field, 1}}};
          const double expected = solve_focus(lens, distance == 1e9 ? infinity : distance, options).film_z;
          const Autofocus focus = autofocus(bundles, std::vector{at(0, y, -distance)}, {}, criterion);
          EXPECT_TRUE(focus);
          EXPECT_NEAR(focus.film.z(), expected, tolerance) << rays << " " << degrees << " " << distance;
        }
      }
    }
  }
}

/// The weighted sum of squared blur errors of targets.
double squares(const Autofocus& focus, const std::vector<FocusTarget>& targets) {
  double sum = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    sum += targets[i].weight * std::pow(focus.blurs[i].blur_mm - targets[i].blur_mm, 2);
  }
  return sum;
}

TEST(Autofocus, IsALocalMinimum) {
  const std::vector targets{at(0, 0, -1000, 0, 2), at(150, 60, -1300, 0, 1), at(-100, 20, -2500, 0.05, 0.5),
                            at(40, -90, -800, -0.1, 1)};
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const IdealLens ideal = thick_lens(lens);
  const Autofocus focus = autofocus(ideal, targets, film_at(lens.film_z()));
  ASSERT_TRUE(focus);
  EXPECT_NEAR(squares(focus, targets), 4.5 * focus.rms_mm * focus.rms_mm, 1e-12);
  for (const double step : {-1e-3, 1e-3}) {
    double sum = 0;
    for (const FocusTarget& t : targets) {
      const double blur = signed_blur(*ideal.image(t.point), film_at(focus.film.z() + step));
      sum += t.weight * std::pow(blur - t.blur_mm, 2);
    }
    EXPECT_GT(sum, squares(focus, targets));
  }
}

TEST(Autofocus, ExactRaysGiveALocalMinimum) {
  const std::vector targets{at(0, 0, -1000, 0, 2), at(150, 60, -1300, 0, 1), at(-100, 20, -1100, 0, 0.5)};
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  const auto blur = [&](std::size_t i, double film_z) {
    return *blur_on(bundles.bundle(targets[i].point), film_at(film_z));
  };
  const double by_rms = autofocus(bundles, targets, {}, min_rms).film.z();
  const double by_max = autofocus(bundles, targets, {}, min_max).film.z();
  EXPECT_GT(std::abs(by_rms - by_max), 0.01);
  const auto sum = [&](double z) {
    double result = 0;
    for (std::size_t i = 0; i < 3; ++i) result += targets[i].weight * std::pow(blur(i, z).rms_radius, 2);
    return result;
  };
  const auto largest = [&](double z) {
    double result = 0;
    for (std::size_t i = 0; i < 3; ++i) result = std::max(result, targets[i].weight / 2 * blur(i, z).largest_radius);
    return result;
  };
  for (const double step : {-1e-4, 1e-4}) {
    EXPECT_GT(sum(by_rms + step), sum(by_rms));
    EXPECT_GT(largest(by_max + step), largest(by_max));
  }
}

TEST(Autofocus, BlursOneTargetAsRequested) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const IdealLens ideal = thick_lens(lens);
  const ImageRays bundles(lens, 22);
  for (const double wanted : {-0.5, -0.2, 0.2, 2.0}) {
    const std::vector target{at(50, -100, -1500, wanted)};
    EXPECT_NEAR(autofocus(ideal, target, film_at(lens.film_z())).blurs[0].blur_mm, wanted, 1e-12);
    EXPECT_NEAR(autofocus(bundles, target, {}, min_rms).blurs[0].blur_mm, wanted, 1e-12);
    EXPECT_NEAR(autofocus(bundles, target, {}, min_max).blurs[0].blur_mm, wanted, 1e-12);
  }
  // Below the smallest possible blur the film is as sharp as possible.
  for (const auto criterion : {min_rms, min_max}) {
    EXPECT_EQ(autofocus(bundles, std::vector{at(50, -100, -1500, 1e-4)}, {}, criterion).film.z(),
              autofocus(bundles, std::vector{at(50, -100, -1500)}, {}, criterion).film.z());
  }
}

TEST(Autofocus, IndependentOfOrderAndDuplicatesAreWeights) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  const FocusTarget a = at(0, 0, -1000), b = at(100, 50, -1500, 0.02, 3), c = at(-50, 0, -4000, 0, 0.2);
  FocusTarget b1 = b, none = at(0, 0, -300);
  b1.weight = 1, none.weight = 0;
  const std::vector<std::vector<FocusTarget>> alike{{a, b, c}, {c, a, b}, {b1, a, b1, c, b1}, {none, a, b, c}};
  std::vector<double> films[3];
  for (const auto& targets : alike) {
    films[0].push_back(autofocus(bundles.ideal(), targets, film_at(100)).film.z());
    films[1].push_back(autofocus(bundles, targets, {}, min_rms).film.z());
  }
  films[2] = {autofocus(bundles, alike[0], {}, min_max).film.z(), autofocus(bundles, alike[1], {}, min_max).film.z(),
              autofocus(bundles, alike[3], {}, min_max).film.z()};
  for (const auto& of_one : films) {
    for (const double film_z : of_one) EXPECT_NEAR(film_z, of_one[0], 1e-12 * film_z);
  }
  EXPECT_EQ(autofocus(bundles, alike[3]).blurs[0].status, TargetStatus::no_weight);
  EXPECT_LT(autofocus(bundles, alike[3]).blurs[0].blur_mm, -1);
}

TEST(Autofocus, ReachesInfinity) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  const std::vector<FocusTarget> far{{{{0, 0, -1}, true}, 0, 1}};
  EXPECT_NEAR(autofocus(bundles.ideal(), far, film_at(100)).film.z(), bundles.ideal().rear_focal_z, 1e-12 * 100);
  EXPECT_NEAR(autofocus(bundles, far).film.z(), solve_focus(lens, infinity, {.criterion = min_rms}).film_z, 0.005);
  for (const FocusCriterion criterion : {min_rms, FocusCriterion::min_max}) {
    EXPECT_EQ(autofocus(bundles, far, {}, criterion).breathing, 0);
  }
}

TEST(Autofocus, ReportsBreathingAndTheChangeOfMagnification) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const double before = lens.film_z(), exit_z = pupils(lens).exit.z;
  const Autofocus focus = autofocus(ImageRays(lens, 22), std::vector{at(0, 0, -1000)}, {}, min_rms);
  EXPECT_GT(focus.breathing, 0.05);
  // Infinity focus of bundles is within 4 um of the solver.
  EXPECT_NEAR(focus.breathing, *breathing(lens, focus.film.z(), {.criterion = min_rms}), 1e-4);
  EXPECT_NEAR(1 + focus.magnification_change, (focus.film.z() - exit_z) / (before - exit_z), 1e-12);
  const Autofocus ideal = autofocus(thick_lens(lens), std::vector{at(0, 0, -1000)}, focus.film);
  EXPECT_NEAR(ideal.breathing, *breathing(lens, ideal.film.z(), {.criterion = FocusCriterion::paraxial}), 1e-12);
  EXPECT_NEAR(1 + ideal.magnification_change, (ideal.film.z() - exit_z) / (focus.film.z() - exit_z), 1e-12);
  // A film in the exit pupil has no magnification.
  EXPECT_TRUE(std::isnan(autofocus(thin_lens(50, 2), std::vector{at(0, 0, -1000)}, film_at(0)).magnification_change));
  // With the stop in the front focal plane the exit pupil is at infinity.
  IdealLens telecentric = thin_lens(50, 2);
  telecentric.pupils.entrance = {telecentric.front_focal_z, 10};
  telecentric.pupils.exit = {infinity, infinity};
  EXPECT_EQ(autofocus(telecentric, std::vector{at(0, 0, -1000)}, film_at(60)).breathing, 0);
  EXPECT_EQ(autofocus(telecentric, std::vector{at(0, 0, -1000)}, film_at(60)).magnification_change, 0);
}

TEST(Autofocus, KeepsTheFilmWithoutReachableTargets) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const ImageRays bundles(lens, 22);
  const std::vector useless{at(0, 0, 100),
                            at(nan, 0, -1000),
                            at(0, 0, -1000, nan),
                            at(0, 0, -1000, 0, -1),
                            at(0, 0, -1000, 0, infinity),
                            at(0, 0, -1000, 0, 0),
                            at(0, 0, -10),
                            {.point = {{0, 0, -1000}}, .extent_stops = 2, .fixes_distance = false}};
  const std::vector expected{TargetStatus::no_image,   TargetStatus::not_finite, TargetStatus::not_finite,
                             TargetStatus::not_finite, TargetStatus::not_finite, TargetStatus::no_weight,
                             TargetStatus::no_image,   TargetStatus::no_weight};
  for (const Autofocus& focus : {autofocus(bundles.ideal(), useless, film_at(lens.film_z())),
                                 autofocus(bundles, useless, {}, min_rms), autofocus(bundles, useless, {}, min_max)}) {
    EXPECT_EQ(focus.status, no_targets);
    EXPECT_EQ(focus.film.z(), lens.film_z());
    EXPECT_EQ(focus.rms_mm, 0);
    EXPECT_EQ(focus.magnification_change, 0);
    for (std::size_t i = 0; i < useless.size(); ++i) {
      EXPECT_EQ(focus.blurs[i].status, expected[i]) << i;
      EXPECT_EQ(std::isnan(focus.blurs[i].blur_mm), expected[i] != TargetStatus::no_weight) << i;
    }
  }
  EXPECT_EQ(autofocus(bundles, {}).status, no_targets);
  const std::vector beside{at(900, 0, -1000)};
  EXPECT_EQ(autofocus(bundles, beside).blurs[0].status, TargetStatus::no_rays);
  EXPECT_EQ(autofocus(bundles.ideal(), beside, film_at(lens.film_z())).blurs[0].status, TargetStatus::used);

  // For this blur in front of the plane of focus the film would lie inside the lens.
  const std::vector blurred{at(0, 0, -1000, -70)};
  for (const Autofocus& focus : {autofocus(bundles.ideal(), blurred, film_at(lens.film_z())),
                                 autofocus(bundles, blurred, {}, min_rms), autofocus(bundles, blurred, {}, min_max)}) {
    EXPECT_EQ(focus.status, unreachable);
    EXPECT_EQ(focus.film.z(), lens.film_z());
    EXPECT_TRUE(std::isfinite(focus.blurs[0].blur_mm));
    EXPECT_NEAR(focus.rms_mm, 65, 5);
  }
}

TEST(Autofocus, RefusesInvalidInput) {
  const ImageRays bundles(data_lens("double_gauss_100mm_f2.0"), 22);
  expect_error([&] { autofocus(bundles.ideal(), {}, film_at(nan)); }, {"autofocus", "film", "nan"});
  expect_error([&] { autofocus(bundles, {}, {}, paraxial); }, {"autofocus", "criterion", "paraxial"});
  expect_error([] { region_targets({}, {}, {}, 0, 2); }, {"region_targets", 0, 2});
  expect_error([] { region_targets({}, {}, {}, 2000000000, 2000000000); }, {"region_targets", 2000000000, 2000000000});
  EXPECT_EQ(region_targets({}, {}, {}, 1024, 1024).size(), 1048576u);
  expect_error([] { region_targets({}, {}, {}, 1024, 1025); }, {"region_targets", 1024, 1025});
}

TEST(RegionTargets, AreTheCentresOfItsParts) {
  const auto targets = region_targets({0, 0, -1000}, {30, 0, 0}, {0, 20, 5}, 4, 2);
  ASSERT_EQ(targets.size(), 8u);
  EXPECT_EQ(targets[0].point.position, (Vec3<double>{-22.5, -10, -1002.5}));
  EXPECT_EQ(targets[1].point.position, (Vec3<double>{-7.5, -10, -1002.5}));
  EXPECT_EQ(targets[7].point.position, (Vec3<double>{22.5, 10, -997.5}));
  EXPECT_EQ(region_targets({1, 2, -3}, {9, 9, 9}, {9, 9, 9}, 1, 1)[0].point.position, (Vec3<double>{1, 2, -3}));
}

}  // namespace autofocus_test
}  // namespace petzval
