// SPDX-License-Identifier: Apache-2.0
#include "lens/quadric.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
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

TYPED_TEST(QuadricOf, HitsWithinFourEpsFromAnyDistance) {
  for (const double distance : {10.0, 1e3, 1e6}) {
    EXPECT_LE(worst(conic<TypeParam>(0.02, 0), 50, {20, 0.3, distance, 400}, "far"), 4) << distance;
    EXPECT_LE(worst(conic<TypeParam>(0.02, -100), 50, {20, 0.3, distance, 400}, "far, steep conic"), 4) << distance;
  }
}

TYPED_TEST(QuadricOf, HitsWithinFourEpsWhenGrazing) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double k : {0.0, -0.5, -1.0, 1.0}) {
    const Quadric<TypeParam> q = conic<TypeParam>(0.02, k);
    for (const double grazing : {0.1, 1e-2, 1e-3}) {
      for (int i = 0; i < 200; ++i) {
        Vec<TypeParam> target;
        ASSERT_TRUE(surface_point(q, 30 * std::sqrt(uniform(random)), 6.3 * uniform(random), target));
        // A direction in the tangent plane, raised by the grazing angle.
        const QuadVec n = unit(gradient(q, exact(target)));
        const double turn = 6.3 * uniform(random);
        QuadVec tangent{static_cast<Quad>(std::cos(turn)), static_cast<Quad>(std::sin(turn)), 0};
        tangent.z = -(n.x * tangent.x + n.y * tangent.y) / n.z;
        const QuadVec d = along(unit(tangent), n, static_cast<Quad>(grazing));
        const auto direction =
            unit_direction<TypeParam>(static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z));
        const Vec<TypeParam> start = target - direction * TypeParam(5);
        EXPECT_LE(judged(q, start, direction, 1, 30, 5, "grazing"), 4)
            << "k " << k << " angle " << grazing << " ray " << i;
      }
    }
  }
}

TYPED_TEST(QuadricOf, HitsWithinFourEpsAlmostAcrossTheAxis) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double degrees : {74.0, 86.0, 89.4, 89.95, 95.0, 110.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Quadric<TypeParam> q = conic<TypeParam>(0.02, 0);
    for (int i = 0; i < 200; ++i) {
      Vec<TypeParam> target;
      ASSERT_TRUE(surface_point(q, 48 * std::sqrt(uniform(random)), 6.3 * uniform(random), target));
      const double turn = 6.3 * uniform(random);
      const auto d = unit_direction<TypeParam>(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                                               std::cos(angle));
      const Vec<TypeParam> start = target - d * TypeParam(7);
      EXPECT_LE(judged(q, start, d, 1, 48, 7, "steep"), 4) << degrees << " degrees, ray " << i;
    }
  }
}

TEST(Quadric, HitFromAKilometreAwayLiesOnTheSurface) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double k : {0.0, -0.7, -1.0, 0.5}) {
    const auto q = conic<double>(0.02, k);
    for (int i = 0; i < 1000; ++i) {
      const Vec<double> target{14 * uniform(random), 14 * uniform(random), 0};
      const auto d = unit_direction<double>(0.4 * uniform(random), 0.4 * uniform(random), 1);
      const auto [p, hit, slant] = intersect(q, target - d * 1e6, d, 1.0);
      ASSERT_TRUE(hit);
      EXPECT_NEAR(q.curvature * (p.x * p.x + p.y * p.y + q.e * p.z * p.z) / 2 - p.z, 0, 2e-14)
          << "k " << k << " ray " << i;
    }
  }
}

TEST(Quadric, HitOrMissIsCorrectWithinABillionthOfTheEdge) {
  const auto sphere = conic<double>(0.02, 0);
  const auto at = [&](double x, double sense) {
    return intersect(sphere, Vec<double>{x, 0, -3}, Vec<double>{0, 0, sense}, sense).hit;
  };
  for (const double sense : {1.0, -1.0}) {
    EXPECT_TRUE(at(50 * (1 - 1e-9), sense));
    EXPECT_FALSE(at(50 * (1 + 1e-9), sense));
  }
  // A line that touches the sphere at 45 degrees of latitude, in front of its vertex.
  const double s = std::sqrt(0.5);
  const Vec<double> touching{50 * s, 0, 50 - 50 * s};
  const Vec<double> d{s, 0, s};
  for (const double off : {1e-9, -1e-9}) {
    const Vec<double> start = touching + Vec<double>{s * 50 * off, 0, -s * 50 * off} - d * 20.0;
    EXPECT_EQ(intersect(sphere, start, d, 1.0).hit, off < 0);
  }
}

TEST(Quadric, FarSideOfTheSphereAndSecondSheetAreMissed) {
  const auto sphere = conic<double>(0.02, 0);
  EXPECT_FALSE(intersect(sphere, Vec<double>{-90, 3, 60}, Vec<double>{1, 0, 0}, 1.0).hit);
  EXPECT_FALSE(intersect(sphere, Vec<double>{-90, 3, 60}, Vec<double>{1, 0, 0}, -1.0).hit);
  EXPECT_TRUE(intersect(sphere, Vec<double>{-90, 3, 40}, Vec<double>{1, 0, 0}, 1.0).hit);

  const auto hyperboloid = conic<double>(0.02, -2.25);  // second vertex at z = -80
  EXPECT_FALSE(intersect(hyperboloid, Vec<double>{-200, 3, -100}, Vec<double>{1, 0, 0}, 1.0).hit);
  EXPECT_FALSE(intersect(hyperboloid, Vec<double>{-200, 3, -100}, Vec<double>{1, 0, 0}, -1.0).hit);
  EXPECT_TRUE(intersect(hyperboloid, Vec<double>{-200, 3, 10}, Vec<double>{1, 0, 0}, 1.0).hit);
}

TEST(Quadric, DirectionOfTravelSelectsTheRoot) {
  const auto sphere = conic<double>(0.02, 0);
  const auto d = unit_direction<double>(1, 0, -0.1);
  const Vec<double> start{-60, 0, 30};
  const auto to_film = intersect(sphere, start, d, 1.0), to_scene = intersect(sphere, start, d, -1.0);
  ASSERT_TRUE(to_film.hit && to_scene.hit);
  EXPECT_LT(to_film.point.x, 0);
  EXPECT_GT(to_scene.point.x, 0);
}

TEST(Quadric, HitsMayLieBehindTheStartOfTheRay) {
  const auto [p, hit, slant] = intersect(conic<double>(-0.02, 0), Vec<double>{0, 20, 1}, Vec<double>{0, 0, 1}, 1.0);
  ASSERT_TRUE(hit);
  EXPECT_LT(p.z, 0);
}

TYPED_TEST(QuadricOf, NormalsHaveUnitLengthAndPointToTheFilmAtTheVertex) {
  for (const double k : {-100.0, -1.0, -0.5, 0.0, 2.0}) {
    for (const auto& q : {conic<TypeParam>(0.02, k), conic<TypeParam>(-0.02, k), cylinder<TypeParam>(0.02, k, 'y')}) {
      for (const double reach : {0.0, 5.0, 20.0}) {
        Vec<TypeParam> p;
        ASSERT_TRUE(surface_point(q, reach, 0.7, p));
        const auto n = normal(q, p);
        EXPECT_NEAR(static_cast<double>(dot(n, n)), 1, 4 * std::numeric_limits<TypeParam>::epsilon());
        const QuadVec wanted = unit(gradient(q, exact(p)));
        EXPECT_NEAR(static_cast<double>(n.x - wanted.x), 0, 4 * std::numeric_limits<TypeParam>::epsilon());
        EXPECT_NEAR(static_cast<double>(n.z - wanted.z), 0, 4 * std::numeric_limits<TypeParam>::epsilon());
        EXPECT_GT(n.z, 0);
      }
    }
  }
}

TYPED_TEST(QuadricOf, TheSlantIsTheCosineOfIncidence) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const auto& q : {conic<TypeParam>(0.02, 0), conic<TypeParam>(-0.03, -2.5), conic<TypeParam>(0.02, 0.8),
                        conic<TypeParam>(0, 0), cylinder<TypeParam>(0.05, 0, 'x')}) {
    for (int i = 0; i < 500; ++i) {
      const auto d = unit_direction<TypeParam>(uniform(random), uniform(random), 1);
      const Vec<TypeParam> start{static_cast<TypeParam>(9 * uniform(random)),
                                 static_cast<TypeParam>(9 * uniform(random)), -3};
      const auto [p, hit, slant] = intersect(q, start, d, TypeParam(1));
      if (!hit) continue;
      const QuadVec g = gradient(q, exact(p));
      const double wanted = static_cast<double>(inner(g, exact(d)));
      EXPECT_NEAR(static_cast<double>(slant), wanted, 6 * std::numeric_limits<TypeParam>::epsilon() / wanted)
          << "ray " << i;
    }
  }
}

TYPED_TEST(QuadricOf, ExtremeStartsGiveFiniteHitsOrMisses) {
  const TypeParam big = std::numeric_limits<TypeParam>::max(), tiny = std::numeric_limits<TypeParam>::denorm_min();
  const TypeParam nan = std::numeric_limits<TypeParam>::quiet_NaN(), inf = std::numeric_limits<TypeParam>::infinity();
  const std::array<TypeParam, 9> values{0, 1, -1, big, -big, tiny, nan, inf, TypeParam(1e-3)};
  std::mt19937 random(11);
  const auto any = [&] { return values[random() % values.size()]; };
  for (const auto& q : {conic<TypeParam>(0.02, 0), conic<TypeParam>(0, 0), conic<TypeParam>(-1e9, 3),
                        conic<TypeParam>(0.1, -1e6), cylinder<TypeParam>(0.3, 0, 'x')}) {
    for (int i = 0; i < 5000; ++i) {
      const auto d = unit_direction<TypeParam>(random() % 3 - 1.0, random() % 3 - 1.0, random() % 3 - 1.0 + 1e-3);
      const auto [p, hit, slant] = intersect(q, Vec<TypeParam>{any(), any(), any()}, d, TypeParam(1));
      EXPECT_TRUE(!hit || (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)));
    }
  }
}

}  // namespace quadric_test
