// SPDX-License-Identifier: Apache-2.0
// Lenses that focus by moving groups.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"

namespace moved_groups_test {

using petzval::FocusCriterion;
using petzval::Lens;
using petzval::Prescription;
using petzval::testing::expect_error;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two thin groups in air, 20 mm apart at infinity focus. The first group moves forward to focus, and the film keeps
/// its distance from the second group.
Prescription front_focusing() {
  Prescription p;
  p.name = "groups";
  p.surfaces = {{.radius = 60, .thickness = 4, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                {.radius = -60, .thickness = 20, .semi_diameter = 12},
                {.radius = 100, .thickness = 3, .medium = {.nd = 1.6}, .semi_diameter = 12},
                {.radius = -100, .thickness = 0, .semi_diameter = 12}};
  p.surfaces.back().thickness = 1;
  p.surfaces.back().thickness = petzval::first_order(petzval::compile(p)).back_focal_distance;
  const double film = p.surfaces.back().thickness;
  // The paraxial gap for a subject 800 mm in front of the first surface.
  const auto gap_for = [&](double distance) {
    double from = 15, to = 60;
    for (int i = 0; i < 200; ++i) {
      Prescription q = p;
      q.surfaces[1].thickness = (from + to) / 2;
      const Lens lens = petzval::compile(q);
      const double image = petzval::paraxial_image_z(lens, -distance) - lens.surfaces().back().vertex_z;
      (image > film ? from : to) = q.surfaces[1].thickness;
    }
    return from;
  };
  p.configurations = {{.name = "infinity"}};
  for (const double distance : {3000.0, 1500.0, 800.0}) {
    p.configurations.push_back({.name = std::to_string(distance),
                                .focus_of = "infinity",
                                .subject_distance_mm = distance,
                                .changes = {{.surface = 1, .thickness = gap_for(distance)}}});
  }
  return p;
}

TEST(MovedGroups, FollowTheTable) {
  const Prescription p = front_focusing();
  const Lens lens = petzval::compile(p);
  ASSERT_EQ(lens.focus_positions().size(), 4u);
  EXPECT_EQ(lens.focus_positions()[0].inverse_distance, 0);
  for (const auto& c : p.configurations) {
    const double distance = c.subject_distance_mm.value_or(infinity);
    const Lens moved = petzval::with_groups_at(lens, 1 / distance);
    EXPECT_EQ(moved.surfaces()[1].thickness, configured(p, c.name).surfaces[1].thickness) << c.name;
    // Paraxially the table is exact, so with_focus() finds it again.
    const Lens focused = petzval::with_focus(lens, distance, {.criterion = FocusCriterion::paraxial});
    EXPECT_NEAR(focused.surfaces()[1].thickness, moved.surfaces()[1].thickness, 1e-6) << c.name;
    EXPECT_NEAR(focused.film_z() - focused.surfaces().back().vertex_z, lens.surfaces().back().thickness, 1e-12);
  }
}

TEST(MovedGroups, SubjectBetweenThePositionsIsSharp) {
  const Lens lens = petzval::compile(front_focusing());
  for (const double distance : {infinity, 5000.0, 2000.0, 1100.0, 850.0}) {
    for (const FocusCriterion criterion : {FocusCriterion::paraxial, FocusCriterion::min_rms}) {
      const Lens focused = petzval::with_focus(lens, distance, {.criterion = criterion});
      const auto subject = petzval::solve_subject(focused, focused.film_z(), {.criterion = criterion});
      EXPECT_NEAR(1 / subject.distance, 1 / distance, 1e-9) << distance;
      EXPECT_NEAR(focused.film_z() - focused.surfaces().back().vertex_z, lens.surfaces().back().thickness, 1e-12);
    }
  }
}

TEST(MovedGroups, EndWhereTheTableEnds) {
  const Lens lens = petzval::compile(front_focusing());
  expect_error([&] { petzval::with_focus(lens, 100); }, {"groups", 100});
  expect_error([&] { petzval::with_groups_at(lens, std::nan("")); }, {"inverse", "nan"});
  const Lens rigid = petzval::testing::data_lens("double_gauss_100mm_f2.0");
  expect_error([&] { petzval::with_groups_at(rigid, 0); }, {rigid.name(), "group"});
  expect_error([&] { petzval::with_groups_at(lens, -1); }, {"groups"});
}

}  // namespace moved_groups_test
