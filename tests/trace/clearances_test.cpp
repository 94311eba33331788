// SPDX-License-Identifier: Apache-2.0
#include "trace/clearances.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace clearances_test {

/// Rays towards and past the rear of a lens, as columns.
struct Columns {
  std::array<std::vector<double>, 6> values;

  RayArrays<double> arrays() {
    return {values[0].data(), values[1].data(), values[2].data(), values[3].data(), values[4].data(), values[5].data()};
  }
};

Columns rays_to_scene(const Lens& lens, std::size_t count) {
  std::mt19937_64 random(count);
  std::uniform_real_distribution<double> one(-1, 1);
  double half = 0;
  for (const LensSurface& s : lens.surfaces()) half = std::max(half, std::min(s.semi_diameter, 1e3));
  const double z = lens.surfaces().back().vertex_z, sense = lens.film_z() > z ? -1 : 1;
  Columns rays;
  for (auto& column : rays.values) column.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = 0.3 * one(random), dy = 0.3 * one(random);
    const std::array<double, 6> ray{
        half * one(random), half * one(random), z, dx, dy, sense * std::sqrt(1 - dx * dx - dy * dy)};
    for (std::size_t k = 0; k < 6; ++k) rays.values[k][i] = ray[k];
  }
  return rays;
}

TEST(Clearances, AreNonNegativeExactlyForTransmittedRays) {
  for (const Prescription& p : testing::data_prescriptions()) {
    for (const bool bladed : {false, true}) {
      const Lens round = compile(p);
      const Lens lens = bladed ? with_iris(round, Iris{.blades = 7, .rotation_rad = 0.2}) : round;
      constexpr std::size_t count = 403;
      const Columns rays = rays_to_scene(lens, count);
      for (const Arithmetic arithmetic : {Arithmetic::fast, Arithmetic::reproducible}) {
        SCOPED_TRACE(p.id + " " + std::string(name(arithmetic)));
        const BatchOptions options{.travel = Travel::to_scene, .arithmetic = arithmetic};
        Columns traced = rays, watched = rays;
        const auto in = traced.arrays();
        std::vector<RayFate> fates(count);
        trace<double>(lens, count, {in.x, in.y, in.z, in.dx, in.dy, in.dz}, in, fates.data(), nullptr, options);
        std::vector<double> values(count);
        trace_detail::clearances<double>(lens, count, watched.arrays(), values.data(), options);
        EXPECT_EQ(watched.values, traced.values);
        for (std::size_t i = 0; i < count; ++i) {
          ASSERT_EQ(values[i] >= 0, fates[i] == RayFate::transmitted) << i << ": " << values[i];
        }
      }
    }
  }
}

TEST(Clearances, AreTheSmallestDistanceToARim) {
  // The only aperture is a stop with a rim of 2, an obscuration of 1 and six straight edges, the first at x = sqrt 3.
  Prescription p;
  p.name = "one rim";
  p.surfaces = {{.thickness = 1, .semi_diameter = 2, .obscuration_semi_diameter = 1, .stop = true},
                {.thickness = 50, .semi_diameter = 100}};
  const Lens lens = with_iris(compile(p), {.blades = 6});
  const auto clearance = [&](double x, double y, bool apertures) {
    Columns ray;
    ray.values = {{{x}, {y}, {-5}, {0}, {0}, {1}}};
    double value = 0;
    trace_detail::clearances<double>(lens, 1, ray.arrays(), &value, {.apertures = apertures});
    return value;
  };
  const double edge = std::sqrt(3.0) / 2;
  for (const bool apertures : {false, true}) {
    EXPECT_NEAR(clearance(0, 1.8, apertures), edge * 0.1, 1e-12);
    EXPECT_NEAR(clearance(0, 1.2, apertures), (1.44 - 1) / 4, 1e-12);
    EXPECT_NEAR(clearance(1.4, 0, apertures), edge - 0.7, 1e-12);
    EXPECT_NEAR(clearance(-1.2, 0, apertures), (1.44 - 1) / 4, 1e-12);
    EXPECT_NEAR(clearance(0, 4, apertures), -3.0 / 4, 1e-12);  // v / (1 - v) for v = -3
    EXPECT_NEAR(clearance(1.8, 0, apertures), (edge - 0.9) / (1.9 - edge), 1e-12);
  }
}

TEST(Clearances, WithoutAperturesAreTheMinimumOverAllRims) {
  // The ray passes just inside the first rim and far outside the second.
  Prescription p;
  p.name = "two rims";
  p.surfaces = {{.thickness = 1, .semi_diameter = 2, .stop = true}, {.thickness = 50, .semi_diameter = 1}};
  const Lens lens = compile(p);
  const auto clearance = [&](double y, bool apertures) {
    Columns ray;
    ray.values = {{{0}, {y}, {-5}, {0}, {0}, {1}}};
    double value = 0;
    trace_detail::clearances<double>(lens, 1, ray.arrays(), &value, {.apertures = apertures});
    return value;
  };
  const auto folded = [](double v) { return v / (1 - v); };
  EXPECT_NEAR(clearance(2.2, true), folded(1 - 1.21), 1e-12);
  EXPECT_NEAR(clearance(2.2, false), folded(1 - 4.84), 1e-12);
  EXPECT_NEAR(clearance(0.5, false), 0.75, 1e-12);
}

TEST(Clearances, MissedSurfacesGiveLowerValuesThanRims) {
  Prescription p;
  p.name = "ball";
  p.surfaces = {{.radius = 5, .thickness = 9, .medium = {.nd = 1.5}, .semi_diameter = 4.9, .stop = true},
                {.radius = 20, .thickness = 50, .semi_diameter = 40}};
  const Lens lens = compile(p);
  const auto clearance = [&](double y) {
    Columns ray;
    ray.values = {{{0}, {y}, {-1}, {0}, {0}, {1}}};
    double value = 0;
    trace_detail::clearances<double>(lens, 1, ray.arrays(), &value, {.apertures = false});
    return value;
  };
  EXPECT_GT(clearance(0), 0);
  EXPECT_GT(clearance(4.95), -1);
  EXPECT_LT(clearance(30), -1.9);
}

}  // namespace clearances_test
}  // namespace petzval
