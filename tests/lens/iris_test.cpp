// SPDX-License-Identifier: Apache-2.0
#include "petzval/iris/iris.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "lens/any_semi_diameter.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace iris_test {

using testing::expect_error;
using testing::expect_tokens;
using testing::message;

TEST(Iris, RefusesStopsThatCannotHaveAnIris) {
  const Lens lens = testing::front_stop_lens();
  Prescription p = testing::data_prescription("double_gauss_100mm_f2.0");
  for (auto& surface : p.surfaces) surface.stop = false;
  expect_error([&] { with_iris(compile(p), {.blades = 6}); }, {p.name, "iris", "surface"});
  const Lens open = with_any_semi_diameter(lens, 0, std::numeric_limits<double>::infinity());
  expect_error([&] { with_iris(open, {.blades = 6}); }, {"front stop", "iris", "surface 0", "stop", "is unlimited"});
  const auto refusal = [&](const Iris& iris) { return message([&] { with_iris(lens, iris); }); };
  expect_tokens(refusal({.blades = 2}), {"front stop", "iris", "blades", 2});
  expect_tokens(refusal({.blades = 21}), {"front stop", "iris", "blades", 21});
  expect_tokens(refusal({.blades = 6, .roundness = 1.1}), {"front stop", "iris", "roundness", 1.1});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_tokens(refusal({.roundness = nan}), {"front stop", "iris", "roundness", "nan"});
  expect_tokens(refusal({.blades = 6, .rotation_rad = nan}), {"front stop", "iris", "rotation_rad", "nan"});
  const Lens bladed = with_iris(lens, {.blades = 6});
  expect_error([&] { with_semi_diameter(bladed, 0, std::numeric_limits<double>::infinity()); },
               {"front stop", "surface 0", "semi_diameter", "inf"});
}

TEST(Iris, KeepsItsShapeWhenTheLensIsStoppedDown) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const Lens bladed = with_iris(lens, {.blades = 6});
  EXPECT_TRUE(lens.rotationally_symmetric());
  EXPECT_FALSE(bladed.rotationally_symmetric());
  for (const double f_number : {2.8, 5.6, 22.0}) {
    const Lens stopped = with_f_number(bladed, f_number);
    EXPECT_NEAR(real_f_number(stopped), f_number, 1e-11);
    const double radius = stopped.surfaces()[*stopped.stop()].semi_diameter;
    EXPECT_EQ(radius, with_f_number(lens, f_number).surfaces()[*lens.stop()].semi_diameter);
    // Rays along the axis from the stop outwards, towards an edge and towards a corner.
    const auto passes = [&](double angle, double part) {
      const double height = 100 / (2 * f_number) * part;
      return trace(stopped, Ray<double>{{height * std::cos(angle), height * std::sin(angle), -1}, {0, 0, 1}})
          .transmitted();
    };
    EXPECT_TRUE(passes(0, 0.8) && passes(std::numbers::pi / 6, 0.9)) << f_number;
    EXPECT_FALSE(passes(0, 0.92)) << f_number;
  }
}

TEST(Iris, EmptyIrisRestoresTheRoundLens) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const Lens round = with_iris(with_iris(lens, {.blades = 6}), {});
  EXPECT_TRUE(round.iris().round());
  EXPECT_TRUE(round.rotationally_symmetric());
  for (int i = -20; i <= 20; ++i) {
    const Ray<double> ray{{0.7 * i, 1.1 * i, -10}, {0, 0, 1}};
    const auto a = trace(lens, ray), b = trace(round, ray);
    EXPECT_EQ(a.ray.origin, b.ray.origin);
    EXPECT_EQ(a.ray.direction, b.ray.direction);
    EXPECT_EQ(a.fate, b.fate);
  }
}

TEST(Lens, MovedFromLensStaysValid) {
  Lens lens = testing::front_stop_lens();
  const Lens moved = std::move(lens);
  EXPECT_EQ(lens.name(), "front stop");  // NOLINT: what the test is about
  Lens assigned = testing::front_stop_lens(3);
  assigned = std::move(lens);
  EXPECT_EQ(lens.surfaces().data(), assigned.surfaces().data());  // NOLINT
  EXPECT_EQ(moved.surfaces().data(), assigned.surfaces().data());
}

}  // namespace iris_test
}  // namespace petzval
