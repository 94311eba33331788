// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "tilt_scene.hpp"

namespace petzval {
namespace tilt_fit_robust_test {

using namespace testing;
using Status = FocusStatus;
using Targets = std::vector<FocusTarget>;
using Vec = Vec3<double>;

TiltOptions robust(const IdealLens& lens) {
  TiltOptions options = behind(lens);
  options.robust = true;
  return options;
}

TEST(RobustTiltFit, FindsThePlaneAmongGrossOutliers) {
  // The plane of the scene is found within 1 degree in 200 of 200 draws: 24 points over the frame at 1 to 4 m with a
  // noise of 3 mm; 3 or 8 points are outliers.
  for (const bool thick : {false, true}) {
    const IdealLens lens = thick ? thick_lens(data_lens("double_gauss_52mm_f1.8")) : normal_lens();
    const double half_x = 18 / lens.rear_focal_length, half_y = 12 / lens.rear_focal_length;
    for (const int outliers : {0, 3, 8}) {
      double worst = 0;
      int missed = 0;
      for (unsigned seed = 0; seed < 200; ++seed) {
        std::mt19937_64 random(1000 * static_cast<unsigned>(outliers) + seed);
        std::uniform_real_distribution<double> unit(-1, 1);
        std::normal_distribution<double> noise(0, 3);
        // Inverse distance from 1/m to 1/(4 m) over the frame, in a random direction.
        const double turn = std::numbers::pi * unit(random), cosine = std::cos(turn), sine = std::sin(turn);
        const double reach = std::abs(cosine) * half_x + std::abs(sine) * half_y;
        const double near = 1 / 1000.0, far = 1 / 4000.0, slope = (near - far) / 2 / reach;
        const Scene scene{slope * cosine, slope * sine, (near + far) / 2, lens};
        Targets targets;
        for (int i = 0; i < 24; ++i) {
          const double x = half_x * unit(random), y = half_y * unit(random);
          Vec p = scene.at(x, y);
          const double depth = lens.front_principal_z() - p.z;
          if (i < outliers) {
            double other = depth;
            while (std::abs(other / depth - 1) < 0.25) other = 2500 + 1500 * unit(random);
            p = Vec(x, y, -1) * other + Vec(0, 0, lens.front_principal_z());
          }
          targets.push_back({.point = {p + Vec(noise(random), noise(random), noise(random))}});
        }
        const TiltFit fit = fit_tilt(lens, targets, robust(lens));
        ASSERT_EQ(fit.status, Status::solved) << seed;
        const double error = degrees(angle(fit.focus->plane.normal, scene.plane().normal));
        worst = std::max(worst, error);
        for (int i = 0; i < 24; ++i) {
          const bool out = fit.blurs[static_cast<std::size_t>(i)].status == TargetStatus::outlier;
          if (i < outliers && !out) ++missed;
        }
      }
      EXPECT_LT(worst, 1) << outliers << " outliers, thick " << thick;
      EXPECT_EQ(missed, 0) << outliers;
    }
  }
}

/// Exact points of a plane; the first ones are moved far away along their lines of sight.
Targets with_outliers(const Scene& scene, int count, int outliers) {
  Targets targets = scene.targets(count, 0.3, 0.2, 3);
  for (int i = 0; i < outliers; ++i) targets[static_cast<std::size_t>(i)].point.position *= 1.5 + 0.1 * i;
  return targets;
}

TEST(RobustTiltFit, ExactPointsLoseNoWeightAndOutliersAll) {
  const Scene scene{1e-3, -5e-4, 5e-4, normal_lens()};
  for (const int count : {6, 7, 24, 25, 60, 1000}) {
    const int outliers = count / 2 - 2;
    const TiltFit fit = fit_tilt(scene.lens, with_outliers(scene, count, outliers), robust(scene.lens));
    ASSERT_EQ(fit.status, Status::solved) << count;
    EXPECT_LT(angle(fit.focus->plane.normal, scene.plane().normal), 1e-9) << count;
    EXPECT_LT(fit.rms_mm, 1e-10) << count;
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(fit.blurs[static_cast<std::size_t>(i)].status,
                i < outliers ? TargetStatus::outlier : TargetStatus::used)
          << i;
    }
  }
}

TEST(RobustTiltFit, FourTargetsHaveNoOutliers) {
  const Scene scene{1e-3, -5e-4, 5e-4, normal_lens()};
  const Targets targets = with_outliers(scene, 4, 1);
  const TiltFit plain = fit_tilt(scene.lens, targets, behind(scene.lens));
  const TiltFit fit = fit_tilt(scene.lens, targets, robust(scene.lens));
  EXPECT_EQ(fit.film.z(), plain.film.z());
  EXPECT_EQ(fit.film.tilt_rad, plain.film.tilt_rad);
  for (const TargetBlur& blur : fit.blurs) EXPECT_EQ(blur.status, TargetStatus::used);
}

TEST(RobustTiltFit, NoiseMakesNoOutliers) {
  const Scene scene{1e-3, -5e-4, 5e-4, normal_lens()};
  int outliers = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    Targets targets = scene.targets(24, 0.3, 0.2, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(1, 1e-3);
    for (FocusTarget& t : targets) t.point.position *= noise(random);
    const TiltFit plain = fit_tilt(scene.lens, targets, behind(scene.lens));
    const TiltFit fit = fit_tilt(scene.lens, targets, robust(scene.lens));
    EXPECT_NEAR(fit.film.z(), plain.film.z(), 0.01) << seed;
    EXPECT_LT(angle(fit.film.normal(), plain.film.normal()), 1e-3) << seed;
    for (const TargetBlur& blur : fit.blurs) outliers += blur.status == TargetStatus::outlier;
  }
  EXPECT_LE(outliers, 12);  // of 1200
}

TEST(RobustTiltFit, TargetsBecomeOutliersContinuously) {
  const Scene scene{1e-3, -5e-4, 5e-4, normal_lens()};
  Targets targets = scene.targets(24, 0.3, 0.2);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(1, 2e-3);
  for (FocusTarget& t : targets) t.point.position *= noise(random);
  const Vec still = targets[0].point.position;
  // In steps of 0.05 mm the film changes by at most the noise of the median. A target with full weight up to the border
  // would vanish with a jump.
  constexpr int steps = 2000;
  double last = 0;
  for (int i = 0; i <= steps; ++i) {
    targets[0].point.position = still * (1 + 0.05 * i / steps);
    const TiltFit fit = fit_tilt(scene.lens, targets, robust(scene.lens));
    if (i > 0) {
      EXPECT_NEAR(fit.film.z(), last, 2e-5) << i;
    }
    if (i == 0 || i == steps) {
      EXPECT_EQ(fit.blurs[0].status, i == 0 ? TargetStatus::used : TargetStatus::outlier);
    }
    last = fit.film.z();
  }
}

TEST(RobustTiltFit, FitsLinesAndSinglePositions) {
  // Most targets lie on a line or at one position of the picture; the others are too near.
  Targets line, place;
  for (int i = 0; i < 11; ++i) {
    const double inverse = 4e-4 + 1e-5 * i, off = i % 4 == 3 ? 1.4 : 1.0;
    line.push_back(target(0.02 * i / inverse / off, 0, -1 / inverse / off));
    place.push_back(target(100, 50, i % 4 == 3 ? -1000 : -2000));
    if (i % 4 == 3) place.back().point.position = Vec(50, 25, -1000);
  }
  const TiltFit along = fit_tilt(normal_lens(), line, robust(normal_lens()));
  EXPECT_EQ(along.status, Status::least_tilt);
  EXPECT_EQ(along.rank, PlaneRank::line);
  EXPECT_LT(along.rms_mm, 1e-10);
  EXPECT_EQ(along.film.tilt_rad, 0);
  const TiltFit at = fit_tilt(normal_lens(), place, robust(normal_lens()));
  EXPECT_EQ(at.rank, PlaneRank::point);
  EXPECT_FALSE(at.film.tilted());
  EXPECT_NEAR(at.film.z(), 50 * 2000 / 1950.0, 1e-12);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(along.blurs[i].status == TargetStatus::outlier, i % 4 == 3) << i;
    EXPECT_EQ(at.blurs[i].status == TargetStatus::outlier, i % 4 == 3) << i;
  }
}

}  // namespace tilt_fit_robust_test
}  // namespace petzval
