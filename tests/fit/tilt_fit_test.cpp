// SPDX-License-Identifier: Apache-2.0
#include "petzval/fit/tilt_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../film_at.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "tilt_scene.hpp"

namespace petzval {
namespace tilt_fit_test {

using testing::film_at;

using namespace testing;
using Status = FocusStatus;
using Targets = std::vector<FocusTarget>;
using Vec = Vec3<double>;
constexpr double F = 50;

void expect_same_film(const Film& found, const Film& wanted, double tolerance, double unit = F) {
  EXPECT_NEAR(found.z() / unit, wanted.z() / unit, tolerance);
  EXPECT_NEAR(found.tilt_rad, wanted.tilt_rad, tolerance);
  EXPECT_NEAR(found.swing_rad, wanted.swing_rad, tolerance);
}

TEST(TiltFit, ExactPointsGiveTheirPlane) {
  // Tilts up to the limit; the tangent of the film's tilt is |(a, b)| F / (1 - c F).
  for (const double tilt_deg : {0.0, 0.1, 2.0, 10.0, 19.999}) {
    for (const double towards : {0.0, 1.0, 2.5, 4.0}) {
      const double c = 1 / 2000.0, slope = std::tan(radians(tilt_deg)) * (1 / F - c);
      const Scene scene{slope * std::cos(towards), slope * std::sin(towards), c, normal_lens()};
      const TiltFit fit = fit_tilt(scene.lens, scene.targets(24, 0.05, 0.05), behind(scene.lens));
      ASSERT_EQ(fit.status, Status::solved) << tilt_deg << " " << towards;
      EXPECT_NEAR(fit.film.angle(), radians(tilt_deg), 1e-12);
      EXPECT_LT(angle(fit.focus->plane.normal, scene.plane().normal), 1e-9);
      EXPECT_NEAR(fit.focus->plane.offset / scene.plane().offset, 1, 1e-9);
      EXPECT_LT(fit.rms_mm, 1e-12);
    }
  }
}

TEST(TiltFit, ExactPointsGiveTheirPlaneForEveryThickLens) {
  int lenses = 0;
  for (const Prescription& prescription : data_prescriptions()) {
    IdealLens lens;
    try {
      lens = thick_lens(compile(prescription));
    } catch (const Error&) {
      continue;  // afocal, or towards -z
    }
    if (!(lens.rear_focal_length > 0)) continue;
    ++lenses;
    const double f = lens.front_focal_length, c = 0.02 / f, slope = std::tan(radians(5)) * (1 / f - c);
    const Scene scene{0.6 * slope, -0.8 * slope, c, lens};
    const Targets targets = scene.targets(12, 0.1, 0.1);
    TiltOptions options = behind(lens);
    options.film = {.width_mm = 0.1 * f, .height_mm = 0.1 * f};
    const TiltFit fit = fit_tilt(lens, targets, options);
    if (fit.status == Status::unreachable) {  // the tilted film would touch the lens
      EXPECT_LT(lens.rear_focal_z - lens.rear_z, 0.02 * f) << prescription.name;
      continue;
    }
    EXPECT_EQ(fit.status, Status::solved) << prescription.name;
    EXPECT_LT(angle(fit.focus->plane.normal, scene.plane().normal), 1e-9) << prescription.name;
    EXPECT_LT(fit.rms_mm, 1e-11 * f) << prescription.name;
  }
  EXPECT_GT(lenses, 60);
}

/// The points of a scene plane normal . p = offset on the lines of sight from z through positions of the picture.
Targets points_of(const Plane& plane, double z) {
  Targets targets;
  for (const auto& [x, y] : {std::pair{-0.2, 0.05}, {0.15, 0.1}, {0.02, -0.12}, {0.2, -0.1}}) {
    const Vec along(x, y, -1), from(0, 0, z);
    const double steps = (plane.offset - glm::dot(plane.normal, from)) / glm::dot(plane.normal, along);
    targets.push_back({.point = {from + steps * along}});
  }
  return targets;
}

TEST(TiltFit, GivesKnownTilts) {
  // Computed with 40 digits, for F = 0.05 and 2 m.
  const Vec normal(0, 0.5, -std::sqrt(0.75));
  const IdealLens thin = thin_lens(0.05, 2);
  TiltOptions options = behind(thin);
  options.film = {.width_mm = 0.036, .height_mm = 0.024};
  const TiltFit tilted = fit_tilt(thin, points_of({normal, std::sqrt(3)}, 0), options);
  ASSERT_EQ(tilted.status, Status::solved);
  EXPECT_NEAR(tilted.film.z(), 0.051282051282051282, 1e-9 * 0.05);
  EXPECT_NEAR(degrees(tilted.film.angle()), 0.848136346759917, 1e-9);
  EXPECT_NEAR(tilted.focus->hinge->point.y, 3.3774990747593107, 4e-9);
  EXPECT_NEAR(tilted.focus->scheimpflug->point.y, 3.4641016151377546, 4e-9);
  EXPECT_LT(angle(tilted.focus->plane.normal, normal), 1e-9);

  const Targets low{target(-0.2, -1.5, -3), target(0.4, -1.5, -4), target(0.1, -1.5, -9)};
  const TiltFit ground = fit_tilt(thin, low, options);
  EXPECT_NEAR(ground.film.z(), 0.05, 1e-9 * 0.05);
  EXPECT_NEAR(degrees(ground.film.angle()), 1.9091524329963762, 1e-9);

  // Thick: R = +-100 mm, 20 mm thick; numbers from the middle of the lens.
  Prescription p;
  p.name = "biconvex";
  p.surfaces = {{.radius = 100, .thickness = 20, .medium = {.nd = 1.5168}, .semi_diameter = 5, .stop = true},
                {.radius = -100, .thickness = 100}};
  const IdealLens thick = thick_lens(compile(p));
  const Plane scene{normal, 1990 * std::sqrt(0.75)};
  const TiltFit through = fit_tilt(thick, points_of(scene, thick.front_principal_z()), behind(thick));
  ASSERT_EQ(through.status, Status::solved);
  EXPECT_NEAR(through.film.z() - 10, 108.62604046571582, 1e-9 * 100);
  EXPECT_NEAR(degrees(through.film.angle()), 1.7463843377726925, 1e-9);
}

TEST(TiltFit, GivesThePlaneOfThreePoints) {
  // Inverse distance -.5 x + y + .4.
  const IdealLens lens = thin_lens(0.05, 2);
  TiltOptions options = behind(lens);
  options.film = {.width_mm = 0.036, .height_mm = 0.024};
  const Targets targets{target(-0.4, 0, -2), target(0.2 / 0.3, 0, -1 / 0.3), target(0, 0.2, -2)};
  const TiltFit fit = fit_tilt(lens, targets, options);
  ASSERT_EQ(fit.status, Status::solved);
  EXPECT_EQ(fit.rank, PlaneRank::plane);
  EXPECT_LT(angle(fit.focus->plane.normal, Vec(-0.5, 1, -0.4) / std::sqrt(1.41)), 1e-9);
  EXPECT_NEAR(std::abs(fit.focus->plane.offset), 1 / std::sqrt(1.41), 1e-9);
}

TEST(TiltFit, MeetsTheBlursOfThreeTargets) {
  const IdealLens lens = thin_lens(50, 2);
  const std::vector<FocusTarget> targets{
      {.point = {{-300, -200, -1500}}}, {.point = {{400, -100, -2500}}}, {.point = {{0, 300, -4000}}, .blur_mm = 0.05}};
  TiltOptions options;
  options.film.z_mm = lens.rear_focal_z;
  const TiltFit fit = fit_tilt(lens, targets, options);
  ASSERT_EQ(fit.status, Status::solved);
  for (const TargetBlur& blur : fit.blurs) EXPECT_NEAR(blur.blur_mm, blur.target_mm, 1e-12);
  EXPECT_GT(fit.film.angle(), radians(1));
}

TEST(TiltFit, MinimisesTheSumOfSquares) {
  // No adjacent film, moved or tilted, has a lower cost for inexact targets with blurs.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const IdealLens lens = thick_lens(data_lens("double_gauss_100mm_f2.0"));
  for (int draw = 0; draw < 20; ++draw) {
    Targets targets;
    for (int i = 0; i < 7; ++i) {
      const double depth = 2000 + 1000 * unit(random);
      targets.push_back(target(0.2 * unit(random) * depth, 0.2 * unit(random) * depth, -depth, 1.5 + unit(random),
                               0.1 * unit(random)));
    }
    const TiltFit fit = fit_tilt(lens, targets, behind(lens, 60));
    ASSERT_TRUE(fit) << draw;
    const auto cost = [&](const Film& film) {
      double sum = 0, weights = 0;
      for (const FocusTarget& t : targets) {
        const double error = signed_blur(*lens.image(t.point), film) - t.blur_mm;
        sum += t.weight * error * error;
        weights += t.weight;
      }
      return std::sqrt(sum / weights);
    };
    EXPECT_NEAR(fit.rms_mm, cost(fit.film), 1e-12);
    for (const double step : {-1e-3, 1e-3}) {
      EXPECT_GT(cost(film_at(fit.film.z() + 10 * step, fit.film.tilt_rad, fit.film.swing_rad)), fit.rms_mm);
      EXPECT_GT(cost(film_at(fit.film.z(), fit.film.tilt_rad + step, fit.film.swing_rad)), fit.rms_mm);
      EXPECT_GT(cost(film_at(fit.film.z(), fit.film.tilt_rad, fit.film.swing_rad + step)), fit.rms_mm);
    }
    EXPECT_LT(off_least([&](const Film& film) { return cost(film) * cost(film); }, fit.film, F), 1e-7);
  }
}

TEST(TiltFit, IndependentOfTheUnitOfLength) {
  for (const bool robust : {false, true}) {
    TiltOptions options = behind(normal_lens(), 40);
    options.robust = robust;
    const Targets targets = inexact_targets(24, 5);
    const TiltFit base = fit_tilt(normal_lens(), targets, options);
    ASSERT_EQ(base.status, Status::solved);
    const double tolerance = robust ? 1e-9 : 1e-12;
    for (const double unit : {1e-6, 1e-3, 1e3, 1e6}) {
      Targets scaled = targets;
      for (FocusTarget& t : scaled) t.point.position *= unit, t.blur_mm *= unit;
      TiltOptions scaled_options = options;
      scaled_options.film = {.width_mm = 36 * unit, .height_mm = 24 * unit, .z_mm = unit * options.film.z()};
      const TiltFit fit = fit_tilt(thin_lens(F * unit, 2), scaled, scaled_options);
      ASSERT_EQ(fit.status, Status::solved);
      EXPECT_NEAR(fit.film.z() / unit / base.film.z(), 1, tolerance) << unit;
      EXPECT_NEAR(fit.film.tilt_rad, base.film.tilt_rad, tolerance) << unit;
      EXPECT_NEAR(fit.film.swing_rad, base.film.swing_rad, tolerance) << unit;
      EXPECT_NEAR(fit.rms_mm / unit / base.rms_mm, 1, tolerance) << unit;
      EXPECT_NEAR(fit.film.shift_x_mm / unit, base.film.shift_x_mm, tolerance * F);
    }
  }
}

TEST(TiltFit, IndependentOfOrderAndScaleOfWeights) {
  Targets targets = inexact_targets(9, 6);
  const TiltOptions options = behind(normal_lens(), 40);
  const Film base = fit_tilt(normal_lens(), targets, options).film;
  std::mt19937 random(7);
  for (int i = 0; i < 10; ++i) {
    std::shuffle(targets.begin(), targets.end(), random);
    expect_same_film(fit_tilt(normal_lens(), targets, options).film, base, 1e-9);
  }
  for (const double scale : {1e-300, 1e-3, 1e6, 1e300}) {
    Targets scaled = targets;
    for (FocusTarget& t : scaled) t.weight *= scale;
    expect_same_film(fit_tilt(normal_lens(), scaled, options).film, base, 1e-9);
  }
  Targets twice = targets, doubled = targets;
  for (std::size_t i = 0; i < 4; ++i) {
    twice.push_back(targets[i]);
    doubled[i].weight *= 2;
  }
  expect_same_film(fit_tilt(normal_lens(), twice, options).film, fit_tilt(normal_lens(), doubled, options).film, 1e-9);
}

TEST(TiltFit, MirroredTargetsGiveTheMirroredFilm) {
  for (const bool robust : {false, true}) {
    for (const double limit : {5.0, 40.0}) {
      TiltOptions options = behind(normal_lens(), limit);
      options.robust = robust;
      const Targets targets = inexact_targets(24, 8);
      Targets x = targets, y = targets;
      for (FocusTarget& t : x) t.point.position.x *= -1;
      for (FocusTarget& t : y) t.point.position.y *= -1;
      const Film base = fit_tilt(normal_lens(), targets, options).film;
      expect_same_film(fit_tilt(normal_lens(), x, options).film, film_at(base.z(), base.tilt_rad, -base.swing_rad),
                       1e-9);
      // Tilt first: the mirror image of (p, q) is (p, -q), and tan(tilt) = q cos(swing).
      expect_same_film(fit_tilt(normal_lens(), y, options).film, film_at(base.z(), -base.tilt_rad, base.swing_rad),
                       1e-9);
    }
  }
}

}  // namespace tilt_fit_test
}  // namespace petzval
