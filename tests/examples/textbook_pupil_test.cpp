// SPDX-License-Identifier: Apache-2.0
// The textbook method: accuracy, limits and errors, measured.
#include "support/textbook_pupil.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../data_lenses.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace {

using examples::textbook_entrance_pupil;
using examples::textbook_exit_pupil;
using examples::TextbookPupil;
using testing::data_lens;
using testing::data_prescriptions;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The marked stop is surface 5; surface 2 is a little too small.
Lens double_gauss() { return data_lens("double_gauss_100mm_f2.0"); }

/// Half the diagonal of a film of 48 x 72 mm: relative to 100 mm as 24 x 36 mm to a focal length of 50 mm.
constexpr double film_corner = 43.27;

Ray<double> from_film(const Lens& lens, double film_height, double x, double y, double z) {
  const double dy = y - film_height, dz = z - lens.film_z(), length = std::hypot(x, dy, dz);
  return {{x, y, z}, {x / length, dy / length, dz / length}};
}

/// A disc in the plane of the exit pupil, compared with the rays from a film point that pass the lens.
struct Cover {
  double of_passing = 0;  ///< fraction of the passing rays that lie in the disc
  double of_disc = 0;     ///< fraction of the disc that passes
};

Cover cover(const Lens& lens, const TextbookPupil& exit, double film_height) {
  constexpr int nodes = 500;
  constexpr double half = 40;
  int inside = 0, passing = 0, both = 0;
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < nodes; ++j) {
      const double x = half * ((2 * i + 1.0) / nodes - 1), y = half * ((2 * j + 1.0) / nodes - 1);
      const bool in_disc = 2 * std::hypot(x, y) <= exit.diameter;
      const bool passes =
          trace(lens, from_film(lens, film_height, x, y, exit.z), {.travel = Travel::to_scene}).transmitted();
      inside += in_disc;
      passing += passes;
      both += in_disc && passes;
    }
  }
  return {static_cast<double>(both) / passing, static_cast<double>(both) / inside};
}

/// A ray a little farther from the axis than another.
Ray<double> outwards(const Ray<double>& ray, double object_z, double by) {
  const double y = ray.origin.y + by;
  if (std::isinf(object_z)) return {{0, y, ray.origin.z}, ray.direction};
  const double z = ray.origin.z - object_z, length = std::copysign(std::hypot(y, z), z * ray.direction.z);
  return {{0, y, ray.origin.z}, {0, y / length, z / length}};
}

// The corrected method: the returned ray passes, and the next ray outwards is clipped.
TEST(TextbookPupil, ReturnsTheLastRayThatPasses) {
  for (const Prescription& p : data_prescriptions()) {
    const Lens lens = compile(p);
    if (!trace(lens, Ray<double>{}).transmitted() || main_meridian(lens) != Meridian::y)
      continue;  // a central obscuration
    const double f = *p.focal_length_mm;
    for (const double object_z : {-infinity, -1e4 * f, -100 * f, -10 * f}) {
      SCOPED_TRACE(p.id + " " + std::to_string(object_z));
      const TextbookPupil entrance = textbook_entrance_pupil(lens, object_z);
      EXPECT_TRUE(trace(lens, entrance.marginal).transmitted());
      const auto next = trace(lens, outwards(entrance.marginal, object_z, 1e-12 * f));
      EXPECT_FALSE(next.transmitted());
      EXPECT_EQ(next.surface, static_cast<int>(entrance.limiting));
      EXPECT_EQ(next.fate, entrance.next_fate);
    }
    for (const double film_z : {lens.film_z(), infinity}) {
      SCOPED_TRACE(p.id + " film " + std::to_string(film_z));
      const TextbookPupil exit = textbook_exit_pupil(lens, film_z);
      EXPECT_TRUE(trace(lens, exit.marginal, {.travel = Travel::to_scene}).transmitted());
      const auto next = trace(lens, outwards(exit.marginal, film_z, 1e-12 * f), {.travel = Travel::to_scene});
      EXPECT_FALSE(next.transmitted());
      EXPECT_EQ(next.surface, static_cast<int>(exit.limiting));
    }
  }
}

// The method is correct for thin beams: the disc tends to the paraxial pupil.
TEST(TextbookPupil, TendsToTheParaxialPupilAsTheStopCloses) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens whole = compile(p);
    if (!trace(whole, Ray<double>{}).transmitted()) continue;
    const std::size_t stop = whole.stop().value();
    const Lens lens = with_semi_diameter(whole, stop, 1e-4 * whole.surfaces()[stop].semi_diameter);
    const Pupils paraxial = pupils(lens, 0, main_meridian(lens));
    const TextbookPupil entrance = textbook_entrance_pupil(lens, -infinity);
    EXPECT_EQ(entrance.limiting, stop);
    EXPECT_EQ(entrance.z, paraxial.entrance.z);
    EXPECT_NEAR(entrance.diameter / paraxial.entrance.diameter, 1, 1e-7);
    const TextbookPupil exit = textbook_exit_pupil(lens, lens.film_z());
    EXPECT_EQ(exit.limiting, stop);
    EXPECT_EQ(exit.z, paraxial.exit.z);
    // The phone lens has terms of third order in the height: its error falls with the height, not with its square.
    EXPECT_NEAR(exit.diameter / paraxial.exit.diameter, 1, p.id == "phone_5.6mm_f3.5" ? 1e-5 : 1e-7);
  }
}

// Error one: the ray depends on the first rim that clips.
TEST(TextbookPupil, BelongsToTheFirstRimNotToTheStop) {
  const Lens lens = double_gauss();
  const double focal_length = first_order(lens).effective_focal_length;
  const TextbookPupil far = textbook_entrance_pupil(lens, -infinity);
  EXPECT_EQ(lens.stop(), 5u);
  EXPECT_EQ(far.limiting, 2u);
  EXPECT_NEAR(far.diameter / 2, 24.956, 1e-3);
  EXPECT_NEAR(focal_length / (2 * real_f_number(lens)), 25.132, 1e-3);  // height of the ray to the rim of the stop
  EXPECT_NEAR(pupils(lens).entrance.diameter / 2, 24.805, 1e-3);
  // At 1 m a rim of the rear group clips. The setting of the stop changes neither result.
  const TextbookPupil near = textbook_entrance_pupil(lens, -1000);
  EXPECT_EQ(near.limiting, 8u);
  EXPECT_NEAR(near.diameter / 2, 25.132, 1e-3);
  EXPECT_EQ(textbook_entrance_pupil(with_any_semi_diameter(lens, 5, 17.5), -1000).diameter, near.diameter);
}

// Error two: the pupil is found on the axis, but off the axis rims clip and shift the pupil.
TEST(TextbookPupil, WideOpenIsMostlyBlockedAtTheEdgeOfTheField) {
  const Lens lens = double_gauss();
  const TextbookPupil exit = textbook_exit_pupil(lens, lens.film_z());
  const Cover axis = cover(lens, exit, 0), edge = cover(lens, exit, film_corner);
  EXPECT_GT(axis.of_passing, 0.99);
  EXPECT_GT(axis.of_disc, 0.99);
  EXPECT_NEAR(edge.of_disc, 0.205, 0.005);
  EXPECT_GT(edge.of_passing, 0.999);
}

// Error three: stopped down, if only the stop clips, the disc is at the wrong position and misses light.
TEST(TextbookPupil, StoppedDownMissesAFifthOfTheLightAtTheEdgeOfTheField) {
  const Lens whole = double_gauss();
  const Lens lens = with_semi_diameter(whole, 5, whole.surfaces()[5].semi_diameter / 4);
  const TextbookPupil exit = textbook_exit_pupil(lens, lens.film_z());
  EXPECT_EQ(exit.limiting, 5u);
  EXPECT_GT(cover(lens, exit, 0).of_passing, 0.99);
  EXPECT_NEAR(cover(lens, exit, film_corner).of_passing, 0.795, 0.005);
}

}  // namespace
}  // namespace petzval
