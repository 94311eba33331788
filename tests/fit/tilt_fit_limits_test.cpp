// SPDX-License-Identifier: Apache-2.0
// Targets that do not determine a plane, the limit of tilt, and invalid input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../film_at.hpp"
#include "../message.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "tilt_scene.hpp"

namespace petzval {
namespace tilt_fit_limits_test {

using testing::expect_tokens;
using testing::film_at;

using namespace testing;
using Status = FocusStatus;
using Targets = std::vector<FocusTarget>;
using Vec = Vec3<double>;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double F = 50;

/// Film slopes: z = z_mm + p x + q y.
struct Slopes {
  double p, q;
};
Slopes slopes(const Film& film) {
  const Vec n = film.normal();
  return {-n.x / n.z, -n.y / n.z};
}

TEST(TiltFitLimit, IsTheBestFilmWithinTheLimit) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Targets targets = inexact_targets(6, seed);
    const TiltFit free = fit_tilt(normal_lens(), targets, behind(normal_lens(), 60));
    ASSERT_TRUE(free);
    const double limit = 0.6 * free.film.angle();
    const TiltFit fit = fit_tilt(normal_lens(), targets, behind(normal_lens(), degrees(limit)));
    ASSERT_EQ(fit.status, Status::limited) << seed;
    EXPECT_NEAR(fit.film.angle(), limit, 1e-12);
    EXPECT_GT(fit.rms_mm, free.rms_mm);
    // Blurs are linear in z: the best film for given slopes has a closed form.
    const auto best = [&](double p, double q) {
      const double length = std::hypot(p, q, 1.0);
      double weights = 0, by = 0, square = 0;
      for (const FocusTarget& t : targets) {
        const ImagePoint image = *normal_lens().image(t.point);
        const auto blur = [&](double z) {
          return signed_blur(image, film_in({Vec(-p, -q, 1) / length, z / length})) - t.blur_mm;
        };
        const double at = blur(F), slope = blur(F + 1) - at;
        weights += t.weight * slope * slope, by += t.weight * slope * at, square += t.weight * at * at;
      }
      return square - by * by / weights;
    };
    const Slopes found = slopes(fit.film);
    const double least = best(found.p, found.q);
    for (int i = 0; i < 64; ++i) {
      for (const double part : {0.25, 0.5, 0.75, 1.0}) {
        const double r = part * std::tan(limit), turn = 2 * std::numbers::pi * i / 64;
        EXPECT_GE(best(r * std::cos(turn), r * std::sin(turn)), least * (1 - 1e-9)) << seed << " " << i << " " << part;
      }
    }
  }
}

TEST(TiltFitLimit, ZeroGivesAnUprightFilm) {
  const Targets targets = inexact_targets(9, 1);
  const TiltFit fit = fit_tilt(normal_lens(), targets, behind(normal_lens(), 0));
  EXPECT_EQ(fit.status, Status::limited);
  EXPECT_FALSE(fit.film.tilted());
  double weights = 0, sum = 0;  // its z is a weighted mean
  for (const FocusTarget& t : targets) {
    const ImagePoint image = *normal_lens().image(t.point);
    const double weight = t.weight * image.diameter_per_mm * image.diameter_per_mm;
    weights += weight, sum += weight * (image.position.z + t.blur_mm / image.diameter_per_mm);
  }
  EXPECT_NEAR(fit.film.z(), sum / weights, 1e-12);
}

/// The largest change of the film between steps while a parameter goes from 0 to 1.
double largest_change(const auto& targets_at, int steps, const TiltOptions& options) {
  double largest = 0;
  std::optional<Film> last;
  for (int i = 0; i <= steps; ++i) {
    const TiltFit fit = fit_tilt(normal_lens(), targets_at(static_cast<double>(i) / steps), options);
    EXPECT_TRUE(fit) << i;
    const Slopes now = slopes(fit.film), before = slopes(last.value_or(fit.film));
    largest = std::max({largest, std::abs(now.p - before.p), std::abs(now.q - before.q),
                        std::abs(fit.film.z() - last.value_or(fit.film).z()) / F});
    last = fit.film;
  }
  return largest;
}

/// Halved steps give half the changes, so that there are no jumps.
void expect_continuous(const auto& targets_at, const TiltOptions& options, int steps = 400) {
  const double coarse = largest_change(targets_at, steps, options);
  const double fine = largest_change(targets_at, 8 * steps, options);
  EXPECT_LT(fine, 0.2 * coarse + 1e-9) << coarse << " " << fine;
}

TEST(TiltFitLimit, PlaneThroughTheViewVectorNeitherFlipsNorJumps) {
  // A wall x = s, seen from one side, edge-on at s = 0, then from the other side.
  const auto wall = [](double noise) {
    return [noise](double t) {
      Targets targets;
      std::mt19937 random(4);
      std::uniform_real_distribution<double> unit(-1, 1);
      for (int i = 0; i < 12; ++i) {
        const double y = 300 * unit(random), depth = 2500 + 1500 * unit(random);
        targets.push_back(target(400 * (2 * t - 1) + noise * unit(random), y, -depth));
      }
      return targets;
    };
  };
  for (const double limit : {5.0, 20.0, 60.0}) {
    for (const double noise : {0.0, 1.0, 30.0}) {
      SCOPED_TRACE(limit);
      SCOPED_TRACE(noise);
      expect_continuous(wall(noise), behind(normal_lens(), limit));
    }
  }
  const TiltFit left = fit_tilt(normal_lens(), wall(0)(0.4), behind(normal_lens()));
  const TiltFit middle = fit_tilt(normal_lens(), wall(0)(0.5), behind(normal_lens()));
  const TiltFit right = fit_tilt(normal_lens(), wall(0)(0.6), behind(normal_lens()));
  EXPECT_EQ(left.status, Status::limited);
  EXPECT_EQ(right.status, Status::limited);
  EXPECT_NEAR(left.film.swing_rad, -right.film.swing_rad, 0.02);
  EXPECT_EQ(middle.status, Status::least_tilt);
  EXPECT_NEAR(middle.film.swing_rad, 0, 1e-9);
}

TEST(TiltFitLimit, PlaneThatTurnsPastTheLimitDoesNotJump) {
  const auto turned = [](double t) {
    const double slope = 0.02 * (2 * t - 1), c = 5e-4;
    return Scene{slope, 0.3 * slope + 1e-3, c, normal_lens()}.targets(9, 0.02, 0.02);
  };
  expect_continuous(turned, behind(normal_lens()));
  EXPECT_EQ(fit_tilt(normal_lens(), turned(0), behind(normal_lens())).status, Status::limited);
  EXPECT_EQ(fit_tilt(normal_lens(), turned(0.5), behind(normal_lens())).status, Status::solved);
}

TEST(TiltFitLimit, TargetThatMovesMakesNoJump) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Targets still = inexact_targets(7, seed);
    const auto moving = [&](double t) {
      Targets targets = still;
      const double depth = 1 / (1 / 700.0 + t * (1 / 9000.0 - 1 / 700.0));
      targets[0] = target((0.3 - 0.5 * t) * depth, (0.2 - 0.5 * t * t) * depth, -depth, 2);
      return targets;
    };
    SCOPED_TRACE(seed);
    expect_continuous(moving, behind(normal_lens(), 8));
  }
}

TEST(TiltFitLimit, TargetsThatPassEachOtherMakeNoJump) {
  const auto passing = [](double reach) {
    return [reach](double t) { return Targets{target(0, 0, -1500), target(reach * (2 * t - 1), 0, -3000)}; };
  };
  // The spread of the images is x / 6000; the slope fades out from a spread of 0.12 to 0.06 mm.
  expect_continuous(passing(0.3), behind(normal_lens()));
  for (const double reach : {1e-5, 1e-2}) {
    EXPECT_LT(largest_change(passing(reach), 100, behind(normal_lens())), 1e-9) << reach;
  }
  EXPECT_EQ(fit_tilt(normal_lens(), passing(0.059)(1), behind(normal_lens())).rank, PlaneRank::point);
  EXPECT_EQ(fit_tilt(normal_lens(), passing(0.061)(1), behind(normal_lens())).rank, PlaneRank::line);
  const TiltFit wide = fit_tilt(normal_lens(), passing(0.13)(1), behind(normal_lens()));
  EXPECT_NEAR(wide.film.angle(), radians(20), 1e-12);
  // Three points on a circle that shrinks and is inverted.
  expect_continuous(
      [](double t) {
        const double r = 0.3 * (2 * t - 1);
        return Targets{target(r, 0, -1500), target(-r, 2 * r, -3000), target(-2 * r, -3 * r, -4500)};
      },
      behind(normal_lens()), 800);
}

TEST(TiltFitSets, OnePositionGivesAnUprightFilm) {
  for (const Targets& targets : {Targets{target(300, 200, -2000)}, Targets(3, target(300, 200, -2000)),
                                 Targets{target(300, 200, -2000, 1, 0.1), target(300, 200, -2000, 1, -0.1)}}) {
    const TiltFit fit = fit_tilt(normal_lens(), targets, behind(normal_lens()));
    EXPECT_EQ(fit.status, Status::least_tilt);
    EXPECT_EQ(fit.rank, PlaneRank::point);
    EXPECT_FALSE(fit.film.tilted());
    EXPECT_NEAR(fit.film.z(), F * 2000 / 1950, 1e-12);
    for (const TargetBlur& blur : fit.blurs) EXPECT_NEAR(blur.blur_mm, 0, 1e-12);
  }
}

TEST(TiltFitSets, TwoPointsAndLinesGiveThePlaneOfLeastTilt) {
  // Any film through both images is exact; the smallest tilt rises along the line between the images.
  const Vec one(-300, 100, -2000), two(500, -200, -3000);
  const Vec a = normal_lens().image({one})->position, b = normal_lens().image({two})->position;
  const double least = std::abs(b.z - a.z) / std::hypot(b.x - a.x, b.y - a.y);
  Targets line;
  for (const double t : {0.0, 0.3, 0.5, 1.0}) line.push_back({.point = {one + t * (two - one)}});
  for (const Targets& targets : {Targets{{.point = {one}}, {.point = {two}, .weight = 3}}, line}) {
    const TiltFit fit = fit_tilt(normal_lens(), targets, behind(normal_lens()));
    EXPECT_EQ(fit.status, Status::least_tilt);
    EXPECT_EQ(fit.rank, PlaneRank::line);
    EXPECT_NEAR(std::tan(fit.film.angle()), least, 1e-12);
    EXPECT_LT(fit.rms_mm, 1e-13);
  }
}

TEST(TiltFitSets, TwoPointsMayExceedTheLimit) {
  const TiltFit fit =
      fit_tilt(normal_lens(), Targets{target(0, 10, -1000), target(0, 30, -4000)}, behind(normal_lens()));
  EXPECT_EQ(fit.status, Status::limited);
  EXPECT_NEAR(fit.film.angle(), radians(20), 1e-12);
  EXPECT_NEAR(fit.film.swing_rad, 0, 1e-12);
}

TEST(TiltFitSets, PointsAtInfinityBelongToPlanes) {
  // A ground and its horizon.
  const auto infinitely = [](double x, double y) { return FocusTarget{.point = {{x, y, -1}, true}}; };
  const Targets ground{target(-300, -1500, -4000), target(500, -1500, -6000), infinitely(0.2, 0), infinitely(-0.3, 0)};
  const TiltFit fit = fit_tilt(normal_lens(), ground, behind(normal_lens()));
  ASSERT_EQ(fit.status, Status::solved);
  EXPECT_LT(angle(fit.focus->plane.normal, {0, 1, 0}), 1e-9);
  EXPECT_NEAR(std::tan(fit.film.angle()), F / 1500, 1e-12);
  EXPECT_NEAR(fit.film.z(), F, 1e-12);
  EXPECT_LT(fit.rms_mm, 1e-12);

  const Targets sky{infinitely(0, 0), infinitely(0.1, 0.2), infinitely(-0.1, 0.1), target(3, 4, -infinity)};
  const TiltFit far = fit_tilt(normal_lens(), sky, behind(normal_lens()));
  EXPECT_EQ(far.status, Status::solved);
  EXPECT_NEAR(far.film.z(), F, 1e-12);
  EXPECT_LT(far.film.angle(), 1e-12);
  EXPECT_LT(far.rms_mm, 1e-13);
}

TEST(TiltFitSets, WithoutTargetsTheFilmIsKept) {
  TiltOptions options = behind(normal_lens());
  options.film = film_at(51, 0.1, -0.05);
  options.film.shift_x_mm = 4;
  for (const Targets& targets : {Targets{}, Targets{target(0, 0, -2000, 0)},
                                 Targets{target(0, 0, 100), target(0, 0, nan)}, Targets{target(0, 0, -40)}}) {
    const TiltFit fit = fit_tilt(normal_lens(), targets, options);
    EXPECT_EQ(fit.status, Status::no_targets);
    EXPECT_FALSE(fit);
    EXPECT_EQ(fit.film.z(), 51);
    EXPECT_EQ(fit.film.tilt_rad, 0.1);
    EXPECT_EQ(fit.film.swing_rad, -0.05);
    EXPECT_EQ(fit.film.shift_x_mm, 4);
    EXPECT_EQ(fit.blurs.size(), targets.size());
    EXPECT_EQ(fit.rms_mm, 0);
    EXPECT_TRUE(fit.focus);
  }
}

TEST(TiltFitSets, UnreachableTargetsAreIgnored) {
  const Targets good = inexact_targets(5, 2);
  const TiltFit wanted = fit_tilt(normal_lens(), good, behind(normal_lens()));
  using enum TargetStatus;
  const std::vector<std::pair<FocusTarget, TargetStatus>> bad{
      {target(nan, 0, -2000), not_finite},
      {target(0, infinity, -2000), not_finite},
      {target(0, 0, infinity), not_finite},
      {target(0, 0, -2000, -1), not_finite},
      {target(0, 0, -2000, nan), not_finite},
      {target(0, 0, -2000, infinity), not_finite},
      {target(0, 0, -2000, 1, nan), not_finite},
      {target(0, 0, -2000, 0), no_weight},
      {{.point = {{0, 0, -2000}}, .extent_stops = 2, .fixes_distance = false}, no_weight},
      {target(0, 0, 0), no_image},
      {target(0, 0, -50), no_image},
      {target(0, 0, -50 * (1 + 1e-15)), no_image},
      {target(0, 0, 1e300), no_image},
      {target(1e300, 0, -2000), no_image},
      {{.point = {{0, 0, 1}, true}}, no_image},
      {{.point = {{0, 0, 0}, true}}, no_image},
      {{.point = {{1, 0, 0}, true}}, no_image},
  };
  for (unsigned mix = 1; mix < 1u << bad.size(); mix = mix * 3 + 1) {
    Targets targets;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      if (mix >> i & 1u) targets.push_back(bad[i].first);
    }
    targets.insert(targets.end(), good.begin(), good.end());
    const TiltFit fit = fit_tilt(normal_lens(), targets, behind(normal_lens()));
    ASSERT_EQ(fit.status, wanted.status);
    EXPECT_EQ(fit.film.z(), wanted.film.z());
    EXPECT_EQ(fit.film.tilt_rad, wanted.film.tilt_rad);
    EXPECT_EQ(fit.rms_mm, wanted.rms_mm);
    std::size_t at = 0;
    for (std::size_t i = 0; i < bad.size(); ++i) {
      if (mix >> i & 1u) {
        EXPECT_EQ(fit.blurs[at++].status, bad[i].second) << i;
      }
    }
  }
  // The blur of a target without weight is reported.
  const TiltFit shown = fit_tilt(normal_lens(), Targets{good[0], target(0, 0, -1000, 0)}, behind(normal_lens()));
  EXPECT_LT(shown.blurs[1].blur_mm, -0.01);
}

TEST(TiltFitSets, ExtremesGiveFiniteFilmsOrStatuses) {
  const std::vector<double> values{0, 1, -1, 1e-300, -1e-300, 1e8, -1e8, 1e300, -1e300, -50, -50.000001, infinity, nan};
  std::mt19937 random(9);
  std::uniform_int_distribution<std::size_t> any(0, values.size() - 1);
  for (int draw = 0; draw < 2000; ++draw) {
    Targets targets = inexact_targets(draw % 5, static_cast<unsigned>(draw));
    for (int i = 0; i < 5; ++i) {
      FocusTarget t = target(values[any(random)], values[any(random)], -std::abs(values[any(random)]),
                             std::abs(values[any(random)]), draw % 2 ? 0 : values[any(random)]);
      t.point.at_infinity = any(random) < 3;
      targets.push_back(t);
    }
    TiltOptions options = behind(normal_lens());
    options.robust = draw % 3 == 0;
    const TiltFit fit = fit_tilt(normal_lens(), targets, options);
    EXPECT_TRUE(std::isfinite(fit.film.z() + fit.film.tilt_rad + fit.film.swing_rad + fit.film.shift_x_mm +
                              fit.film.shift_y_mm));
    EXPECT_LE(fit.film.angle(), radians(20) * (1 + 1e-12))
        << draw << " " << name(fit.status) << " rank " << static_cast<int>(fit.rank) << " " << fit.film.z();
    if (!fit) {
      EXPECT_EQ(fit.film.z(), options.film.z()) << draw;
    }
  }
}

TEST(TiltFitSets, PinholeKeepsTheFilm) {
  const TiltFit fit = fit_tilt(thin_lens(F, infinity), inexact_targets(5, 1), behind(normal_lens()));
  EXPECT_EQ(fit.status, Status::no_targets);
  EXPECT_EQ(fit.blurs[1].blur_mm, 0);
}

TEST(TiltFitSets, FilmIsIndependentOfTheSizeOfCones) {
  Targets sharp = inexact_targets(6, 3);
  for (FocusTarget& t : sharp) t.blur_mm = 0;
  for (const bool robust : {false, true}) {
    for (const double limit : {5.0, 60.0}) {
      TiltOptions options = behind(normal_lens(), limit);
      options.robust = robust;
      const TiltFit wanted = fit_tilt(normal_lens(), sharp, options);
      ASSERT_TRUE(wanted);
      for (const double f_number : {1e-300, 1e-160, 1e-9, 1e9, 1e160, 1e300}) {
        ::testing::internal::CaptureStderr();
        const TiltFit fit = fit_tilt(thin_lens(F, f_number), sharp, options);
        EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << f_number;
        EXPECT_EQ(fit.status, wanted.status) << f_number;
        EXPECT_NEAR(fit.film.z(), wanted.film.z(), 1e-9) << f_number;
        EXPECT_NEAR(fit.film.tilt_rad, wanted.film.tilt_rad, 1e-9) << f_number;
        EXPECT_NEAR(fit.film.swing_rad, wanted.film.swing_rad, 1e-9) << f_number;
      }
    }
  }
}

TEST(TiltFitFrame, ShiftKeepsTheCentreOfTheImage) {
  const IdealLens gauss = thick_lens(data_lens("double_gauss_52mm_f1.8"));
  for (const IdealLens& lens : {normal_lens(), gauss}) {
    TiltOptions options = behind(lens, 40);
    options.film.tilt_rad = 0.1;
    options.film.shift_x_mm = 5;
    options.film.shift_y_mm = -3;
    const Scene scene{4e-3, -2e-3, 8e-4, lens};
    const TiltFit fit = fit_tilt(lens, scene.targets(9, 0.1, 0.1), options);
    ASSERT_EQ(fit.status, Status::solved);
    const Vec pupil(0, 0, lens.pupils.exit.z);
    const Vec before = options.film.position({5, -3}) - pupil,
              now = fit.film.position({fit.film.shift_x_mm, fit.film.shift_y_mm}) - pupil;
    EXPECT_LT(glm::length(glm::cross(glm::normalize(before), glm::normalize(now))), 1e-12);
    EXPECT_GT(glm::length(before - now), 0.1);
  }
  // The axis is its own chief ray for every film.
  for (const double start : {0.0, 50.0}) {
    const Scene scene{4e-3, -2e-3, 8e-4, normal_lens()};
    const TiltFit fit = fit_tilt(normal_lens(), scene.targets(9, 0.1, 0.1), {.film = film_at(start)});
    ASSERT_EQ(fit.status, Status::solved);
    EXPECT_NEAR(fit.film.shift_x_mm, 0, 1e-12);
    EXPECT_NEAR(fit.film.shift_y_mm, 0, 1e-12);
  }
}

TEST(TiltFitFrame, FilmThatWouldTouchTheLensIsKept) {
  const Scene scene{0, 1 / F - 1e-3, 1e-3, normal_lens()};  // a tilt of 45 degrees
  TiltOptions options = behind(normal_lens(), 50);
  EXPECT_EQ(fit_tilt(normal_lens(), scene.targets(9, 0.01, 0.01), options).status, Status::solved);
  options.film.height_mm = 160;
  const TiltFit fit = fit_tilt(normal_lens(), scene.targets(9, 0.01, 0.01), options);
  EXPECT_EQ(fit.status, Status::unreachable);
  EXPECT_EQ(fit.film.z(), F);
  EXPECT_FALSE(fit.film.tilted());
  // A lens of negative power has no real images.
  EXPECT_EQ(fit_tilt(thin_lens(-F, 2), inexact_targets(5, 1), behind(normal_lens())).status, Status::unreachable);
}

TEST(TiltFitInput, IsCheckedAndNamed) {
  const auto said = [](const TiltOptions& options) {
    return message([&] { fit_tilt(normal_lens(), inexact_targets(3, 1), options); });
  };
  expect_tokens(said({.max_tilt_rad = -0.1}), {"fit_tilt", "tilt", -0.1});
  expect_tokens(said({.max_tilt_rad = nan}), {"fit_tilt", "tilt", "nan"});
  EXPECT_NE(said({.max_tilt_rad = std::numbers::pi / 2}), "no error");
  expect_tokens(said({.film = film_at(nan)}), {"fit_tilt", "film", "nan", 0, 0});
  expect_tokens(said({.film = {.width_mm = -1}}), {"fit_tilt", "film", -1, 24, 0, 0});
  expect_tokens(said({.film = {.shift_x_mm = infinity}}), {"fit_tilt", "film", 36, 24, "inf", 0});
  EXPECT_EQ(said({.max_tilt_rad = radians(89.9)}), "no error");
}

}  // namespace tilt_fit_limits_test
}  // namespace petzval
