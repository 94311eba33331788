// SPDX-License-Identifier: Apache-2.0
#include "lens/quadric.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../report.hpp"
#include "quad.hpp"

namespace quadric_test {

using petzval::kernel::Quadric;
using petzval::kernel::Vec;

template <class R>
Quadric<R> conic(double curvature, double k) {
  return petzval::kernel::make_quadric<R>(curvature, k);
}

template <class R>
Quadric<R> cylinder(double curvature, double k, char curved_in) {
  return petzval::kernel::make_quadric<R>(curvature, k, curved_in == 'x', curved_in == 'y');
}

template <class R>
QuadVec exact(const Vec<R>& v) {
  return {static_cast<Quad>(v.x), static_cast<Quad>(v.y), static_cast<Quad>(v.z)};
}

template <class R>
QuadVec gradient(const Quadric<R>& q, const QuadVec& p) {
  const Quad c = q.curvature;
  return {-c * q.ax * p.x, -c * q.ay * p.y, 1 - c * q.e * p.z};
}

struct Expected {
  bool hit = false;
  QuadVec point{0, 0, 0};
  Quad cos_incidence = 0;
};

/// The 113-bit root on the vertex sheet that is crossed in the direction of travel.
template <class R>
Expected expected(const Quadric<R>& q, const Vec<R>& start, const Vec<R>& direction, int sense) {
  const QuadVec p = exact(start), d = exact(direction);
  const Quad c = q.curvature, e = q.e, ax = q.ax, ay = q.ay;
  const Quad a = c * (ax * d.x * d.x + ay * d.y * d.y + e * d.z * d.z);
  const Quad b = c * (ax * p.x * d.x + ay * p.y * d.y + e * p.z * d.z) - d.z;
  const Quad f = c * (ax * p.x * p.x + ay * p.y * p.y + e * p.z * p.z) - 2 * p.z;
  const Quad discriminant = b * b - a * f;
  if (discriminant < 0) return {};
  const Quad larger = b < 0 ? -b + root(discriminant) : -b - root(discriminant);
  std::vector<Quad> candidates;
  if (larger != 0) candidates.push_back(f / larger);
  if (a != 0) candidates.push_back(larger / a);
  for (const Quad t : candidates) {
    const QuadVec hit = along(p, d, t), n = gradient(q, hit);
    const Quad cosine = inner(n, unit(d)) / root(inner(n, n)) * sense;
    if (n.z > 0 && cosine > 0) return {true, hit, cosine};
  }
  return {};
}

/// Sets a surface point within `reach` of the axis at any azimuth. False beyond the equator.
template <class R>
bool surface_point(const Quadric<R>& q, double reach, double turn, Vec<R>& point) {
  const Quad c = q.curvature;
  const Quad x = reach * std::cos(turn), y = reach * std::sin(turn), r2 = q.ax * x * x + q.ay * y * y;
  const Quad inside = 1 - q.e * c * c * r2;
  if (!(inside > 0)) return false;
  point = {static_cast<R>(x), static_cast<R>(y), static_cast<R>(c * r2 / (1 + root(inside)))};
  return true;
}

double domain(double curvature, double k) {
  return curvature == 0 || k <= -1 ? std::numeric_limits<double>::infinity()
                                   : 1 / (std::abs(curvature) * std::sqrt(1 + k));
}

template <class R>
Vec<R> unit_direction(double x, double y, double z) {
  const double l = std::sqrt(x * x + y * y + z * z);
  return {static_cast<R>(x / l), static_cast<R>(y / l), static_cast<R>(z / l)};
}

/// Error of a hit relative to the effect of rounding the ray: |dP| cos I / (eps (height + distance slope)).
template <class R>
double judged(const Quadric<R>& q, const Vec<R>& start, const Vec<R>& d, int sense, double height, double distance,
              const std::string& what) {
  const Expected e = expected(q, start, d, sense);
  const auto [point, hit, slant] = intersect(q, start, d, static_cast<R>(sense));
  // A ray within rounding of the equator may hit or miss.
  const bool doubtful = !e.hit || e.cos_incidence < 1e-7;
  EXPECT_TRUE(hit == e.hit || doubtful) << what;
  if (!hit || !e.hit) return 0;
  const QuadVec p = exact(point), miss{p.x - e.point.x, p.y - e.point.y, p.z - e.point.z};
  const double slope = std::hypot(static_cast<double>(d.x), static_cast<double>(d.y));
  return static_cast<double>(root(inner(miss, miss)) * e.cos_incidence) /
         (std::numeric_limits<R>::epsilon() * (height + distance * slope));
}

struct Sweep {
  double height = 20, slope = 0.5, distance = 5;
  int rays = 400;
};

/// Largest relative error of random skew rays towards points within the height, from both sides.
template <class R>
double worst(const Quadric<R>& q, double limit, const Sweep& sweep, const std::string& what) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double height = std::min(sweep.height, 0.95 * limit);
  double most = 0;
  for (int i = 0; i < sweep.rays; ++i) {
    Vec<R> target;
    if (!surface_point(q, height * std::sqrt(uniform(random)), 6.3 * uniform(random), target)) continue;
    const double angle = 6.3 * uniform(random), slope = sweep.slope * uniform(random);
    const int sense = i % 2 ? 1 : -1;
    const Vec<R> d = unit_direction<R>(slope * std::cos(angle), slope * std::sin(angle), sense);
    const double distance = sweep.distance * std::min(1.0, height) * (0.5 + uniform(random));
    const Vec<R> start = target - d * static_cast<R>(distance);
    most = std::max(most, judged(q, start, d, sense, height, distance, what + " ray " + std::to_string(i)));
  }
  return most;
}

template <class T>
class QuadricOf : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(QuadricOf, Plain);

TYPED_TEST(QuadricOf, HitsWithinFourEpsForEveryRadius) {
  double most = 0;
  for (const double radius : {1e-9, 1e-6, 1e-3, 1.0, 50.0, 1e3, 1e5, 1e7, 1e12}) {
    for (const double sign : {1.0, -1.0}) {
      const double c = sign / radius;
      const double error = worst(conic<TypeParam>(c, 0), domain(c, 0), {}, "radius " + std::to_string(radius));
      EXPECT_LE(error, 4) << "radius " << sign * radius;
      most = std::max(most, error);
    }
  }
  for (const double c : {0.0, -0.0, static_cast<double>(std::numeric_limits<TypeParam>::denorm_min())}) {
    most = std::max(most, worst(conic<TypeParam>(c, 0), domain(c, 0), {}, "plane"));
  }
  EXPECT_LE(most, 4);
  testing_report::put("hit on a sphere, R = 1e-9 to 1e12 mm and plane, x cos(incidence)",
                      testing_report::one_ray<TypeParam>, most, "4 eps");
}

TYPED_TEST(QuadricOf, HitsWithinFourEpsForEveryConicAndSkewRays) {
  double most = 0;
  const double ulp = std::numeric_limits<double>::epsilon();
  for (const double k :
       {-1e6, -100.0, -2.25, -1 - 1e-4, -1 - 2 * ulp, -1.0, -1 + ulp, -1 + 1e-4, -0.5, 0.0, 1.0, 3.0, 5.0}) {
    for (const double radius : {50.0, -50.0, 200.0}) {
      for (const double distance : {5.0, 100.0}) {
        const double c = 1 / radius;
        const double error =
            worst(conic<TypeParam>(c, k), domain(c, k), {20, 0.5, distance, 400}, "k " + std::to_string(k));
        EXPECT_LE(error, 4) << "k " << k << " radius " << radius << " distance " << distance;
        most = std::max(most, error);
      }
    }
  }
  testing_report::put("hit on a conic, k = -1e6 to 5, skew rays, x cos(incidence)", testing_report::one_ray<TypeParam>,
                      most, "4 eps");
}

TYPED_TEST(QuadricOf, HitsWithinFourEpsOnCylinders) {
  for (const char section : {'x', 'y'}) {
    for (const double radius : {2.5, -50.0, 1e7}) {
      for (const double k : {-1.5, 0.0, 1.0}) {
        const double c = 1 / radius;
        EXPECT_LE(worst(cylinder<TypeParam>(c, k, section), domain(c, k), {}, "cylinder"), 4)
            << section << radius << " " << k;
      }
    }
  }
}

TEST(Quadric, HitsMayLieBehindTheStartOfTheRay) {
  const auto [p, hit, slant] = intersect(conic<double>(-0.02, 0), Vec<double>{0, 20, 1}, Vec<double>{0, 0, 1}, 1.0);
  ASSERT_TRUE(hit);
  EXPECT_LT(p.z, 0);
}

}  // namespace quadric_test
