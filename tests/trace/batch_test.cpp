// SPDX-License-Identifier: Apache-2.0
// The slots of a batch: the result of a ray does not depend on its neighbours.
#include "petzval/trace/trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "batches.hpp"

namespace batch_test {

using namespace testing_batches;
using petzval::TracedRay;

template <class T>
class BatchOf : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(BatchOf, Plain);

constexpr Travel both_ways[] = {Travel::to_film, Travel::to_scene};

int first_met(const Lens& lens, Travel travel) {
  return travel == Travel::to_film ? 0 : static_cast<int>(lens.surface_count()) - 1;
}

/// An invalid ray: not finite, or with a direction not of unit length.
template <class T>
bool refused(const Ray<T>& ray) {
  double length = 0;
  for (int k = 0; k < 3; ++k) length += std::pow(static_cast<double>(ray.direction[k]), 2);
  return !finite(ray) || !(std::abs(length - 1) < petzval::unit_direction_tolerance);
}

/// Rays that miss every lens.
template <class T>
std::vector<Ray<T>> absurd_rays() {
  constexpr auto limits = std::numeric_limits<T>();
  std::vector<Ray<T>> rays;
  for (const T bad : {limits.quiet_NaN(), limits.infinity(), -limits.infinity(), limits.max(), -limits.max(),
                      limits.denorm_min(), limits.min()}) {
    for (int k = 0; k < 6; ++k) {
      Ray<T> ray{{T(0.5), T(-0.25), -9}, {T(0.0625), T(0), 1}};
      (k < 3 ? ray.origin[k] : ray.direction[k - 3]) = bad;
      rays.push_back(ray);
    }
  }
  for (const T length : {T(0), T(0.5), T(1.1), T(1e6), limits.max()}) rays.push_back({{0, 1, -9}, {0, 0, length}});
  rays.push_back({{limits.quiet_NaN(), limits.quiet_NaN(), limits.quiet_NaN()},
                  {limits.quiet_NaN(), limits.quiet_NaN(), limits.quiet_NaN()}});
  return rays;
}

TEST(Batch, TestRaysHaveSeveralFatesOnEveryLens) {
  std::array<int, 4> fates{};
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      int passed = 0;
      for (const auto& ray : rays_for<double>(sample, travel, 256)) {
        const auto end = petzval::trace(sample.lens, ray, {.travel = travel});
        passed += end.transmitted();
        if (static_cast<std::size_t>(end.fate) < 4) ++fates[static_cast<std::size_t>(end.fate)];
      }
      EXPECT_GE(passed, 5) << sample.id << " " << text({.travel = travel});
    }
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_GE(fates[i], 50) << petzval::name(static_cast<RayFate>(i));
}

TYPED_TEST(BatchOf, BitsAreIndependentOfCountAndPosition) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const auto rays = rays_for<T>(sample, travel, 256);
      for (const BatchOptions& options : every_batch(travel)) {
        const Answer<T> whole = traced(sample.lens, rays, options);
        for (std::size_t count = 0; count < 130; ++count) {
          // Each count shifts the rays within the batch, in memory that is aligned to one element only.
          const std::size_t start = count * 37 % (rays.size() - count), shift = count % 4;
          const std::vector<Ray<T>> part(rays.begin() + static_cast<std::ptrdiff_t>(start),
                                         rays.begin() + static_cast<std::ptrdiff_t>(start + count));
          const Arrays<T> in(part, shift);
          Answer<T> answer{Arrays<T>(count, (shift + 1) % 4), std::vector<RayFate>(count + 2, RayFate{9}),
                           std::vector<int>(count + 2, -7)};
          petzval::trace<T>(sample.lens, count, in.in(), answer.rays.out(), answer.fates.data() + 1,
                            answer.surfaces.data() + 1, options);
          const std::string what = sample.id + " " + text(options) + " count " + std::to_string(count);
          ASSERT_TRUE(answer.rays.guards_hold()) << what;
          ASSERT_TRUE(answer.fates.front() == RayFate{9} && answer.fates.back() == RayFate{9}) << what;
          ASSERT_TRUE(answer.surfaces.front() == -7 && answer.surfaces.back() == -7) << what;
          for (std::size_t i = 0; i < count; ++i) {
            ASSERT_TRUE(same_bits(answer.rays[i], whole.rays[start + i]) &&
                        answer.fates[i + 1] == whole.fates[start + i] &&
                        answer.surfaces[i + 1] == whole.surfaces[start + i])
                << what << " ray " << i;
          }
        }
      }
    }
  }
}

TYPED_TEST(BatchOf, DirectionsWithinToleranceAreNormalised) {
  using T = TypeParam;
  const double corrected = std::max(4e-12, 20.0 * std::numeric_limits<T>::epsilon());
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const auto unit = rays_for<T>(sample, travel, 256);
      for (const double part : {-0.95, 0.95, -1.05, 1.05}) {
        auto rays = unit;
        for (Ray<T>& ray : rays) {
          ray.direction *= static_cast<T>(std::sqrt(1 + part * petzval::unit_direction_tolerance));
        }
        for (const BatchOptions& options : every_batch(travel)) {
          const Answer<T> wanted = traced(sample.lens, unit, options), found = traced(sample.lens, rays, options);
          int passed = 0, kept = 0;
          for (std::size_t i = 0; i < unit.size(); ++i) {
            if (wanted.fates[i] != RayFate::transmitted) continue;
            ++passed;
            if (found.fates[i] != RayFate::transmitted) continue;
            ++kept;
            const auto d = found.rays[i].direction;
            const double x = d.x, y = d.y, z = d.z;
            EXPECT_LE(std::abs(x * x + y * y + z * z - 1), corrected) << sample.id << " " << text(options);
          }
          // A few fates at rims differ.
          EXPECT_EQ(kept >= 0.95 * passed, std::abs(part) < 1)
              << sample.id << " " << text(options) << " " << part << ": " << kept << " of " << passed;
          EXPECT_EQ(std::abs(part) > 1 ? kept : 0, 0) << sample.id;
        }
      }
    }
  }
}

TYPED_TEST(BatchOf, ResultsMayReplaceRaysAndFatesAreOptional) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const auto rays = rays_for<T>(sample, travel, 100);
      for (const BatchOptions& options : every_batch(travel)) {
        const Answer<T> wanted = traced(sample.lens, rays, options);
        Arrays<T> both(rays, 1);
        std::vector<RayFate> fates(rays.size());
        std::vector<int> surfaces(rays.size());
        const auto in = both.in();
        petzval::trace<T>(sample.lens, rays.size(), in, both.out(), fates.data(), nullptr, options);
        EXPECT_TRUE(both.guards_hold());
        Arrays<T> bare(rays.size());
        petzval::trace<T>(sample.lens, rays.size(), Arrays<T>(rays).in(), bare.out(), nullptr, surfaces.data(),
                          options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          ASSERT_TRUE(same_bits(both[i], wanted.rays[i])) << what;
          ASSERT_TRUE(same_bits(bare[i], wanted.rays[i])) << what;
          ASSERT_EQ(fates[i], wanted.fates[i]) << what;
          ASSERT_EQ(surfaces[i], wanted.surfaces[i]) << what;
        }
      }
    }
  }
}

TYPED_TEST(BatchOf, ArrayOfStructuresHasEqualBits) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      auto rays = rays_for<T>(sample, travel, 131);
      for (const auto& ray : absurd_rays<T>()) rays.push_back(ray);
      for (const BatchOptions& options : every_batch(travel)) {
        const Answer<T> wanted = traced(sample.lens, rays, options);
        std::vector<TracedRay<T>> found(rays.size() + 1);
        found.back().surface = -7;
        petzval::trace<T>(sample.lens, rays, found.data(), options);
        EXPECT_EQ(found.back().surface, -7);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          ASSERT_TRUE(same_bits(found[i].ray, wanted.rays[i])) << what;
          ASSERT_EQ(found[i].fate, wanted.fates[i]) << what;
          ASSERT_EQ(found[i].surface, wanted.surfaces[i]) << what;
        }
      }
    }
  }
}

TYPED_TEST(BatchOf, LostRaysAreReturnedUnchanged) {
  using T = TypeParam;
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      auto rays = rays_for<T>(sample, travel, 256);
      for (const auto& ray : absurd_rays<T>()) rays.push_back(ray);
      for (const BatchOptions& options : every_batch(travel)) {
        const Answer<T> answer = traced(sample.lens, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const std::string what = sample.id + " " + text(options) + " ray " + std::to_string(i);
          ASSERT_TRUE(finite(answer.rays[i])) << what;
          ASSERT_TRUE(answer.surfaces[i] >= 0 && answer.surfaces[i] < static_cast<int>(sample.lens.surface_count()))
              << what;
          if (answer.fates[i] == RayFate::transmitted) continue;
          if (finite(rays[i])) {
            ASSERT_TRUE(same_bits(answer.rays[i], rays[i])) << what;
          } else {  // the default ray: origin 0 along the axis
            ASSERT_EQ(answer.rays[i].origin, petzval::Vec3<T>(0, 0, 0)) << what;
            ASSERT_EQ(answer.rays[i].direction * answer.rays[i].direction, petzval::Vec3<T>(0, 0, 1)) << what;
          }
        }
      }
    }
  }
}

TYPED_TEST(BatchOf, InvalidRaysAreMissesAndDoNotChangeOtherLanes) {
  using T = TypeParam;
  const auto absurd = absurd_rays<T>();
  for (const auto& sample : telling()) {
    for (const Travel travel : both_ways) {
      const auto rays = rays_for<T>(sample, travel, 129);
      for (const BatchOptions& options : every_batch(travel)) {
        const Answer<T> wanted = traced(sample.lens, rays, options);
        for (std::size_t lane = 0; lane < rays.size(); lane += lane < 20 ? 1 : 9) {
          auto poisoned = rays;
          const Ray<T>& bad = absurd[(lane * 11 + sample.id.size()) % absurd.size()];
          poisoned[lane] = bad;
          const Answer<T> answer = traced(sample.lens, poisoned, options);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            if (i == lane) continue;
            ASSERT_TRUE(same_bits(answer, i, wanted, i))
                << sample.id << " " << text(options) << " ray " << i << " next to an invalid ray in lane " << lane;
          }
          if (refused(bad)) {
            EXPECT_EQ(answer.fates[lane], RayFate::missed_surface) << text(options) << " lane " << lane;
            EXPECT_EQ(answer.surfaces[lane], first_met(sample.lens, travel)) << text(options) << " lane " << lane;
          }
        }
      }
    }
  }
}

TEST(Batch, EmptyBatchNeedsNoArrays) {
  const auto lens = testing_lenses::load("ball_10mm").lens;
  for (const BatchOptions& options : every_batch()) {
    petzval::trace<double>(lens, 0, {}, {}, nullptr, nullptr, options);
    petzval::trace<float>(lens, {}, nullptr, options);
  }
}

}  // namespace batch_test
