// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../data_lenses.hpp"
#include "../film_at.hpp"
#include "fit/fit_to_rays.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/pupil/f_number.hpp"
#include "tilt_scene.hpp"

namespace petzval {
namespace tilt_fit_rays_test {

using testing::film_at;

using namespace testing;
using Status = FocusStatus;
using Targets = std::vector<FocusTarget>;

const Lens& gauss() {
  static const Lens lens = data_lens("double_gauss_52mm_f1.8");
  return lens;
}
const ImageRays& bundles() {
  static const ImageRays result(gauss(), 30);
  return result;
}

/// A tilted plane, over most of the frame.
Scene tilted_plane(const IdealLens& lens) { return {3e-4, -1.5e-3, 5e-4, lens}; }

/// The mean square diameter of a bundle on a film, as a parabola over the film's z.
struct Parabola {
  double z = 0, least = 0, by_z = 0;  ///< diameter^2 = least + by_z (film_z - z)^2
};
Parabola parabola(const RayBundle& bundle, const Film& film) {
  const auto square = [&](double step) {
    const double d = blur_on(bundle, film_at(film.z() + step, film.tilt_rad, film.swing_rad))->signed_diameter;
    return d * d;
  };
  const double before = square(-1), here = square(0), behind = square(1);
  const double by_z = (behind + before) / 2 - here, foot = (before - behind) / (4 * by_z);
  return {film.z() + foot, here - by_z * foot * foot, by_z};
}

/// Weighted RMS of diameters. For a target with a blur the film is nearer, so that defocus and aberrations add up to
/// the blur.
double rms(const Targets& targets, const Film& film) {
  double sum = 0, weights = 0;
  for (const FocusTarget& t : targets) {
    const RayBundle bundle = bundles().bundle(t.point);
    const Parabola here = parabola(bundle, film), upright = parabola(bundle, film_at(film.z()));
    const double defocus =
        std::copysign(std::sqrt(std::max(t.blur_mm * t.blur_mm - upright.least, 0.0) / here.by_z), t.blur_mm);
    sum += t.weight * (here.least + here.by_z * std::pow(film.z() - here.z - defocus, 2));
    weights += t.weight;
  }
  return std::sqrt(sum / weights);
}

TEST(RayTiltFit, MinimisesTheSumOfSquaredBlurs) {
  for (const double blurred : {0.0, 0.2}) {
    Targets targets = tilted_plane(bundles().ideal()).targets(9, 0.25, 0.18);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      targets[i].weight = 1 + static_cast<double>(i % 3);
      if (i % 2) targets[i].blur_mm = blurred;
    }
    const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal()));
    ASSERT_EQ(fit.status, Status::solved);
    double squares = 0, weights = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const double blur = blur_on(bundles().bundle(targets[i].point), fit.film)->signed_diameter;
      EXPECT_EQ(fit.blurs[i].blur_mm, blur);
      squares += targets[i].weight * std::pow(blur - targets[i].blur_mm, 2), weights += targets[i].weight;
    }
    EXPECT_NEAR(fit.rms_mm, std::sqrt(squares / weights), 1e-14);
    const double z = fit.film.z(), tilt = fit.film.tilt_rad, swing = fit.film.swing_rad;
    const double least = rms(targets, fit.film);
    for (const double step : {-1e-4, 1e-4}) {
      EXPECT_GT(rms(targets, film_at(z + 30 * step, tilt, swing)), least);
      EXPECT_GT(rms(targets, film_at(z, tilt + step, swing)), least);
      EXPECT_GT(rms(targets, film_at(z, tilt, swing + step)), least);
    }
    const auto square = [&](const Film& film) { return rms(targets, film) * rms(targets, film); };
    EXPECT_LT(off_least(square, fit.film, 50), 1e-7);
    // The film of the thick lens is only an initial value.
    const TiltFit thick = fit_tilt(bundles().ideal(), targets, behind(bundles().ideal()));
    EXPECT_GT(rms(targets, thick.film), least);
  }
}

/// The least cost of a search from a film, with halved steps.
double searched(const Targets& targets, Film film) {
  double least = rms(targets, film);
  for (double step = 0.02; step > 1e-6;) {
    bool better = false;
    for (const double by : {-step, step}) {
      for (const Film& there : {film_at(film.z() + 10 * by, film.tilt_rad, film.swing_rad),
                                film_at(film.z(), film.tilt_rad + by, film.swing_rad),
                                film_at(film.z(), film.tilt_rad, film.swing_rad + by)}) {
        const double cost = rms(targets, there);
        if (cost < least) least = cost, film = there, better = true;
      }
    }
    if (!better) step /= 2;
  }
  return least;
}

TEST(RayTiltFit, NoSearchFindsBetterBlurs) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    for (const bool contradictory : {false, true}) {
      Targets targets = tilted_plane(bundles().ideal()).targets(4, 0.25, 0.18, seed);
      targets[seed].blur_mm = 0.03;
      if (contradictory) {
        targets.push_back(targets[seed]);
        targets.back().blur_mm = -0.05;
      }
      const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal()));
      ASSERT_EQ(fit.status, Status::solved);
      const double least = rms(targets, fit.film);
      for (const Film& from : {fit.film, film_at(fit.film.z() + 0.3, 0, 0),
                               film_at(fit.film.z(), fit.film.tilt_rad - 0.03, fit.film.swing_rad + 0.03)}) {
        EXPECT_GT(searched(targets, from), least * (1 - 1e-9)) << seed << " " << contradictory;
      }
    }
  }
}

TEST(RayTiltFit, GrowingBlursMakeNoJump) {
  // A table, whose third point moves towards the lens.
  const auto film_at = [](double depth, double want, double turned = 1) {
    Targets targets{target(-75, -73, -720), target(95, -54, -766), target(0, 2, -depth), target(-150, 86, -1100),
                    target(160, 107, -1150)};
    double sign = 1;
    for (FocusTarget& t : targets) t.blur_mm = want * (sign *= turned);
    return fit_tilt(bundles(), targets, behind(bundles().ideal())).film;
  };
  const auto change = [](const Film& a, const Film& b) {
    return std::max(
        {std::abs(a.z() - b.z()) / 50, std::abs(a.tilt_rad - b.tilt_rad), std::abs(a.swing_rad - b.swing_rad)});
  };
  double sharp = 0, blurred = 0;
  for (double depth = 924; depth < 930; depth += 0.5) {
    sharp = std::max(sharp, change(film_at(depth, 0), film_at(depth + 0.5, 0)));
    for (const double turned : {1.0, -1.0}) {
      for (const double want : {0.01, -0.01, 0.1, -0.1}) {
        blurred = std::max(blurred, change(film_at(depth, want, turned), film_at(depth + 0.5, want, turned)));
      }
    }
  }
  EXPECT_GT(sharp, 0);
  EXPECT_LT(blurred, 2 * sharp);
  // The blur of the target grows.
  Film last = film_at(900, 0, -1);
  for (double want = 0; want < 0.05; want += 1e-4) {
    const Film film = film_at(900, want, -1);
    EXPECT_LT(change(film, last), 1e-3) << want;
    last = film;
  }
}

TEST(RayTiltFit, UprightIsAutofocus) {
  Targets targets = tilted_plane(bundles().ideal()).targets(6, 0.25, 0.18);
  const std::vector<double> wants{0, 0.03, -0.03, 0.2, -0.3, 1e-4};
  for (std::size_t i = 0; i < targets.size(); ++i) {
    targets[i].blur_mm = wants[i];
    targets[i].weight = 1 + static_cast<double>(i);
  }
  const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal(), 0));
  const Autofocus focus = autofocus(bundles(), targets);
  ASSERT_TRUE(focus);
  EXPECT_NEAR(fit.film.z(), focus.film.z(), 1e-10);
  EXPECT_NEAR(fit.rms_mm, focus.rms_mm, 1e-10);
}

TEST(RayTiltFit, OnePointGetsItsSharpestFilm) {
  // On an upright film the squared RMS radius is a parabola in z with its vertex at -cov(x, s) / var(s).
  const ScenePoint place{{150, -80, -1500}};
  const RayBundle bundle = bundles().bundle(place);
  const auto count = static_cast<double>(bundle.x.size());
  double x = 0, y = 0, sx = 0, sy = 0;
  for (std::size_t i = 0; i < bundle.x.size(); ++i) {
    x += bundle.x[i] / count, y += bundle.y[i] / count;
    sx += bundle.slope_x[i] / count, sy += bundle.slope_y[i] / count;
  }
  double covariance = 0, variance = 0;
  for (std::size_t i = 0; i < bundle.x.size(); ++i) {
    const double dx = bundle.slope_x[i] - sx, dy = bundle.slope_y[i] - sy;
    covariance += (bundle.x[i] - x) * dx + (bundle.y[i] - y) * dy;
    variance += dx * dx + dy * dy;
  }
  const TiltFit fit = fit_tilt(bundles(), Targets{{.point = place}}, behind(bundles().ideal()));
  EXPECT_EQ(fit.status, Status::least_tilt);
  EXPECT_FALSE(fit.film.tilted());
  EXPECT_NEAR(fit.film.z(), bundle.plane_z - covariance / variance, 1e-10);
}

TEST(RayTiltFit, ThreeTargetsGetTheirBlurs) {
  Targets targets = tilted_plane(bundles().ideal()).targets(3, 0.25, 0.18, 5);
  targets[0].blur_mm = 0.3, targets[1].blur_mm = -0.2, targets[2].blur_mm = 0.4;
  const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal()));
  ASSERT_EQ(fit.status, Status::solved);
  // The tolerance covers aberrations of the sampled rays, which differ between a tilted and an upright film.
  for (const TargetBlur& blur : fit.blurs) EXPECT_NEAR(blur.blur_mm, blur.target_mm, 1e-4);
}

TEST(RayTiltFit, TendsToTheThickLensAsApertureAndFieldShrink) {
  double last = 0;
  for (const double size : {1.0, 0.5, 0.25}) {
    const ImageRays narrow(with_f_number(gauss(), 8 / size), 30);
    const Targets targets = tilted_plane(narrow.ideal()).targets(12, 0.06 * size, 0.04 * size);
    const TiltFit rays = fit_tilt(narrow, targets, behind(narrow.ideal()));
    const TiltFit thick = fit_tilt(narrow.ideal(), targets, behind(narrow.ideal()));
    ASSERT_EQ(rays.status, Status::solved);
    const double difference = std::abs(rays.film.z() - thick.film.z());
    EXPECT_LT(difference, 0.02);
    if (last > 0) {
      EXPECT_NEAR(difference / last, 0.25, 0.05) << size;
    }
    last = difference;
  }
}

TEST(RayTiltFit, IndependentOfTheUnitOfLength) {
  const Targets targets = tilted_plane(bundles().ideal()).targets(9, 0.25, 0.18);
  const TiltFit base = fit_tilt(bundles(), targets, behind(bundles().ideal()));
  for (const double unit : {0x1p-20, 0x1p20}) {  // exact, so that no fate at a rim changes
    const ImageRays scaled(compile(scale(data_prescription("double_gauss_52mm_f1.8"), unit)), 30 * unit);
    Targets there = targets;
    for (FocusTarget& t : there) t.point.position *= unit;
    TiltOptions options = behind(scaled.ideal());
    options.film = {.width_mm = 36 * unit, .height_mm = 24 * unit};
    const TiltFit fit = fit_tilt(scaled, there, options);
    EXPECT_NEAR(fit.film.z() / unit, base.film.z(), 1e-12 * base.film.z());
    EXPECT_NEAR(fit.film.tilt_rad, base.film.tilt_rad, 1e-12);
    EXPECT_NEAR(fit.film.swing_rad, base.film.swing_rad, 1e-12);
  }
}

TEST(RayTiltFit, HoldsTheLimitOptimally) {
  const Targets targets = tilted_plane(bundles().ideal()).targets(9, 0.25, 0.18);
  const double limit = radians(1);
  const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal(), 1));
  ASSERT_EQ(fit.status, Status::limited);
  EXPECT_NEAR(fit.film.angle(), limit, 1e-12);
  const double z = fit.film.z(), tilt = fit.film.tilt_rad, swing = fit.film.swing_rad;
  const double least = rms(targets, fit.film);
  const double turn = std::atan2(tilt, swing);
  for (const double step : {-0.02, 0.02}) {  // around the limit, for such small angles
    EXPECT_GT(rms(targets, film_at(z, limit * std::sin(turn + step), limit * std::cos(turn + step))), least);
    EXPECT_GT(rms(targets, film_at(z + 0.1 * step, tilt, swing)), least);
  }
  const TiltFit upright = fit_tilt(bundles(), targets, behind(bundles().ideal(), 0));
  EXPECT_FALSE(upright.film.tilted());
  EXPECT_GT(upright.rms_mm, fit.rms_mm);
}

TEST(RayTiltFit, LimitAppliesToItsFilm) {
  // The film for curved images has another tilt than the film for ideal images, so that only one of both fits may reach
  // the limit.
  bool less = false, more = false;
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    const Targets targets = tilted_plane(bundles().ideal()).targets(4, 0.25, 0.18, seed);
    const TiltFit rays = fit_tilt(bundles(), targets, behind(bundles().ideal(), 60));
    const TiltFit thick = fit_tilt(bundles().ideal(), targets, behind(bundles().ideal(), 60));
    const double between = degrees(rays.film.angle() + thick.film.angle()) / 2;
    const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal(), between));
    if (rays.film.angle() < thick.film.angle()) {
      less = true;
      EXPECT_EQ(fit.status, Status::solved);
      EXPECT_NEAR(fit.film.z(), rays.film.z(), 1e-9);
      EXPECT_NEAR(fit.film.angle(), rays.film.angle(), 1e-9);
    } else {
      more = true;
      EXPECT_EQ(fit.status, Status::limited);
      EXPECT_NEAR(degrees(fit.film.angle()), between, 1e-9);
    }
  }
  EXPECT_TRUE(less);
  EXPECT_TRUE(more);
}

TEST(RayTiltFit, ContinuesFromFilmsThatNoRaysCross) {
  // The film through both ideal images is so steep that rays of both targets would reach it from behind.
  const Targets targets{target(0, 10, -1000), target(0, 30, -4000)};
  TiltOptions options = behind(bundles().ideal(), 89.9);
  options.film = {.width_mm = 0, .height_mm = 0};
  const TiltFit thick = fit_tilt(bundles().ideal(), targets, options);
  ASSERT_TRUE(thick);
  EXPECT_GT(thick.film.angle(), radians(80));
  EXPECT_FALSE(blur_on(bundles().bundle(targets[0].point), thick.film));
  EXPECT_TRUE(fit_tilt(bundles(), targets, options));
}

TEST(RayTiltFit, UsesTheOutliersOfTheThickLens) {
  Targets targets = tilted_plane(bundles().ideal()).targets(12, 0.25, 0.18);
  const Targets good(targets.begin() + 2, targets.end());
  targets[0].point.position *= 1.5, targets[1].point.position *= 0.6;
  TiltOptions options = behind(bundles().ideal());
  const TiltFit wanted = fit_tilt(bundles(), good, options);
  options.robust = true;
  const TiltFit fit = fit_tilt(bundles(), targets, options);
  EXPECT_EQ(fit.blurs[0].status, TargetStatus::outlier);
  EXPECT_EQ(fit.blurs[1].status, TargetStatus::outlier);
  EXPECT_GT(std::abs(fit.blurs[0].blur_mm), 0.05);
  EXPECT_NEAR(fit.film.z(), wanted.film.z(), 1e-8);
  EXPECT_NEAR(fit.rms_mm, wanted.rms_mm, 1e-8);
}

TEST(RayTiltFit, InvisibleTargetsAreIgnored) {
  const Targets good = tilted_plane(bundles().ideal()).targets(6, 0.25, 0.18);
  const Film wanted = fit_tilt(bundles(), good, behind(bundles().ideal())).film;
  Targets targets = good;
  targets.push_back(target(9000, 0, -1000));  // far outside the picture
  targets.push_back(target(0, 0, -1));        // inside the focal length
  targets.push_back(target(0, 0, -1000, 0));  // shown only
  const TiltFit fit = fit_tilt(bundles(), targets, behind(bundles().ideal()));
  EXPECT_EQ(fit.blurs[6].status, TargetStatus::no_rays);
  EXPECT_TRUE(std::isnan(fit.blurs[6].blur_mm));
  EXPECT_EQ(fit.blurs[7].status, TargetStatus::no_image);
  EXPECT_EQ(fit.blurs[8].status, TargetStatus::no_weight);
  EXPECT_TRUE(std::isfinite(fit.blurs[8].blur_mm));
  EXPECT_EQ(fit.film.z(), wanted.z());
  EXPECT_EQ(fit.film.tilt_rad, wanted.tilt_rad);
  const TiltFit none = fit_tilt(bundles(), Targets{targets[6]}, behind(bundles().ideal()));
  EXPECT_EQ(none.status, Status::no_targets);
}

}  // namespace tilt_fit_rays_test
}  // namespace petzval
