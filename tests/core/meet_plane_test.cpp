// SPDX-License-Identifier: Apache-2.0
#include "core/meet_plane.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <type_traits>

namespace petzval::core_detail {
namespace meet_plane_test {

template <class T>
class MeetPlane : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(MeetPlane, Scalars);

template <class T>
Ray<T> random_ray(std::mt19937& random) {
  std::uniform_real_distribution<T> unit(-1, 1);
  const Vec3<T> origin(20 * unit(random), 20 * unit(random), 50 * unit(random));
  const Vec3<T> direction(unit(random), unit(random), 1 + unit(random) / 2);
  return {origin, glm::normalize(direction)};
}

TYPED_TEST(MeetPlane, PointsLieInThePlaneAndOnTheRay) {
  using T = TypeParam;
  std::mt19937 random(1);
  std::uniform_real_distribution<T> unit(-1, 1);
  const T tolerance = std::is_same_v<T, float> ? T(2e-4) : T(1e-12);
  for (int i = 0; i < 1000; ++i) {
    const Ray<T> ray = random_ray<T>(random);
    const Vec3<T> point(unit(random), unit(random), 100 * unit(random));
    const Vec3<T> normal = glm::normalize(Vec3<T>(unit(random) / 2, unit(random) / 2, 1));
    if (glm::dot(ray.direction, normal) < T(0.1)) continue;
    for (const Vec3<T>& hit : {meet_plane(ray, point.z), meet_plane(ray, point, normal)}) {
      const Vec3<T> from = hit - ray.origin;
      EXPECT_NEAR(glm::length(from - ray.direction * glm::dot(from, ray.direction)), 0, tolerance);
    }
    EXPECT_EQ(meet_plane(ray, point.z).z, point.z);
    EXPECT_NEAR(glm::dot(meet_plane(ray, point, normal) - point, normal), 0, tolerance);
  }
}

TYPED_TEST(MeetPlane, SlopesGiveEqualPoints) {
  using T = TypeParam;
  std::mt19937 random(2);
  const T tolerance = std::is_same_v<T, float> ? T(2e-4) : T(1e-12);
  for (int i = 0; i < 1000; ++i) {
    const Ray<T> ray = random_ray<T>(random);
    const Vec3<T> near = meet_plane(ray, T(10)), far = meet_plane(ray, T(60));
    const SlopeRay<T> line = slope_ray(ray, T(10)), moved = line.moved(50);
    EXPECT_NEAR(line.x, near.x, tolerance);
    EXPECT_NEAR(line.y, near.y, tolerance);
    EXPECT_NEAR(moved.x, far.x, tolerance);
    EXPECT_NEAR(moved.y, far.y, tolerance);
  }
}

TEST(MeetPlaneAlong, IsNotFiniteForARayAlongThePlane) {
  const Ray<double> ray{{1, 2, 3}, {0, 1, 0}};
  EXPECT_FALSE(std::isfinite(meet_plane(ray, 5.0).y));
  EXPECT_FALSE(std::isfinite(slope_ray(ray).slope_y));
  EXPECT_FALSE(std::isfinite(meet_plane(ray, {0, 0, 5}, {0, 0, 1}).y));
}

TEST(RayAt, ReadsOneRayOfArrays) {
  const std::array<double, 12> v{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const RayArrays<const double> rays{&v[0], &v[2], &v[4], &v[6], &v[8], &v[10]};
  const Ray<double> ray = ray_at(rays, 1);
  EXPECT_EQ(ray.origin, Vec3<double>(1, 3, 5));
  EXPECT_EQ(ray.direction, Vec3<double>(7, 9, 11));
}

}  // namespace meet_plane_test
}  // namespace petzval::core_detail
