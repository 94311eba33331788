// SPDX-License-Identifier: Apache-2.0
#include "petzval/movement/plane_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"

namespace petzval {
namespace {

using Points = std::vector<PlanePoint>;

double dot(const Vec3<double>& a, const Vec3<double>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3<double> cross(const Vec3<double>& a, const Vec3<double>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Between two axes, whichever way they point; the cross product keeps small angles exact.
double angle(const Vec3<double>& a, const Vec3<double>& b) {
  const auto c = cross(a, b);
  return std::asin(std::min(1.0, std::sqrt(dot(c, c))));
}

/// A plane whose normal is tilted by `tilt` about x: at 90 degrees it contains the view direction z.
struct Scene {
  Vec3<double> normal, u{1, 0, 0}, v;
  explicit Scene(double tilt_deg)
      : normal(0, std::sin(radians(tilt_deg)), std::cos(radians(tilt_deg))), v(0, normal.z, -normal.y) {}

  Points points(int count, double spread, double noise, unsigned seed, Vec3<double> centre = {10, -20, 1500}) const {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> in_plane(-spread, spread);
    std::normal_distribution<double> across(0, 1);
    Points list;
    for (int i = 0; i < count; ++i) {
      list.push_back({centre + in_plane(random) * u + in_plane(random) * v + noise * across(random) * normal, 1.0});
    }
    return list;
  }
};

class PlaneFitTilt : public testing::TestWithParam<double> {};

TEST_P(PlaneFitTilt, ExactPointsGiveTheirPlane) {
  const Scene scene(GetParam());
  const PlaneFit fit = fit_plane(scene.points(24, 300, 0, 1));
  ASSERT_TRUE(fit);
  EXPECT_LT(angle(fit.normal, scene.normal), 1e-12);
  EXPECT_LT(fit.rms_distance, 1e-9);
  EXPECT_NEAR(std::sqrt(dot(fit.normal, fit.normal)), 1, 1e-15);
  EXPECT_GE(fit.normal.z, 0);
}

TEST_P(PlaneFitTilt, NoiseLeavesNoBias) {
  // Noise of 3 mm on 20 points. A fit of z(x, y) would lean by 0.8 degrees at 80, and 5.5 at 88; total least squares
  // does not.
  const Scene scene(GetParam());
  double lean = 0;
  constexpr int trials = 200;
  for (unsigned seed = 0; seed < trials; ++seed) {
    const PlaneFit fit = fit_plane(scene.points(20, 100, 3, seed));
    ASSERT_TRUE(fit);
    lean += std::asin(dot(cross(scene.normal, fit.normal), scene.u) * (dot(scene.normal, fit.normal) < 0 ? -1 : 1));
    EXPECT_GT(fit.rms_distance, 1);
    EXPECT_LT(fit.rms_distance, 5);
  }
  EXPECT_LT(std::abs(degrees(lean / trials)), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Tilts, PlaneFitTilt, testing::Values(0.0, 30.0, 60.0, 80.0, 88.0, 90.0));

TEST(PlaneFit, FarFromTheOriginLosesOnlyTheRoundingOfTheCoordinates) {
  const Scene scene(30);
  struct Row {
    double distance, tolerance;
  };
  for (const auto& [distance, tolerance] : {Row{1e6, 2e-9}, Row{1e9, 2e-6}}) {
    const PlaneFit fit = fit_plane(scene.points(24, 1, 0, 3, {0, 0, distance}));
    ASSERT_TRUE(fit);
    EXPECT_LT(angle(fit.normal, scene.normal), tolerance) << distance;
  }
}

TEST(PlaneFit, UnitOfLengthDoesNotMatter) {
  const Scene scene(75);
  const Points base = scene.points(24, 300, 5, 4);
  const PlaneFit in_mm = fit_plane(base);
  for (const double unit : {1e-150, 1e-6, 1e-3, 1e3, 1e6, 1e150}) {
    Points scaled = base;
    for (auto& p : scaled) p.position *= unit;
    const PlaneFit fit = fit_plane(scaled);
    ASSERT_TRUE(fit) << unit;
    EXPECT_LT(angle(fit.normal, in_mm.normal), 1e-12) << unit;
    EXPECT_NEAR(fit.rms_distance / (in_mm.rms_distance * unit), 1, 1e-12) << unit;
  }
}

TEST(PlaneFit, OrderDoesNotMatter) {
  Points points = Scene(50).points(24, 300, 5, 5);
  const PlaneFit before = fit_plane(points);
  std::mt19937 random(6);
  for (int i = 0; i < 10; ++i) {
    std::shuffle(points.begin(), points.end(), random);
    EXPECT_LT(angle(fit_plane(points).normal, before.normal), 1e-12);
  }
}

TEST(PlaneFit, IsTheMinimum) {
  // No plane nearby, tilted or moved, has a smaller weighted sum.
  Points points = Scene(40).points(15, 100, 8, 7);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].weight = 1 + static_cast<double>(i % 4);
  const PlaneFit fit = fit_plane(points);
  ASSERT_TRUE(fit);
  const auto cost = [&](const Vec3<double>& normal, double shift) {
    double sum = 0, weights = 0;
    for (const auto& [p, w] : points) {
      const double d = dot(normal, p - fit.point) - shift;
      sum += w * d * d;
      weights += w;
    }
    return std::sqrt(sum / weights);
  };
  EXPECT_NEAR(cost(fit.normal, 0), fit.rms_distance, 1e-12 * fit.rms_distance);
  for (const Vec3<double> lean : {Vec3<double>{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}) {
    const Vec3<double> moved = fit.normal + 1e-3 * lean;
    EXPECT_GT(cost(moved / std::sqrt(dot(moved, moved)), 0), fit.rms_distance);
  }
  EXPECT_GT(cost(fit.normal, 0.1), fit.rms_distance);
  EXPECT_GT(cost(fit.normal, -0.1), fit.rms_distance);
}

TEST(PlaneFit, WeightCountsAsRepetition) {
  const Points base = Scene(20).points(8, 100, 10, 8);
  Points repeated, weighted;
  for (std::size_t i = 0; i < base.size(); ++i) {
    const auto times = 1 + i % 3;
    for (std::size_t k = 0; k < times; ++k) repeated.push_back(base[i]);
    weighted.push_back({base[i].position, static_cast<double>(times)});
  }
  weighted.push_back({{1e6, 1e6, -1e6}, 0});  // a point without weight takes no part
  EXPECT_LT(angle(fit_plane(repeated).normal, fit_plane(weighted).normal), 1e-12);
}

TEST(PlaneFit, ReportsWhatFixesNoPlane) {
  const auto status = [](const Points& points) { return fit_plane(points).status; };
  using enum PlaneFit::Status;
  EXPECT_EQ(status({}), degenerate);
  EXPECT_EQ(status({{{1, 2, 3}, 1}, {{4, 5, 6}, 1}}), degenerate);
  EXPECT_EQ(status({{{1, 2, 3}, 1}, {{1, 2, 3}, 1}, {{1, 2, 3}, 1}}), degenerate);
  EXPECT_EQ(status({{{0, 0, 0}, 1}, {{1, 1, 1}, 1}, {{5, 5, 5}, 1}, {{-2, -2, -2}, 1}}), degenerate);
  EXPECT_EQ(status({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0, 1, 0}, 0}}), degenerate);  // the third has no weight
  Points cube;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) cube.push_back({{x, y, z}, 1});
  EXPECT_EQ(status(cube), degenerate);
  // Flat as a ribbon, yet a plane.
  EXPECT_EQ(status({{{0, 0, 0}, 1}, {{1000, 0, 0}, 1}, {{500, 1e-4, 0}, 1}}), solved);
}

std::string message(const Points& points) {
  try {
    fit_plane(points);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(PlaneFit, RefusesWhatIsNotAPoint) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(message({{{0, 0, 0}, 1}, {{0, nan, 0}, 1}}),
            "fit_plane: point 1: position is (0, nan, 0) mm, wanted finite coordinates");
  EXPECT_EQ(message({{{inf, 0, 0}, 1}}), "fit_plane: point 0: position is (inf, 0, 0) mm, wanted finite coordinates");
  EXPECT_EQ(message({{{0, 0, 0}, -2}}), "fit_plane: point 0: weight is -2, wanted a finite one of 0 or more");
  EXPECT_EQ(message({{{0, 0, 0}, inf}}), "fit_plane: point 0: weight is inf, wanted a finite one of 0 or more");
  EXPECT_EQ(message({{{1e308, 0, 0}, 1}, {{-1e308, 0, 0}, 1}, {{0, 1, 0}, 1}}),
            "fit_plane: the points are too far apart for their distances to be finite");
}

}  // namespace
}  // namespace petzval
