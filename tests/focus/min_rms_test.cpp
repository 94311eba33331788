// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace min_rms_test {

using testing::data_lens;
using testing::data_prescription;
using testing::expect_error;
using Status = FocusStatus;
using enum FocusCriterion;
using enum DistanceOrigin;
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(MinRms, WithoutSphericalAberrationIsTheParaxialFocus) {
  for (const char* id :
       {"analytic_ellipsoid_concentric_150mm", "analytic_plano_hyperbolic_100mm", "mirror_newton_200mm_f8"}) {
    const Lens lens = data_lens(id);
    EXPECT_NEAR(solve_focus(lens, infinity, {min_rms}).film_z, solve_focus(lens, infinity, {paraxial}).film_z, 1e-12)
        << id;
  }
}

// Mean square height of rays from a grid over the plane of the first vertex: brute force.
double spread(const std::vector<TracedRay<double>>& rays, double film_z) {
  double sum = 0;
  for (const auto& [ray, fate, surface] : rays) {
    const double t = (film_z - ray.origin.z) / ray.direction.z;
    sum += std::pow(ray.origin.x + t * ray.direction.x, 2) + std::pow(ray.origin.y + t * ray.direction.y, 2);
  }
  return sum / static_cast<double>(rays.size());
}

TEST(MinRms, MinimisesTheSpreadOverTheAperture) {
  struct Case {
    const char* id;
    double distance, tolerance;
  };
  // The tolerance covers the steps of the grid along the rims.
  for (const auto& [id, distance, tolerance] :
       {Case{"double_gauss_100mm_f2.0", 1000, 1e-4}, Case{"singlet_50mm_biconvex", infinity, 1e-3},
        Case{"catadioptric_maksutov_1280mm_f14.4", 3e4, 5e-4}, Case{"anamorphic_60mm_2x", 2000, 1e-3},
        Case{"cylinder_3.9mm", 100, 1e-2}, Case{"phone_5.6mm_f3.5", 500, 5e-5}}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const double film_z = solve_focus(lens, distance, {min_rms}).film_z;
    double radius = 0;
    for (const LensSurface& s : lens.surfaces()) radius = std::max(radius, s.semi_diameter);
    std::vector<TracedRay<double>> rays;
    constexpr int across = 800;
    for (int i = 0; i < across; ++i) {
      for (int k = 0; k < across; ++k) {
        const double x = radius * ((i + 0.5) / across * 2 - 1), y = radius * ((k + 0.5) / across * 2 - 1);
        const double length = std::isinf(distance) ? 1 : std::hypot(x, y, distance);
        const Vec3<double> direction =
            std::isinf(distance) ? Vec3<double>{0, 0, 1} : Vec3<double>{x / length, y / length, distance / length};
        const auto ray = trace(lens, Ray<double>{{x, y, 0}, direction});
        if (ray.transmitted()) rays.push_back(ray);
      }
    }
    ASSERT_GT(rays.size(), 1000u);
    // The vertex of the parabola through three films.
    const double step = 0.01 * std::abs(first_order(lens).effective_focal_length);
    const double a = spread(rays, film_z - step), b = spread(rays, film_z), c = spread(rays, film_z + step);
    const double least = film_z + step * (a - c) / (2 * (a - 2 * b + c));
    EXPECT_NEAR(film_z, least, tolerance);
  }
}

TEST(MinRms, NarrowZoneFocusesWhereItsRaysCrossTheAxis) {
  Prescription p = data_prescription("singlet_50mm_biconvex");
  p.surfaces[0].obscuration_semi_diameter = 0.93 * p.surfaces[0].semi_diameter.value();
  const Lens lens = compile(p);
  const auto crossing = [&](double height) {
    const auto [ray, fate, surface] = trace(lens, Ray<double>{{0, height, 0}, {0, 0, 1}}, {.apertures = false});
    return ray.origin.z - ray.origin.y * ray.direction.z / ray.direction.y;
  };
  const double film_z = solve_focus(lens, infinity, {min_rms}).film_z;
  EXPECT_LT(film_z, crossing(lens.surfaces()[0].obscuration_semi_diameter));
  EXPECT_GT(film_z, crossing(lens.surfaces()[0].semi_diameter));
}

// An independent Python program with other pupil samples gives -0.9 mm, 88, 76, -37 and -53 um.
TEST(MinRms, DoubleGaussEqualsAnIndependentTrace) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const auto difference_um = [&](double distance) {
    return 1000 * (solve_focus(lens, distance, {paraxial}).film_z - solve_focus(lens, distance, {min_rms}).film_z);
  };
  EXPECT_NEAR(difference_um(200), -900, 50);
  EXPECT_NEAR(difference_um(500), 88, 2.5);
  EXPECT_NEAR(difference_um(1000), 76, 2.5);
  EXPECT_NEAR(difference_um(10000), -37, 0.5);
  EXPECT_NEAR(difference_um(infinity), -53, 0.5);
  // At 55 mm the image of least RMS becomes virtual, before the paraxial image at 54.245 mm, because the film has
  // passed its farthest position.
  const double nearest = nearest_focus(lens, {min_rms}).distance;
  EXPECT_GT(nearest, 55);
  EXPECT_LT(nearest, 57);
  EXPECT_EQ(solve_focus(lens, 55, {min_rms}).status, Status::unreachable);
}

TEST(MinRms, FromTheFilmKeepsTheDistance) {
  for (const char* id : {"double_gauss_100mm_f2.0", "catadioptric_mangin_1000mm_f7.5", "anamorphic_60mm_2x",
                         "mirror_newton_200mm_f8", "modern_50mm_f1.0"}) {
    SCOPED_TRACE(id);
    const Lens lens = data_lens(id);
    const double f = std::abs(first_order(lens).effective_focal_length);
    for (const double distance : {30 * f, 1e4 * f}) {
      const FocusSolution solution = solve_focus(lens, distance, {min_rms, film});
      ASSERT_EQ(solution.status, Status::solved);
      EXPECT_NEAR(solution.film_z - solution.subject_z, distance, 1e-14 * distance);
      EXPECT_NEAR(solve_focus(lens, -solution.subject_z, {min_rms}).film_z, solution.film_z, 1e-9 * f);
    }
    EXPECT_EQ(solve_focus(lens, infinity, {min_rms, film}).film_z, solve_focus(lens, infinity, {min_rms}).film_z);
  }
}

TEST(MinRms, IsSmoothInTheDistance) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  std::vector<double> films;
  for (int i = 0; i < 40; ++i) films.push_back(solve_focus(lens, 1000 + 0.01 * i, {min_rms}).film_z);
  // Third differences are noise at this step.
  for (std::size_t i = 0; i + 3 < films.size(); ++i) {
    EXPECT_NEAR(films[i + 3] - 3 * films[i + 2] + 3 * films[i + 1] - films[i], 0, 1e-10);
  }
}

TEST(MinRms, WithoutRaysIsReported) {
  const Lens closed = with_semi_diameter(data_lens("double_gauss_100mm_f1.35"), 5, 0);
  EXPECT_EQ(solve_focus(closed, 1000, {min_rms}).status, Status::no_rays);
  EXPECT_EQ(solve_focus(closed, 1000, {min_rms, film}).status, Status::no_rays);
  EXPECT_EQ(solve_focus(closed, 1000, {paraxial}).status, Status::solved);
  expect_error([&] { with_focus(closed, 1000, {min_rms}); }, {closed.name(), "subject", 1000, "min_rms"});
}

TEST(MinRms, WithoutAnyRimIsAnError) {
  Prescription p = testing::open_singlet();
  p.name = "endless";
  expect_error([&] { solve_focus(compile(p), 1000, {min_rms}); }, {"endless", "semi_diameter"});
  // Every rim limits the beam, with or without the mark of the stop.
  p.surfaces[1].semi_diameter = 5;
  p.surfaces[0].stop = false;
  EXPECT_EQ(solve_focus(compile(p), 1000, {min_rms}).status, Status::solved);
}

}  // namespace min_rms_test
}  // namespace petzval
