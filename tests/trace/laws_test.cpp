// SPDX-License-Identifier: Apache-2.0
// Laws that hold for every ray through every lens.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../report.hpp"
#include "lenses.hpp"

namespace laws_test {

using petzval::Ray;
using petzval::TracedRay;
using petzval::Travel;
using petzval::Vec3;
using testing_lenses::all;
using testing_lenses::passing_rays;
using testing_lenses::Sample;

template <class T>
Ray<T> converted(const Ray<double>& r) {
  return {Vec3<T>(r.origin), Vec3<T>(r.direction)};
}

double length(const Vec3<double>& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

template <class T>
double distance(const Vec3<T>& a, const Vec3<T>& b) {
  return length(Vec3<double>(a) - Vec3<double>(b));
}

/// The first hit of a ray that passes.
template <class T>
Vec3<T> first_hit(const petzval::Lens& lens, const Ray<T>& ray) {
  Vec3<T> first{0, 0, 0};
  bool seen = false;
  petzval::kernel::trace(petzval::kernel::view<T>(lens), petzval::kernel::to_kernel(ray.origin),
                         petzval::kernel::to_kernel(ray.direction), {},
                         [&](int, const petzval::kernel::Vec<T>& p, const petzval::kernel::Vec<T>&) {
                           if (!seen) first = petzval::kernel::to_public(p);
                           seen = true;
                         });
  return first;
}

template <class T>
void same_bits(const TracedRay<T>& a, const TracedRay<T>& b, const std::string& what) {
  EXPECT_EQ(a.fate, b.fate) << what;
  EXPECT_EQ(a.surface, b.surface) << what;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(a.ray.origin[i], b.ray.origin[i]) << what;
    EXPECT_EQ(a.ray.direction[i], b.ray.direction[i]) << what;
  }
}

TEST(Laws, EveryLensTransmitsRays) {
  EXPECT_GE(all().size(), 70u);
  for (const Sample& s : all()) EXPECT_GE(passing_rays(s.lens, 12).size(), 4u) << s.id;
}

template <class T>
class LawsOf : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(LawsOf, Plain);

// The lenses include mirrors, cylinders, aspheres and an eye with water in image space.
TYPED_TEST(LawsOf, ReversedRaysReturn) {
  using T = TypeParam;
  const double eps = std::numeric_limits<T>::epsilon();
  double place = 0, turn = 0;
  for (const Sample& s : all()) {
    for (const Ray<double>& in : passing_rays(s.lens, 12)) {
      const Ray<T> ray = converted<T>(in);
      const auto out = petzval::trace(s.lens, ray);
      if (!out.transmitted()) continue;  // at a rim, in float
      const auto back = petzval::trace(s.lens, Ray<T>{out.ray.origin, -out.ray.direction},
                                       {.travel = Travel::to_scene, .apertures = false});
      ASSERT_TRUE(back.transmitted()) << s.id;
      const double p = distance(back.ray.origin, first_hit(s.lens, ray)) / (eps * s.size);
      const double d = distance(back.ray.direction, -ray.direction) / eps;
      EXPECT_LE(p, 200) << s.id;
      EXPECT_LE(d, 20) << s.id;
      place = std::max(place, p);
      turn = std::max(turn, d);
    }
  }
  testing_report::put("reversed rays return, all 75 lenses, position", testing_report::one_ray<T>, place, "200 eps");
  testing_report::put("reversed rays return, all 75 lenses, direction", testing_report::one_ray<T>, turn, "20 eps");
}

TEST(Laws, ReversedLensEqualsReversedRays) {
  for (const Sample& s : all()) {
    if (std::any_of(s.prescription.surfaces.begin(), s.prescription.surfaces.end(),
                    [](const auto& r) { return r.mirror; }))
      continue;
    const petzval::Lens reversed = petzval::compile(petzval::reverse(s.prescription));
    const double end = s.lens.surfaces().back().vertex_z;
    for (const Ray<double>& in : passing_rays(s.lens, 6)) {
      const auto out = petzval::trace(s.lens, in);
      const Ray<double> turned{out.ray.origin, -out.ray.direction};
      const auto back = petzval::trace(s.lens, turned, {.travel = Travel::to_scene});
      const auto& [o, d] = turned;
      const auto there = petzval::trace(reversed, Ray<double>{{o.x, o.y, end - o.z}, {d.x, d.y, -d.z}});
      ASSERT_EQ(there.fate, back.fate) << s.id;
      const Vec3<double> place{there.ray.origin.x, there.ray.origin.y, end - there.ray.origin.z};
      const Vec3<double> direction{there.ray.direction.x, there.ray.direction.y, -there.ray.direction.z};
      const double eps = std::numeric_limits<double>::epsilon();
      EXPECT_LE(distance(place, back.ray.origin), 200 * eps * s.size) << s.id;
      EXPECT_LE(distance(direction, back.ray.direction), 20 * eps) << s.id;
    }
  }
}

TYPED_TEST(LawsOf, ScalingByAPowerOfTwoIsExact) {
  using T = TypeParam;
  for (const double factor : {0.25, 8.0}) {
    for (const Sample& s : all()) {
      const petzval::Lens scaled = petzval::compile(petzval::scale(s.prescription, factor));
      const T f = static_cast<T>(factor);
      for (const Ray<double>& in : passing_rays(s.lens, 6)) {
        const Ray<T> ray = converted<T>(in);
        auto wanted = petzval::trace(s.lens, ray);
        wanted.ray.origin *= f;
        same_bits(petzval::trace(scaled, Ray<T>{ray.origin * f, ray.direction}), wanted, s.id);
      }
    }
  }
}

TYPED_TEST(LawsOf, MirroredRaysAreExact) {
  using T = TypeParam;
  for (const Sample& s : all()) {
    for (const Ray<double>& in : passing_rays(s.lens, 6)) {
      const Ray<T> ray = converted<T>(in);
      for (const Vec3<T>& flip : {Vec3<T>{-1, 1, 1}, Vec3<T>{1, -1, 1}}) {
        auto wanted = petzval::trace(s.lens, ray);
        wanted.ray.origin *= flip;
        wanted.ray.direction *= flip;
        same_bits(petzval::trace(s.lens, Ray<T>{ray.origin * flip, ray.direction * flip}), wanted, s.id);
      }
    }
  }
}

TYPED_TEST(LawsOf, ScalingByAnyFactorIsWithinRounding) {
  using T = TypeParam;
  const double eps = std::numeric_limits<T>::epsilon();
  double most = 0;
  for (const Sample& s : all()) {
    const petzval::Lens scaled = petzval::compile(petzval::scale(s.prescription, 0.37));
    for (const Ray<double>& in : passing_rays(s.lens, 6)) {
      const Ray<T> ray = converted<T>(in);
      const auto wanted = petzval::trace(s.lens, ray);
      const auto found = petzval::trace(scaled, Ray<T>{ray.origin * T(0.37), ray.direction});
      if (!wanted.transmitted() || !found.transmitted()) continue;  // at a rim
      const double p = distance(found.ray.origin, wanted.ray.origin * T(0.37)) / (eps * s.size * 0.37);
      EXPECT_LE(p, 50) << s.id;
      EXPECT_LE(distance(found.ray.direction, wanted.ray.direction) / eps, 50) << s.id;
      most = std::max(most, p);
    }
  }
  testing_report::put("a lens scaled by 0.37 scales its rays, position", testing_report::one_ray<T>, most, "50 eps");
}

TYPED_TEST(LawsOf, RotationAboutTheAxisIsWithinRounding) {
  using T = TypeParam;
  const double eps = std::numeric_limits<T>::epsilon(), c = std::cos(1.1), sn = std::sin(1.1);
  const auto rotated = [&](const auto& v) {
    return Vec3<T>(Vec3<double>{c * v.x - sn * v.y, sn * v.x + c * v.y, v.z});
  };
  double most = 0;
  for (const Sample& s : all()) {
    if (!s.lens.rotationally_symmetric()) continue;
    for (const Ray<double>& in : passing_rays(s.lens, 6)) {
      const auto wanted = petzval::trace(s.lens, converted<T>(in));
      const auto found = petzval::trace(s.lens, Ray<T>{rotated(in.origin), rotated(in.direction)});
      if (!wanted.transmitted() || !found.transmitted()) continue;  // at a rim
      const double p = distance(found.ray.origin, rotated(wanted.ray.origin)) / (eps * s.size);
      EXPECT_LE(p, 50) << s.id;
      EXPECT_LE(distance(found.ray.direction, rotated(wanted.ray.direction)) / eps, 50) << s.id;
      most = std::max(most, p);
    }
  }
  testing_report::put("rays rotated about the axis, position", testing_report::one_ray<T>, most, "50 eps");
}

}  // namespace laws_test
