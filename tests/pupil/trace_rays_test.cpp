// SPDX-License-Identifier: Apache-2.0
#include "pupil/trace_rays.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "../data_lenses.hpp"
#include "core/meet_plane.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_nodes.hpp"

namespace petzval::pupil_detail {
namespace trace_rays_test {

using testing::data_lens;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// 1500 rays parallel to the axis in a spiral that is wider than the lens.
struct Spiral {
  static constexpr std::size_t count = 1500;
  double radius;

  Ray<double> at(std::size_t i) const {
    const double r = radius * std::sqrt((static_cast<double>(i) + 0.5) / count), angle = 2.4 * static_cast<double>(i);
    return {{r * std::cos(angle), r * std::sin(angle), -10}, {0, 0, 1}};
  }
  std::size_t operator()(std::size_t begin, std::size_t end, const RayArrays<double>& rays) const {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [o, d] = at(i);
      rays.x[i - begin] = o.x, rays.y[i - begin] = o.y, rays.z[i - begin] = o.z;
      rays.dx[i - begin] = d.x, rays.dy[i - begin] = d.y, rays.dz[i - begin] = d.z;
    }
    return end - begin;
  }
};

TEST(TraceRays, KeepsSlopesAndWeightsOfTransmittedRays) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const Spiral spiral{60};
  std::vector<double> weights(Spiral::count);
  std::iota(weights.begin(), weights.end(), 0.0);
  for (const int threads : {1, 3}) {
    const RayBundle bundle = trace_rays(lens, 80, Spiral::count, {.weights = weights, .threads = threads}, spiral);
    EXPECT_EQ(bundle.plane_z, 80);
    EXPECT_EQ(bundle.sent, Spiral::count);
    std::size_t next = 0;
    for (std::size_t i = 0; i < Spiral::count; ++i) {
      const auto end = trace(lens, spiral.at(i));
      if (!end.transmitted()) continue;
      const auto line = core_detail::slope_ray(end.ray, 80.0);
      ASSERT_LT(next, bundle.size());
      EXPECT_EQ(bundle.weights[next], static_cast<double>(i));
      EXPECT_EQ(bundle.x[next], line.x);
      EXPECT_EQ(bundle.y[next], line.y);
      EXPECT_EQ(bundle.slope_x[next], line.slope_x);
      EXPECT_EQ(bundle.slope_y[next], line.slope_y);
      ++next;
    }
    EXPECT_EQ(next, bundle.size());
    EXPECT_GT(next, Spiral::count / 10);
    EXPECT_LT(next, Spiral::count);
  }
}

TEST(TraceRays, SlopesDoNotChangeTheHits) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const RayBundle with = trace_rays(lens, 80, Spiral::count, {}, Spiral{30});
  const RayBundle without = trace_rays(lens, 80, Spiral::count, {.slopes = false}, Spiral{30});
  ASSERT_EQ(with.size(), without.size());
  EXPECT_TRUE(without.slope_x.empty() && without.weights.empty());
  for (std::size_t i = 0; i < with.size(); ++i) EXPECT_NEAR(with.x[i], without.x[i], 1e-12);
}

TEST(TraceRays, AcceptsFewerRaysThanRequested) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const Spiral spiral{10};
  const auto every_third = [&](std::size_t begin, std::size_t end, const RayArrays<double>& rays) {
    std::size_t started = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (i % 3 != 0) continue;
      spiral(i, i + 1,
             {rays.x + started, rays.y + started, rays.z + started, rays.dx + started, rays.dy + started,
              rays.dz + started});
      ++started;
    }
    return started;
  };
  const RayBundle all = trace_rays(lens, 80, Spiral::count, {}, spiral);
  const RayBundle some = trace_rays(lens, 80, Spiral::count, {}, every_third);
  ASSERT_EQ(all.size(), Spiral::count);
  ASSERT_EQ(some.size(), Spiral::count / 3);
  for (std::size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some.x[i], all.x[3 * i]);
}

TEST(TraceNodes, WeightsSumToTheAreaOfThePupil) {
  for (const double field_deg : {0.0, 10.0, 21.0}) {
    const Lens lens = data_lens("double_gauss_100mm_f1.35");
    const PupilBoundary boundary = pupil_boundary(lens, {radians(field_deg), -infinity}, 0, 96);
    const RayBundle bundle = trace_nodes(lens, boundary, lens.film_z());
    const double sum = std::accumulate(bundle.weights.begin(), bundle.weights.end(), 0.0);
    EXPECT_EQ(bundle.size(), bundle.sent);
    EXPECT_NEAR(sum * std::numbers::pi / 96, boundary.area(), 1e-9 * boundary.area());
  }
}

TEST(TraceRim, EnclosesTheNodes) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const PupilBoundary boundary = pupil_boundary(lens, {radians(15), -infinity}, 0, 96);
  // Far behind the image the hits have the shape of the pupil.
  const double plane_z = lens.film_z() + 1000;
  const RayBundle nodes = trace_nodes(lens, boundary, plane_z), rim = trace_rim(lens, boundary, plane_z);
  EXPECT_GT(rim.size(), 2 * boundary.spans.size());  // with the corners
  for (const double weight : rim.weights) EXPECT_EQ(weight, 0);
  const auto widest = [](const std::vector<double>& v) {
    const auto [least, most] = std::minmax_element(v.begin(), v.end());
    return *most - *least;
  };
  EXPECT_GT(widest(rim.x), widest(nodes.x));
  EXPECT_GT(widest(rim.y), widest(nodes.y));
}

TEST(MeetFilm, RayAwayFromTheFilmHasNoHit) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const auto hit = meet_film(lens, {{0, 1, lens.film_z() - 10}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->y, 1);
  EXPECT_FALSE(meet_film(lens, {{0, 1, 0}, {0, 0, -1}}));
  EXPECT_FALSE(meet_film(lens, {{0, 1, 0}, {0, 1, 0}}));
}

TEST(TraceRim, CornersLieWhereRimsMeet) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const FieldPoint point{radians(15), -infinity};
  const double plane_z = lens.film_z() + 1000;
  const auto limited_by = [](const PupilBoundary& boundary, std::size_t k) {
    return boundary.spans[k % boundary.spans.size()].to.surface;
  };
  const PupilBoundary fine = pupil_boundary(lens, point, 0, 2048);
  PupilBoundary boundary = pupil_boundary(lens, point, 0, 32);
  // A read beyond the last span would reach this span of another rim and add a corner.
  PupilSpan beyond;
  beyond.to.surface = 1000;
  boundary.spans.push_back(beyond);
  boundary.spans.pop_back();
  std::size_t corners = 0;
  for (std::size_t k = 0; k < 32; ++k) corners += limited_by(boundary, k) != limited_by(boundary, k + 1);
  ASSERT_GE(corners, 2u);
  const RayBundle rim = trace_rim(lens, boundary, plane_z), near = trace_rim(lens, fine, plane_z);
  ASSERT_EQ(rim.size(), 2 * boundary.spans.size() + corners);
  // Each corner lies between two of the 2048 directions that are limited by different rims.
  for (std::size_t i = rim.size() - corners; i < rim.size(); ++i) {
    std::size_t nearest = 0;
    double least = infinity;
    for (std::size_t k = 0; k < fine.spans.size(); ++k) {
      const double away = std::hypot(near.x[2 * k + 1] - rim.x[i], near.y[2 * k + 1] - rim.y[i]);
      if (away < least) least = away, nearest = k + fine.spans.size();
    }
    EXPECT_NE(limited_by(fine, nearest - 1), limited_by(fine, nearest + 1)) << i;
  }
}

}  // namespace trace_rays_test
}  // namespace petzval::pupil_detail
