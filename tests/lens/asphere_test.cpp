// SPDX-License-Identifier: Apache-2.0
#include "lens/asphere_hit.hpp"
#include "lens/lens_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../asphere_scan.hpp"
#include "petzval/pupil/apertures.hpp"

namespace asphere_test {

using petzval::AsphereTerm;
using petzval::SurfaceRow;
using petzval::kernel::Asphere;
using petzval::kernel::Vec;
using testing_aspheres::Sag;
using testing_aspheres::scan;

struct Named {
  std::string name;
  SurfaceRow row;
};

SurfaceRow row(double radius, double conic, double semi_diameter, std::vector<AsphereTerm> terms) {
  SurfaceRow r;
  r.radius = radius;
  r.conic = conic;
  r.semi_diameter = semi_diameter;
  r.aspheric = std::move(terms);
  return r;
}

/// A weak camera asphere, gull-wing surfaces of phone lenses and a wavy surface.
std::vector<Named> surfaces() {
  return {
      {"camera", row(40, -0.5, 18, {{4, -2e-6}, {6, 3e-9}, {8, -4e-12}})},
      {"phone, odd terms", row(1.674, -8.617, 2.5,
                               {{3, 0.07429},
                                {4, -0.06933},
                                {5, -0.005811},
                                {6, 0.002396},
                                {7, 0.0021},
                                {8, -0.0003119},
                                {9, -5.552e-05},
                                {10, 7.969e-06}})},
      {"phone, steep conic", row(5.694, -222.1, 2.0,
                                 {{3, -0.07876},
                                  {4, 0.0702},
                                  {5, 0.001575},
                                  {6, -0.009958},
                                  {7, -0.007322},
                                  {8, 0.0006914},
                                  {9, 0.00254},
                                  {10, -0.000765}})},
      {"gull wing", row(2.2, -1, 2.8, {{4, -0.085}, {6, 0.0075}, {8, -0.0002}})},
      {"gull wing, plane base", row(0, 0, 3, {{2, 0.3}, {4, -0.06}, {6, 0.003}})},
      {"wave", row(0, 0, 3, {{2, 0.5}, {4, -0.15}, {6, 0.0105}})},
      {"coefficient denormal in float", row(1000, 0, 300, {{16, 1e-41}})},
  };
}

petzval::Lens compiled(const SurfaceRow& r) {
  petzval::Prescription p;
  p.name = "asphere";
  p.surfaces = {r};
  return petzval::compile(p);
}

Asphere<double> described(const SurfaceRow& row) { return petzval::kernel::view<double>(compiled(row)).aspheres[0]; }

// With loose bounds for sag and slope (1e50) every ray would be searched for, and a camera would take 9 s.
TEST(Asphere, DescriptionEndsWhereTheSurfaceIsSteep) {
  SurfaceRow runaway =
      row(-600, 0.8, 0, {{12, std::pow(20., -11)}, {14, -std::pow(11., -13)}, {37, std::pow(15., -36)}});
  runaway.semi_diameter.reset();
  const Asphere<double> unlimited = described(runaway);
  EXPECT_GT(unlimited.height, 5);
  EXPECT_LT(unlimited.height, 15);
  EXPECT_LT(unlimited.steepest, 3);
  for (const double rim : {446., 1e6, 1e15}) {
    runaway.semi_diameter = rim;
    const Asphere<double> limited = described(runaway);
    EXPECT_GT(limited.height, 9) << rim;
    EXPECT_LT(limited.height, 18) << rim;
    EXPECT_LT(limited.steepest, 5) << rim;
    EXPECT_GT(limited.highest - limited.lowest, 0) << rim;
    EXPECT_LT(limited.highest - limited.lowest, 10 * limited.height) << rim;
  }
  for (const auto& [order, coefficient] : {AsphereTerm{2, -4e11}, {40, 1e300}, {3, 1e-300}}) {
    SurfaceRow extreme = row(50, 0, 20, {{order, coefficient}});
    const Asphere<double> a = described(extreme);
    EXPECT_TRUE(a.height > 0 && a.steepest < 5 && std::isfinite(a.highest - a.lowest)) << order;
  }
  runaway.semi_diameter = 1e-12;  // float underflows for smaller squares
  EXPECT_EQ(described(runaway).height, 1e-12);
  for (const Named& named : surfaces()) {
    const double e = 1 + named.row.conic;
    const bool ends = named.row.radius != 0 && e > 0;
    const double domain = ends ? std::abs(named.row.radius) / std::sqrt(e) : std::numeric_limits<double>::infinity();
    EXPECT_EQ(described(named.row).height, std::min(*named.row.semi_diameter, domain)) << named.name;
  }
}

/// Compares the bounds of all rings with samples. Returns the largest excess over the samples, relative to the bounds
/// of the whole surface.
double expect_bounds(const SurfaceRow& row, const std::string& what) {
  constexpr int samples = 200;
  const Asphere<double> a = described(row);
  const Sag sag{row};
  double slack = 0;
  for (const auto& ring : a.rings) {
    const double inner = std::sqrt(std::max(ring.inner2, 0.)),
                 outer = std::sqrt(std::min(ring.outer2, a.height * a.height));
    EXPECT_LT(inner, outer) << what;
    EXPECT_GE(ring.outer, outer) << what;
    double low = 1e300, high = -1e300, least = 1e300, most = -1e300;
    for (int i = 0; i <= samples; ++i) {
      const double r = inner + (outer - inner) * i / samples, h = 1e-6 * a.height;
      const auto z = static_cast<double>(sag.value(r));
      low = std::min(low, z), high = std::max(high, z);
      if (r < 2 * h || r > a.height - h) continue;
      const auto bend = static_cast<double>((sag.value(r + h) - sag.value(r - h)) / (2 * h)) / r;
      least = std::min(least, bend), most = std::max(most, bend);
      EXPECT_LE(std::abs(bend) * r, a.steepest) << what << " r " << r;
    }
    const double little = 1e-7 * a.steepest / a.height;  // error of the difference quotient
    EXPECT_LE(ring.lowest, low) << what << " r " << outer;
    EXPECT_GE(ring.highest, high) << what << " r " << outer;
    EXPECT_LE(ring.least_bend, least + little) << what << " r " << outer;
    EXPECT_GE(ring.most_bend, most - little) << what << " r " << outer;
    EXPECT_TRUE(a.lowest <= ring.lowest && ring.highest <= a.highest) << what;
    slack =
        std::max({slack, (low - ring.lowest) / (a.highest - a.lowest), (ring.highest - high) / (a.highest - a.lowest),
                  (least - ring.least_bend) * outer / a.steepest, (ring.most_bend - most) * outer / a.steepest});
  }
  return slack;
}

TEST(Asphere, IsWithinTheBoundsOfItsRings) {
  for (const Named& named : surfaces()) EXPECT_LT(expect_bounds(named.row, named.name), 0.03) << named.name;
  std::mt19937 random(3);
  double worst = 0, sum = 0;
  constexpr int count = 300;
  for (int i = 0; i < count; ++i) {
    const double slack = expect_bounds(testing_aspheres::wild(random), "wild " + std::to_string(i));
    worst = std::max(worst, slack);
    sum += slack;
  }
  EXPECT_LT(worst, 0.5);
  EXPECT_LT(sum / count, 0.05);
}

/// True if a ray misses the aperture of a surface: it stays outside the cylinder of the rim, or above or below the sag.
bool clearly_beside(const SurfaceRow& r, const Vec<double>& p, const Vec<double>& d) {
  const double rim = *r.semi_diameter, across = d.x * d.x + d.y * d.y, middle = -(p.x * d.x + p.y * d.y) / across;
  const double closest = std::hypot(p.x + middle * d.x, p.y + middle * d.y);
  if (closest > 1.001 * rim) return true;
  if (closest > 0.999 * rim) return false;
  double low = 0, high = 0;
  for (int i = 0; i <= 200; ++i) {
    const auto z = static_cast<double>(Sag{r}.value(rim * i / 200));
    low = std::min(low, z), high = std::max(high, z);
  }
  const double margin = 0.05 * (high - low) + 1e-3 * rim, half = std::sqrt((rim * rim - closest * closest) / across);
  const double one = p.z + (middle - half) * d.z, other = p.z + (middle + half) * d.z;
  return std::min(one, other) > high + margin || std::max(one, other) < low - margin;
}

TEST(Asphere, ClearRaysCrossNothing) {
  int beside = 0, misses = 0;
  for (const auto& [name, r] : surfaces()) {
    const Asphere<double> asphere = described(r);
    const double rim = *r.semi_diameter;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 4000; ++i) {
      const double reach = 2 * rim * uniform(random), turn = 6.3 * uniform(random), heading = 6.3 * uniform(random);
      const double slope = std::sqrt(uniform(random)) * 0.999;
      const int sense = i % 2 ? 1 : -1;
      const Vec<double> d{slope * std::cos(heading), slope * std::sin(heading), sense * std::sqrt(1 - slope * slope)};
      const Vec<double> p{reach * std::cos(turn), reach * std::sin(turn), rim * (uniform(random) - 0.5)};
      const auto found = intersect(asphere, p, d, static_cast<double>(sense));
      if (found.hit) continue;
      beside += found.past_rim;
      misses += !found.past_rim;
      if (found.past_rim) {
        const auto crossings = scan(r, rim, p, d, sense);
        EXPECT_TRUE(!crossings || crossings->empty()) << name << " ray " << i;
      } else {
        EXPECT_FALSE(clearly_beside(r, p, d)) << name << " ray " << i;
      }
    }
  }
  EXPECT_GT(beside, 1000);
  EXPECT_GT(misses, 100);
}

// Newton iteration from the vertex plane finds the hits.
TEST(Asphere, RaysThatMissTheBaseMayHitTheAsphere) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random);
  };
  int aimed = 0, met = 0;
  for (int surface = 0; surface < 1000; ++surface) {
    // Nearly a plane up to the equator of the base.
    const double radius = (surface % 2 ? 1 : -1) * uniform(5, 20);
    const SurfaceRow r = row(radius, 0, uniform(1, 3),
                             {{2, -uniform(0.85, 1.15) / (2 * radius)}, {4, uniform(-1, 1) / (30. * 30 * 30)}});
    const Asphere<double> asphere = described(r);
    for (int i = 0; i < 20; ++i) {
      const double reach = *r.semi_diameter * uniform(1.1, 3), turn = uniform(0, 6.3), heading = uniform(0, 6.3);
      const double z = uniform(0.12, 0.6), slope = std::sqrt(1 - z * z), back = uniform(5, 50);
      if (reach > 0.95 * std::abs(radius)) continue;
      const Vec<double> target{reach * std::cos(turn), reach * std::sin(turn),
                               static_cast<double>(Sag{r}.value(reach))};
      const Vec<double> d{slope * std::cos(heading), slope * std::sin(heading), z}, start = target - d * back;
      if (intersect(asphere.base, start, d, 1.0).hit || dot(normal(asphere, target), d) < 0.05) continue;
      const auto found = intersect(asphere, start, d, 1.0);
      ++aimed;
      met += found.hit && dot(found.point - target, found.point - target) < 1e-18;
    }
  }
  EXPECT_GT(aimed, 5000);
  EXPECT_GT(met, 0.98 * aimed);
}

}  // namespace asphere_test
