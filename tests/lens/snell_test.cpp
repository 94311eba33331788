// SPDX-License-Identifier: Apache-2.0
#include "lens/snell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "../report.hpp"
#include "quad.hpp"

namespace snell_test {

using petzval::kernel::Interface;
using petzval::kernel::make_interface;
using petzval::kernel::Vec;

template <class R>
QuadVec exact(const Vec<R>& v) {
  return {static_cast<Quad>(v.x), static_cast<Quad>(v.y), static_cast<Quad>(v.z)};
}

/// Snell's law in 113 bits: the tangential part scaled by n/n', the rest along the normal.
QuadVec refracted(const QuadVec& d, const QuadVec& normal, Quad n_in, Quad n_out, Quad& cos_out) {
  const Quad cosine = inner(d, normal);
  const QuadVec across = along(d, normal, -cosine);
  const Quad mu = n_in / n_out, s = 1 - mu * mu * inner(across, across);
  cos_out = s > 0 ? root(s) : 0;
  const QuadVec part{mu * across.x, mu * across.y, mu * across.z};
  return along(part, normal, cosine < 0 ? -cos_out : cos_out);
}

struct Case {
  double n_in, n_out;
};

template <class R>
struct Sampler {
  std::mt19937 random{3};
  std::normal_distribution<double> gauss;

  Vec<R> unit_vector() {
    const double x = gauss(random), y = gauss(random), z = gauss(random), l = std::sqrt(x * x + y * y + z * z);
    return {static_cast<R>(x / l), static_cast<R>(y / l), static_cast<R>(z / l)};
  }
};

template <class T>
class SnellOf : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(SnellOf, Plain);

TYPED_TEST(SnellOf, DirectionIsWithinFourEpsOverTheCosine) {
  constexpr double eps = std::numeric_limits<TypeParam>::epsilon();
  Sampler<TypeParam> sampler;
  double most = 0;
  for (const auto& [n_in, n_out] : {Case{1, 1.5},
                                    {1.5, 1},
                                    {1, 4},
                                    {4, 1},
                                    {1.5, 1.501},
                                    {1.5, 1.5 + 1e-6},
                                    {1.5, 1.5 + 1e-9},
                                    {1.5 + 1e-12, 1.5},
                                    {0.7, 1.3}}) {
    const auto interface = make_interface<TypeParam>(n_in, n_out);
    for (int i = 0; i < 3000; ++i) {
      const Vec<TypeParam> d = sampler.unit_vector(), n = sampler.unit_vector();
      const auto [t, transmitted] = refract(d, n, interface);
      Quad cos_out = 0;
      const QuadVec wanted = refracted(unit(exact(d)), unit(exact(n)), n_in, n_out, cos_out);
      if (cos_out < 1e-3) continue;  // near the critical angle rounding decides the fate
      ASSERT_TRUE(transmitted);
      const QuadVec off{t.x - wanted.x, t.y - wanted.y, t.z - wanted.z};
      // cos t' = sqrt(1 - (n sin t / n')^2): rounding errors of the ray grow by (n/n')^2 / cos t'.
      const double mu = n_in / n_out, condition = static_cast<double>(cos_out) / std::max(1.0, mu * mu);
      most = std::max(most, static_cast<double>(root(inner(off, off))) * condition / eps);
    }
  }
  EXPECT_LE(most, 4);
  testing_report::put("refraction, x cos(refraction)", testing_report::one_ray<TypeParam>, most, "4 eps");
}

TYPED_TEST(SnellOf, DirectionHasUnitLength) {
  constexpr double eps = std::numeric_limits<TypeParam>::epsilon();
  Sampler<TypeParam> sampler;
  for (const auto& [n_in, n_out] : {Case{1, 1.5}, {1.5, 1}, {1, 4}, {1.5, 1.5 + 1e-9}}) {
    const auto interface = make_interface<TypeParam>(n_in, n_out);
    for (int i = 0; i < 3000; ++i) {
      const Vec<TypeParam> d = sampler.unit_vector(), n = sampler.unit_vector();
      const auto [t, transmitted] = refract(d, n, interface);
      if (transmitted) {
        EXPECT_NEAR(static_cast<double>(root(inner(exact(t), exact(t)))), 1, 2 * eps) << "ray " << i;
      }
      const auto mirrored = reflect(d, n);
      EXPECT_NEAR(static_cast<double>(root(inner(exact(mirrored), exact(mirrored)))), 1, 2 * eps) << "ray " << i;
    }
  }
}

TYPED_TEST(SnellOf, LengthErrorsAreCorrectedWithin1000Surfaces) {
  const TypeParam eps = std::numeric_limits<TypeParam>::epsilon();
  Sampler<TypeParam> sampler;
  const auto in = make_interface<TypeParam>(1, 1.7), out = make_interface<TypeParam>(1.7, 1);
  Vec<TypeParam> d{0, 0, 1};
  for (int i = 0; i < 1000; ++i) {
    const auto n = sampler.unit_vector();
    const auto [t, transmitted] = refract(d, n, i % 2 ? out : in);
    d = transmitted ? t : reflect(d, n);
    ASSERT_NEAR(static_cast<double>(dot(d, d)), 1, 8 * static_cast<double>(eps)) << "surface " << i;
  }
}

TYPED_TEST(SnellOf, RefractionIsReversible) {
  const double eps = std::numeric_limits<TypeParam>::epsilon();
  Sampler<TypeParam> sampler;
  const auto in = make_interface<TypeParam>(1, 1.7), out = make_interface<TypeParam>(1.7, 1);
  for (int i = 0; i < 3000; ++i) {
    const Vec<TypeParam> d = sampler.unit_vector(), n = sampler.unit_vector();
    const double cosine = std::abs(static_cast<double>(dot(d, n)));
    if (cosine < 0.05) continue;
    const auto inside = refract(d, n, in).direction;
    const auto [back, transmitted] = refract(inside * TypeParam(-1), n, out);
    ASSERT_TRUE(transmitted);
    for (const TypeParam off : {back.x + d.x, back.y + d.y, back.z + d.z})
      EXPECT_NEAR(static_cast<double>(off), 0, 6 * eps / cosine);
  }
}

TYPED_TEST(SnellOf, SignOfTheNormalIsIrrelevant) {
  Sampler<TypeParam> sampler;
  for (int i = 0; i < 1000; ++i) {
    const Vec<TypeParam> d = sampler.unit_vector(), n = sampler.unit_vector();
    const auto interface = make_interface<TypeParam>(1.5, 1);
    const auto a = refract(d, n, interface), b = refract(d, n * TypeParam(-1), interface);
    EXPECT_EQ(a.transmitted, b.transmitted);
    EXPECT_EQ(a.direction.x, b.direction.x);
    EXPECT_EQ(a.direction.z, b.direction.z);
  }
}

TEST(Snell, TotalReflectionIsCorrectWithinABillionthOfTheCriticalAngle) {
  const auto interface = make_interface<double>(1.5, 1);
  const double critical = std::asin(1 / 1.5);
  for (const double off : {1e-9, -1e-9}) {
    const double angle = critical + off;
    const auto [t, transmitted] =
        refract(Vec<double>{std::sin(angle), 0, std::cos(angle)}, Vec<double>{0, 0, 1}, interface);
    EXPECT_EQ(transmitted, off < 0);
    EXPECT_TRUE(std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z));
  }
}

TEST(Snell, AtTheCriticalAngleTheRayIsTangential) {
  // sin = 4/5, cos = 3/5 at n/n' = 5/4: every step is exact.
  const Interface<double> interface { 1.25, -0.5625 };
  const auto [t, transmitted] = refract(Vec<double>{0.8, 0, 0.6}, Vec<double>{0, 0, 1}, interface);
  EXPECT_TRUE(transmitted);
  EXPECT_NEAR(t.x, 1, 1e-15);
  EXPECT_NEAR(t.z, 0, 1e-15);
}

TEST(Snell, ReflectionReversesTheNormalComponentOnly) {
  Sampler<double> sampler;
  for (int i = 0; i < 1000; ++i) {
    const auto d = sampler.unit_vector(), n = sampler.unit_vector();
    const auto r = reflect(d, n);
    EXPECT_NEAR(dot(r, n), -dot(d, n), 1e-15);
    const auto across = d - n * dot(d, n), across_after = r - n * dot(r, n);
    EXPECT_NEAR(across.x, across_after.x, 1e-15);
    EXPECT_NEAR(across.y, across_after.y, 1e-15);
  }
}

}  // namespace snell_test
