// SPDX-License-Identifier: Apache-2.0
#include "pupil/pupil_boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "../data_lenses.hpp"
#include "../digits.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace pupil_sampler_test {

using testing::data_lens;
using testing::data_prescriptions;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

/// Angle from +y (0 to 2 pi) and radius of a point, in units of the boundary.
std::pair<double, double> polar(const PupilBoundary& boundary, const Vec2<double>& p) {
  const double x = (p[0] - boundary.middle[0]) / boundary.half_axes[0];
  const double y = (p[1] - boundary.middle[1]) / boundary.half_axes[1];
  const double angle = std::atan2(x, y);
  return {angle < 0 ? angle + 2 * pi : angle, std::hypot(x, y)};
}

TEST(PupilSampler, MostRaysPass) {
  double worst = 1;
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    for (const double part : {0.0, 0.6, 0.9, 1.0}) {
      const PupilBoundary boundary = pupil_boundary(lens, {radians(part * p.half_field_deg.value_or(10)), -infinity});
      if (boundary.empty()) continue;
      const PupilSampler sampler(boundary);
      constexpr int side = 24;
      int passed = 0;
      for (int i = 0; i < side * side; ++i) {
        const Vec2<double> at = sampler((i % side + 0.5) / side, (i / side + 0.5) / side);
        passed += trace(lens, sampler.plane().ray(at.x, at.y)).transmitted();
      }
      EXPECT_GE(passed, 0.96 * side * side) << part;
      EXPECT_GE(boundary.area() / sampler.area(), 0.97) << part;
      worst = std::min(worst, boundary.area() / sampler.area());
    }
  }
  RecordProperty("share", testing::digits(worst, 4));
}

TEST(PupilSampler, CoversThePupil) {
  // Edges of a boundary with eight times as many directions lie within the sampled region.
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    for (const double part : {0.7, 1.0}) {
      const FieldPoint point{radians(part * p.half_field_deg.value_or(10)), -infinity};
      const PupilBoundary boundary = pupil_boundary(lens, point);
      if (boundary.empty()) continue;
      const PupilSampler sampler(boundary);
      struct Bound {
        double angle, inner, outer;
      };
      std::vector<Bound> bounds;
      constexpr int many = 20000;
      for (int i = 0; i < many; ++i) {
        const double u = (i + 0.5) / many;
        const auto [angle, inner] = polar(boundary, sampler(u, 0));
        const auto [same, outer] = polar(boundary, sampler(u, 1 - 1e-16));
        bounds.push_back({outer > inner + 1e-9 ? same : angle, inner, outer});
      }
      std::sort(bounds.begin(), bounds.end(), [](const Bound& a, const Bound& b) { return a.angle < b.angle; });
      for (const PupilSpan& span : pupil_boundary(lens, point, 0, 2048).spans) {
        for (const RimPoint& edge : {span.from, span.to}) {
          if (edge.surface < 0) continue;
          const auto [angle, radius] = polar(boundary, {edge.x, edge.y});
          auto bound = std::lower_bound(bounds.begin(), bounds.end(), angle,
                                        [](const Bound& b, double a) { return b.angle < a; });
          if (bound == bounds.end()) --bound;
          ASSERT_LE(radius, bound->outer) << part << " at " << angle;
          ASSERT_GE(radius, bound->inner - 1e-12) << part << " at " << angle;
        }
      }
    }
  }
}

TEST(PupilSampler, WritesAsManyPointsAsTheShortestSpanHolds) {
  const PupilSampler sampler(pupil_boundary(data_lens("double_gauss_100mm_f1.35"), {0, -1000}));
  const std::vector<double> u(100, 0.25), v(100, 0.5);
  const Vec2<double> p = sampler(0.25, 0.5);
  std::vector<double> x(100, -1), y(100, -1);
  const auto sample = [&](std::size_t of_u, std::size_t of_v, std::size_t of_x, std::size_t of_y) {
    std::fill(x.begin(), x.end(), -1), std::fill(y.begin(), y.end(), -1);
    sampler(std::span(u).first(of_u), std::span(v).first(of_v), std::span(x).first(of_x), std::span(y).first(of_y));
  };
  for (int shortest = 0; shortest < 4; ++shortest) {
    const auto size = [&](int span) -> std::size_t { return span == shortest ? 70 : 100; };
    sample(size(0), size(1), size(2), size(3));
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ((Vec2<double>(x[i], y[i])), i < 70 ? p : Vec2<double>(-1, -1));
  }
}

TEST(PupilSampler, AngleFollowsUAndAreaFollowsV) {
  // On a disc, u is the angle from half a direction after +y, and v is the fraction of the area within the radius.
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  for (const int directions : {1, 3, 50, 256}) {
    const PupilSampler sampler(pupil_boundary(lens, {0, -infinity}, 0, static_cast<std::size_t>(directions)));
    const double radius = std::sqrt(sampler.area() / pi), start = pi / directions;
    for (int i = 0; i < 1000; ++i) {
      const double u = i / 1000.0, v = (i * 37 % 1000) / 1000.0;
      const Vec2<double> p = sampler(u, v);
      // The traced edge is a circle up to 2e-13 half axes.
      EXPECT_NEAR(p.x, radius * std::sqrt(v) * std::sin(2 * pi * u + start), 2e-12 * radius) << directions;
      EXPECT_NEAR(p.y, radius * std::sqrt(v) * std::cos(2 * pi * u + start), 2e-12 * radius) << directions;
    }
  }
}

}  // namespace pupil_sampler_test
}  // namespace petzval
