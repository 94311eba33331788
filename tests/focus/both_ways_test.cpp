// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {
namespace both_ways_test {

using testing::data_lens;
using testing::data_prescriptions;
using testing::expect_error;
using testing::expect_tokens;
using testing::message;
using enum FocusCriterion;
using enum DistanceOrigin;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double eps = std::numeric_limits<double>::epsilon();

double focal_length(const Lens& lens) {
  return std::abs(first_order(lens, lens.primary_wavelength(), main_meridian(lens)).effective_focal_length);
}

/// From the film to the distance and back to the film, from far subjects to a magnification of 1/4.
void expect_round_trips(const Lens& lens, const FocusOptions& options, double tolerance,
                        std::initializer_list<double> focal_lengths) {
  const double f = focal_length(lens);
  const double sense = first_order(lens).image_index > 0 ? 1 : -1;
  double before = -infinity;
  for (const double multiple : focal_lengths) {
    const FocusSolution there = solve_focus(lens, multiple * f, options);
    if (!there) continue;  // inside the front focus, or inside the lens
    const FocusSolution back = solve_subject(lens, there.film_z, options);
    ASSERT_TRUE(back) << multiple << ' ' << name(back.status);
    EXPECT_EQ(back.film_z, there.film_z);
    EXPECT_NEAR(solve_focus(lens, back.distance, options).film_z, there.film_z,
                tolerance * (f + std::abs(there.film_z)))
        << multiple;
    // The film moves monotonically away from the lens as the subject comes nearer.
    EXPECT_GE(sense * there.film_z, before) << multiple;
    before = sense * there.film_z;
  }
  EXPECT_TRUE(std::isfinite(before));
}

TEST(FocusRoundTrip, ReturnsToTheFilmInEveryLens) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    for (const DistanceOrigin origin : {front_vertex, film, entrance_pupil, front_principal}) {
      SCOPED_TRACE(p.id + ' ' + std::string(name(origin)));
      if (origin == entrance_pupil && std::isinf(pupils(lens, {}, main_meridian(lens)).entrance.z)) continue;
      for (const FocusCriterion criterion : {thin, paraxial}) {
        expect_round_trips(lens, {criterion, origin}, 4 * eps, {1e18, 1e9, 1e5, 1e3, 300, 100, 50, 35});
      }
    }
  }
}

TEST(FocusRoundTrip, ReturnsToTheFilmByExactRaysInEveryLens) {
  for (const Prescription& p : data_prescriptions()) {
    // Not for a rod lens whose full width is lit: on every film the blur is as wide as the rod, and the smallest blur
    // lies inside the rod.
    if (p.id == "cylinder_3.9mm") continue;
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    expect_round_trips(lens, {min_rms}, 1e-13, {infinity, 1e6, 100, 8});
    expect_round_trips(lens, {min_max, film}, 1e-13, {1e6, 50});
  }
}

TEST(FocusRoundTrip, ReturnsToTheFilmForFieldsAndColours) {
  const Lens triplet = data_lens("cooke_triplet_50mm_f5");
  const std::vector<FocusField> fields{{0, 1}, {radians(14), 0.5}};
  for (const FocusCriterion criterion : {min_rms, min_max}) {
    expect_round_trips(triplet, {criterion, front_vertex, fields}, 1e-13, {infinity, 100, 10});
    expect_round_trips(triplet, {criterion, film, fields}, 1e-13, {100});
  }
}

TEST(FocusRoundTrip, FilmTooFarInHasNoSubject) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  for (const FocusCriterion criterion : {thin, paraxial, min_rms, min_max}) {
    const double infinite = solve_focus(lens, infinity, {criterion}).film_z;
    for (const double film_z : {infinite - 1e-6, lens.surfaces().back().vertex_z, -50.0}) {
      const FocusSolution solution = solve_subject(lens, film_z, {criterion});
      EXPECT_EQ(solution.status, FocusStatus::unreachable) << name(criterion) << film_z;
      EXPECT_EQ(solution.distance, infinity);
      EXPECT_EQ(solution.film_z, infinite);
    }
    EXPECT_EQ(solve_subject(lens, infinite, {criterion}).distance, infinity);
  }
}

TEST(FocusRoundTrip, FilmBeyondTheLimitNamesTheNearestSubject) {
  const Lens lens = data_lens("achromat_100mm");
  const FocusSolution nearest = nearest_focus(lens, {min_rms});
  // Aberrated rays never leave parallel, so that the film has a farthest position, 5.6 m behind the lens.
  EXPECT_TRUE(std::isfinite(nearest.film_z));
  const FocusSolution beyond = solve_subject(lens, 2 * nearest.film_z, {min_rms});
  EXPECT_EQ(beyond.status, FocusStatus::unreachable);
  EXPECT_NEAR(beyond.distance, nearest.distance, 1e-7 * nearest.distance);
  EXPECT_EQ(solve_focus(lens, 0.99 * nearest.distance, {min_rms}).status, FocusStatus::unreachable);
  EXPECT_EQ(nearest_focus(lens, {paraxial}).film_z, infinity);
}

// Measured from the film, the nearest subject has magnification 1; with a mirror, subject and film coincide there.
TEST(FocusRoundTrip, NearestSubjectFromTheFilmHasMagnificationOne) {
  for (const char* id : {"double_gauss_100mm_f2.0", "telephoto_100mm_f5"}) {
    const Lens lens = data_lens(id);
    const IdealLens thick = thick_lens(lens);
    const FocusSolution nearest = nearest_focus(lens, {.criterion = paraxial, .origin = DistanceOrigin::film});
    const double f = thick.rear_focal_length;
    EXPECT_NEAR(nearest.film_z - thick.rear_focal_z, f, 1e-9 * f) << id;
    EXPECT_NEAR(thick.front_focal_z - nearest.subject_z, f, 1e-9 * f) << id;
    EXPECT_NEAR(nearest.distance, nearest.film_z - nearest.subject_z, 1e-9 * f) << id;
    EXPECT_EQ(nearest_focus(lens, {.criterion = paraxial}).film_z, infinity) << id;
  }
  const Lens mirror = data_lens("mirror_newton_200mm_f8");
  const FocusSolution meets = nearest_focus(mirror, {.criterion = paraxial, .origin = DistanceOrigin::film});
  EXPECT_NEAR(meets.distance, 0, 1e-9);
  EXPECT_NEAR(meets.film_z, -400, 1e-9);
  EXPECT_NEAR(nearest_focus(mirror, {.criterion = paraxial}).distance, 200, 1e-9);
}

TEST(FocusRoundTrip, RefusesInvalidFieldsAndWeights) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const auto error = [&](const FocusOptions& options) { return message([&] { solve_focus(lens, 1000, options); }); };
  const std::string where = lens.name();
  expect_tokens(error({.fields = {}}), {where, "field"});
  expect_tokens(error({.fields = {{0, 0}}}), {where, "field"});
  expect_tokens(error({.fields = {{0, -1}}}), {where, "weight", -1});
  expect_tokens(error({.fields = {{std::nan(""), 1}}}), {where, "field", "nan"});
  expect_tokens(error({.wavelength_weights = {1, 2}}), {where, 2, "wavelength"});
  expect_tokens(error({.wavelength_weights = {0}}), {where, "wavelength"});
  expect_tokens(error({.wavelength_weights = {std::nan("")}}), {where, "weight", "nan"});
  expect_error([&] { solve_subject(lens, infinity); }, {lens.name(), "film_z", "inf"});
  expect_error([&] { nearest_focus(lens, {.fields = {}}); }, {where, "field"});
}

TEST(FocusRoundTrip, FieldBeyondTheLensHasNoRays) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  const FocusOptions beyond{.criterion = min_rms, .fields = {{0, 1}, {radians(75), 1}}};
  EXPECT_EQ(solve_focus(lens, 1000, beyond).status, FocusStatus::no_rays);
  EXPECT_EQ(solve_subject(lens, 60, beyond).status, FocusStatus::no_rays);
  EXPECT_EQ(nearest_focus(lens, beyond).status, FocusStatus::no_rays);
  expect_error([&] { with_focus(lens, 1000, beyond); }, {lens.name(), 1000});
}

TEST(FocusRoundTrip, FieldsBeyond90DegreesCountAtInfinityOnly) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  const FocusOptions wide{.criterion = min_rms, .fields = {{0, 1}, {radians(80), 1}, {radians(100), 1}}};
  const FocusSolution infinite = solve_focus(lens, infinity, wide);
  ASSERT_TRUE(infinite);
  EXPECT_EQ(solve_subject(lens, infinite.film_z, wide).distance, infinity);
  EXPECT_EQ(solve_subject(lens, infinite.film_z + 0.01, wide).status, FocusStatus::unreachable);
  expect_error([&] { solve_focus(lens, 1000, wide); }, {"field", 100});
}

}  // namespace both_ways_test
}  // namespace petzval
