// SPDX-License-Identifier: Apache-2.0
#include "petzval/paraxial/first_order.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "paraxial/ray_matrix.hpp"
#include "petzval/core/error.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace pupils_test {

using testing::data_lens;
using testing::data_prescriptions;
using testing::expect_error;
using testing::message;
constexpr double infinity = std::numeric_limits<double>::infinity();

RayMatrix transfer(double distance, double n) { return {1, distance / n, 0, 1}; }

TEST(Pupils, AreImagesOfTheStop) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const std::size_t count = lens.surface_count();
    for (const Meridian meridian : {Meridian::y, Meridian::x}) {
      const Pupils result = pupils(lens, 0, meridian);
      EXPECT_FALSE(result.stop_inferred);
      ASSERT_TRUE(std::isfinite(result.entrance.z) && std::isfinite(result.exit.z));
      const double radius = lens.surfaces()[result.stop].semi_diameter;
      const RayMatrix in =
          transfer(-result.entrance.z, signed_index(lens, 0)).then(ray_matrix_to(lens, result.stop, 0, meridian));
      EXPECT_NEAR(in.b, 0, 1e-11 * (1 + std::abs(result.entrance.z)));
      EXPECT_NEAR(std::abs(in.a) * result.entrance.diameter / 2, radius, 1e-12 * radius);
      const double behind = result.exit.z - lens.surfaces().back().vertex_z;
      const RayMatrix out =
          ray_matrix(lens, result.stop, count, 0, meridian).then(transfer(behind, signed_index(lens, count)));
      EXPECT_NEAR(out.b, 0, 1e-11 * (1 + std::abs(behind)));
      EXPECT_NEAR(std::abs(out.a) * radius, result.exit.diameter / 2, 1e-11 * radius);
    }
  }
}

TEST(Pupils, TelecentricPupilsAreInfinite) {
  for (const double radius : {20.0, 60.0, 61.3, 70.7, 100.0, 333.3}) {
    Prescription p;
    p.name = "telecentric";
    p.surfaces = {{.radius = radius, .thickness = 5, .medium = {.nd = 1.6}, .semi_diameter = 12},
                  {.radius = -80, .semi_diameter = 12}};
    p.surfaces[1].thickness = first_order(compile(p)).back_focal_distance;
    p.surfaces.push_back({.semi_diameter = 3, .stop = true});
    const Pupils result = pupils(compile(p));
    EXPECT_EQ(result.entrance.z, infinity) << radius;
    EXPECT_EQ(result.entrance.diameter, infinity);
    EXPECT_EQ(result.exit.diameter, 6);
  }
}

TEST(Pupils, WithoutAStopAreImagesOfTheLimitingRim) {
  Prescription p;
  p.name = "unmarked";
  p.surfaces = {{.radius = 50, .thickness = 30, .medium = {.nd = 1.5}, .semi_diameter = 10},
                {.radius = -50, .semi_diameter = 9}};
  // The beam shrinks to 1 - (0.5 / 50) (30 / 1.5) = 0.8 of its height on the way to the second surface.
  EXPECT_EQ(pupils(compile(p)).stop, 0u);
  p.surfaces[1].semi_diameter = 7.9;
  const Pupils result = pupils(compile(p));
  EXPECT_EQ(result.stop, 1u);
  EXPECT_TRUE(result.stop_inferred);
  EXPECT_NEAR(result.entrance.diameter, 2 * 7.9 / 0.8, 1e-13);
  p.surfaces[1].semi_diameter.reset();
  EXPECT_EQ(pupils(compile(p)).stop, 0u);
}

TEST(Pupils, CylinderWithoutAStopIsLimitedInTheWiderSection) {
  Prescription p;
  p.name = "cylinder";
  p.surfaces = {{.radius = 50, .thickness = 30, .medium = {.nd = 1.5}, .semi_diameter = 10, .curved_in = Section::y},
                {.radius = 0, .semi_diameter = 9}};
  // The beam shrinks to 0.8 in y and keeps its size in x, where the second rim limits it.
  EXPECT_EQ(pupils(compile(p)).stop, 1u);
  EXPECT_EQ(pupils(compile(p), 0, Meridian::x).stop, 1u);
  p.surfaces[0].curved_in = Section::both;
  EXPECT_EQ(pupils(compile(p)).stop, 0u);
}

TEST(Pupils, MarginalRayPassesEveryRimWithoutAStop) {
  for (Prescription p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    for (SurfaceRow& row : p.surfaces) row.stop = false;
    const Lens lens = compile(p);
    const Pupils result = pupils(lens);
    for (std::size_t i = 0; i < lens.surface_count(); ++i) {
      const double height = std::abs(ray_matrix_to(lens, i).a) * result.entrance.diameter / 2;
      EXPECT_LE(height, lens.surfaces()[i].semi_diameter * (1 + 1e-12)) << i;
    }
  }
}

TEST(Pupils, RefuseLensesWithoutAnyRim) {
  Prescription p;
  p.name = "endless";
  p.surfaces = {{.radius = 50, .medium = {.nd = 1.5}}};
  expect_error([&] { pupils(compile(p)); }, {"endless", "stop"});
  p.surfaces[0].stop = true;
  expect_error([&] { pupils(compile(p)); }, {"endless", "stop"});
  EXPECT_EQ(message([&] { paraxial_f_number(compile(p)); }), message([&] { pupils(compile(p)); }));
}

TEST(Pupils, StopWithoutRimIsLimitedByOtherRims) {
  for (Prescription p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const auto [marked, unmarked] = testing::without_the_rim_of_its_stop(p);
    if (!has_pupils(unmarked)) {
      EXPECT_FALSE(has_pupils(marked));
      continue;
    }
    const Pupils found = pupils(marked), wanted = pupils(unmarked);
    EXPECT_TRUE(found.stop_inferred);
    EXPECT_EQ(found.stop, wanted.stop);
    EXPECT_EQ(found.entrance.z, wanted.entrance.z);
    EXPECT_EQ(found.entrance.diameter, wanted.entrance.diameter);
    EXPECT_EQ(found.exit.diameter, wanted.exit.diameter);
    EXPECT_TRUE(std::isfinite(marked.surfaces()[found.stop].semi_diameter));
  }
}

TEST(Pupils, ClosedStopOnTheFilmHasNoCone) {
  Prescription p = testing::open_singlet(0);
  p.surfaces.back().thickness = 0;
  EXPECT_EQ(film_side_f_number(compile(p)), infinity);
}

TEST(Pupils, ClosedStopHasEmptyPupils) {
  const Lens lens = with_semi_diameter(data_lens("double_gauss_100mm_f1.35"), 5, 0);
  EXPECT_EQ(pupils(lens).entrance.diameter, 0);
  EXPECT_EQ(pupils(lens).exit.diameter, 0);
  EXPECT_EQ(paraxial_f_number(lens), infinity);
  EXPECT_EQ(real_f_number(lens), infinity);
}

}  // namespace pupils_test
}  // namespace petzval
