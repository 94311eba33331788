// SPDX-License-Identifier: Apache-2.0
#include "pupil/ray_bundle.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/sobol.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace ray_bundle_test {

using testing::data_lens;
using testing::expect_error;

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(TraceBundle, IsEmptyForAnEmptyPupil) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const RayBundle hits = trace_bundle(lens, PupilSampler(pupil_boundary(lens, {radians(60), -infinity})), 1000);
  EXPECT_EQ(hits.sent, 1000u);
  EXPECT_TRUE(hits.x.empty());
  EXPECT_EQ(hits.transmitted_area(), 0);
}

TEST(TraceBundle, RefusesPupilsOfOtherWavelengths) {
  const Lens one = data_lens("double_gauss_100mm_f2.0");
  const Lens three = compile(testing::data_prescription("double_gauss_100mm_f2.0"), std::array{450.0, 550.0, 650.0},
                             {.missing_glass = MissingGlass::abbe});
  const PupilSampler pupil(pupil_boundary(three, {.z = -1500}, 2));
  EXPECT_FALSE(trace_bundle(three, pupil, 100).empty());
  expect_error([&] { trace_bundle(one, pupil, 100); }, {one.name(), "wavelength", 2});
}

TEST(TraceBundle, HitsEqualSingleRays) {
  const Lens lens = data_lens("catadioptric_mangin_1000mm_f7.5");
  const PupilSampler pupil(pupil_boundary(lens, {radians(0.5), -infinity}));
  const RayBundle hits = trace_bundle(lens, pupil, 500, 8);
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const auto uv = owen_sobol(i, 8);
    const double u = uv.x, v = uv.y;
    const Vec2<double> p = pupil(u, v);
    const auto end = trace(lens, pupil.plane().ray(p.x, p.y));
    if (!end.transmitted()) continue;
    const double t = (lens.film_z() - end.ray.origin.z) / end.ray.direction.z;
    ASSERT_LT(next, hits.x.size());
    EXPECT_NEAR(hits.x[next], end.ray.origin.x + t * end.ray.direction.x, 1e-12);
    EXPECT_NEAR(hits.y[next], end.ray.origin.y + t * end.ray.direction.y, 1e-12);
    ++next;
  }
  EXPECT_EQ(next, hits.x.size());
}

}  // namespace ray_bundle_test
}  // namespace petzval
