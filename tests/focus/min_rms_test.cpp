// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
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
