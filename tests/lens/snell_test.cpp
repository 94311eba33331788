// SPDX-License-Identifier: Apache-2.0
#include "lens/snell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

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

TEST(Snell, AtTheCriticalAngleTheRayIsTangential) {
  // sin = 4/5, cos = 3/5 at n/n' = 5/4: every step is exact.
  const Interface<double> interface { 1.25, -0.5625 };
  const auto [t, transmitted] = refract(Vec<double>{0.8, 0, 0.6}, Vec<double>{0, 0, 1}, interface);
  EXPECT_TRUE(transmitted);
  EXPECT_NEAR(t.x, 1, 1e-15);
  EXPECT_NEAR(t.z, 0, 1e-15);
}

}  // namespace snell_test
