// SPDX-License-Identifier: Apache-2.0
// The textbook method: accuracy, limits and errors, measured.
#include "support/textbook_pupil.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../data_lenses.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace {

using examples::textbook_entrance_pupil;
using examples::textbook_exit_pupil;
using examples::TextbookPupil;
using testing::data_prescriptions;
constexpr double infinity = std::numeric_limits<double>::infinity();

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

}  // namespace
}  // namespace petzval
