// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/autofocus.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../message.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace focus_point_test {

using testing::expect_error;
using testing::expect_tokens;
using testing::message;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using Vec = Vec3<double>;

const IdealLens thin = thin_lens(50, 2);

FocusKey key(double time, const Vec& place, double blur_mm = 0, double weight = 1) {
  return {time, ScenePoint{place, false}, blur_mm, weight};
}
FocusKey far_key(double time, const Vec& direction) { return {time, ScenePoint{direction, true}, 0, 1}; }
FocusKey on_triangle(double time, const std::array<std::size_t, 3>& vertices, const std::array<double, 3>& parts) {
  return {time, TrianglePoint{vertices, parts}, 0, 1};
}
FocusPoint point(std::vector<FocusKey> keys) { return {.keys = std::move(keys)}; }
FocusTime moment(double time) {
  FocusTime result;
  result.time = time;
  return result;
}
std::vector<FocusTarget> targets(const std::vector<FocusPoint>& points, const FocusTime& when,
                                 const IdealLens& lens = thin) {
  return focus_targets(lens, points, when);
}
FocusTarget only(const FocusPoint& p, const FocusTime& when, const IdealLens& lens = thin) {
  const auto result = targets({p}, when, lens);
  EXPECT_EQ(result.size(), 1u);
  return result.empty() ? FocusTarget{} : result[0];
}
void expect_near(const Vec& a, const Vec& b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << ", expected " << b.x << " " << b.y << " " << b.z;
}

TEST(FocusPoints, AreAtTheirKeys) {
  const FocusPoint p =
      point({key(0, {10, -20, -1000}, 0.1, 2), key(1, {300, 40, -2500}, -0.05, 0), key(4, {1, 2, -400})});
  for (const FocusKey& k : p.keys) {
    const FocusTarget t = only(p, moment(k.time));
    expect_near(t.point.position, std::get<ScenePoint>(k.anchor).position, 1e-9);
    EXPECT_EQ(t.blur_mm, k.blur_mm);
    EXPECT_EQ(t.weight, k.weight);
  }
  const FocusPoint one = point({key(7, {1, 2, -300.1})});
  EXPECT_EQ(only(one, moment(-1e9)).point.position, (Vec{1, 2, -300.1}));
}

TEST(FocusPoints, HaveExtentsInAllKeysOrNoKeys) {
  FocusPoint p = point({key(0, {0, 0, -1000}), key(2, {0, 0, -1000})});
  EXPECT_FALSE(only(p, moment(1)).extent_stops);
  p.keys[0].extent_stops = -2;
  expect_error([&] { targets({p}, moment(1)); }, {"key 1", "extent"});
  p.keys[1].extent_stops = 4;
  EXPECT_EQ(only(p, moment(0)).extent_stops, -2);
  EXPECT_DOUBLE_EQ(only(p, moment(1)).extent_stops.value_or(0), 1);
  EXPECT_EQ(only(p, moment(9)).extent_stops, 4);
  p.keys[1].extent_stops = 20.1;
  expect_error([&] { targets({p}, moment(1)); }, {"key 1", "extent", 20.1});
  EXPECT_TRUE(only(point({key(0, {0, 0, -1000})}), moment(0)).fixes_distance);
  p = point({key(0, {0, 0, -1000})});
  p.fixes_distance = false;
  EXPECT_FALSE(only(p, moment(0)).fixes_distance);
}

TEST(FocusPoints, MoveLinearlyInInverseDepth) {
  const Vec from{-100, 20, -500}, to{900, -50, -4000};
  const FocusPoint p = point({key(0, from), key(1, to)});
  const FocusTarget half = only(p, moment(0.5));
  EXPECT_NEAR(-1 / half.point.position.z, (1 / 500.0 + 1 / 4000.0) / 2, 1e-15);
  double last = 0;
  for (double time = 0; time <= 1; time += 1.0 / 32) {
    const Vec at = only(p, moment(time)).point.position;
    EXPECT_LE(glm::length(glm::cross(at - from, to - from)), 1e-9 * glm::dot(to - from, to - from));
    const double along = glm::dot(at - from, to - from);
    EXPECT_GE(along, last);
    last = along;
  }
}

TEST(FocusPoints, MayPullFocusToInfinity) {
  const FocusPoint p = point({key(0, {50, 0, -500}), far_key(2, {0.2, 0.1, -2})});
  const FocusTarget half = only(p, moment(1));
  EXPECT_FALSE(half.point.at_infinity);
  EXPECT_NEAR(half.point.position.z, -1000, 1e-9);
  EXPECT_NEAR(half.point.position.x, 1000 * (0.1 + 0.1) / 2, 1e-9);
  const FocusTarget end = only(p, moment(2));
  EXPECT_TRUE(end.point.at_infinity);
  expect_near(end.point.position / -end.point.position.z, {0.1, 0.05, -1}, 1e-15);
  // The images move continuously.
  const auto image_z = [&](double time) { return thin.image(only(p, moment(time)).point)->position.z; };
  EXPECT_NEAR(image_z(2 - 1e-4), image_z(2), 1e-6);
  // Both keys may be directions.
  const FocusPoint pan = point({far_key(0, {-0.5, 0, -1}), far_key(1, {0.5, 0, -1})});
  EXPECT_TRUE(only(pan, moment(0.5)).point.at_infinity);
  EXPECT_NEAR(only(pan, moment(0.5)).point.position.x, 0, 1e-15);
}

TEST(FocusPoints, CountDepthFromTheFrontPrincipalPoint) {
  const IdealLens lens = thick_lens(testing::data_lens("double_gauss_100mm_f2.0"));
  const double z = lens.front_principal_z();
  ASSERT_GT(std::abs(z), 1);
  const FocusPoint p = point({key(0, {0, 0, z - 400}), key(1, {0, 0, z - 1600})});
  EXPECT_NEAR(only(p, moment(0.5), lens).point.position.z, z - 640, 1e-9);
}

TEST(FocusPoints, MoveInSpaceFromBehindTheLens) {
  const FocusPoint p = point({key(0, {0, 0, 500}), key(1, {100, 0, -1500})});
  EXPECT_TRUE(targets({p}, moment(0)).empty());
  EXPECT_TRUE(targets({p}, moment(0.2)).empty());
  expect_near(only(p, moment(0.5)).point.position, {50, 0, -500}, 1e-9);
  // But not to infinity.
  EXPECT_TRUE(targets({point({key(0, {0, 0, 500}), far_key(1, {0, 0, -1})})}, moment(1)).empty());
}

TEST(FocusPoints, KeepOrderAndAreIndependent) {
  std::vector<FocusPoint> points;
  for (int i = 0; i < 6; ++i) points.push_back(point({key(0, {i * 10.0, 0, -1000}), key(1, {0, i * 10.0, -900. - i})}));
  const auto all = targets(points, moment(0.3));
  std::vector<FocusPoint> reversed(points.rbegin(), points.rend());
  const auto other = targets(reversed, moment(0.3));
  ASSERT_EQ(all.size(), points.size());
  ASSERT_EQ(other.size(), points.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].point.position, other[all.size() - 1 - i].point.position);
    EXPECT_EQ(all[i].point.position, only(points[i], moment(0.3)).point.position);
  }
}

TEST(FocusPoints, FollowTheirTrianglesUnderRigidMotion) {
  const std::vector<Vec> mesh{{0, 0, -900}, {100, 0, -1000}, {0, 100, -1000}, {30, 40, -700}};
  const FocusPoint p = point({on_triangle(0, {0, 1, 2}, {1, 0, 0}), on_triangle(1, {0, 1, 2}, {0.2, 0.5, 0.3}),
                              on_triangle(3, {0, 1, 2}, {0, 0.25, 0.75})});
  const double turn = 0.7;
  const auto moved = [&](const Vec& v) {
    return Vec{v.x * std::cos(turn) - v.y * std::sin(turn) + 20, v.x * std::sin(turn) + v.y * std::cos(turn) - 50,
               v.z - 300};
  };
  std::vector<Vec> moved_mesh;
  for (const Vec& v : mesh) moved_mesh.push_back(moved(v));
  const Vec normal = glm::normalize(glm::cross(mesh[1] - mesh[0], mesh[2] - mesh[0]));
  for (double time = -0.5; time < 3.5; time += 0.0625) {
    FocusTime before = moment(time), after = before;
    before.vertices = mesh, after.vertices = moved_mesh;
    const Vec at = only(p, before).point.position;
    expect_near(only(p, after).point.position, moved(at), 1e-10);
    EXPECT_NEAR(glm::dot(at - mesh[0], normal), 0, 1e-10);  // on the triangle
    EXPECT_GE(at.x, -1e-10);
    EXPECT_GE(at.y, -1e-10);
    EXPECT_LE(at.x / 100 + at.y / 100, 1 + 1e-12);
  }
  FocusTime at_key = moment(1);
  at_key.vertices = mesh;
  expect_near(only(p, at_key).point.position, {50, 30, -980}, 1e-9);
}

TEST(FocusPoints, MoveBetweenTrianglesAndPositions) {
  std::vector<Vec> mesh{{0, 0, -900}, {100, 0, -900}, {0, 100, -900}, {0, 0, -1800}, {90, 0, -1800}, {0, 90, -1800}};
  const double third = 1.0 / 3;
  const FocusPoint p = point({on_triangle(0, {0, 1, 2}, {third, third, third}),
                              on_triangle(1, {3, 4, 5}, {third, third, third}), key(2, {7, 8, -600})});
  FocusTime when = moment(0.5);
  when.vertices = mesh;
  const double depth = only(p, when).point.position.z;
  EXPECT_LT(depth, -900);
  EXPECT_GT(depth, -1800);
  when.time = 1;
  expect_near(only(p, when).point.position, {30, 30, -1800}, 1e-9);
  when.time = 2;
  expect_near(only(p, when).point.position, {7, 8, -600}, 1e-9);
  const FocusPoint across =
      point({on_triangle(0, {0, 1, 2}, {third, third, third}), on_triangle(2, {3, 4, 5}, {0, 1, 0})});
  expect_near(only(across, when).point.position, {90, 0, -1800}, 1e-9);
  // A vertex that is not finite removes the point for this time.
  mesh[4].x = nan;
  EXPECT_TRUE(targets({p}, when).empty());
}

TEST(FocusPoints, AreValidFromTheFirstToTheLastMomentOfTheirInterval) {
  FocusPoint p = point({key(0, {0, 0, -1000})});
  p.from = 2, p.until = 3;
  EXPECT_TRUE(targets({p}, moment(std::nextafter(2, 0))).empty());
  EXPECT_EQ(targets({p}, moment(2)).size(), 1u);
  EXPECT_EQ(targets({p}, moment(3)).size(), 1u);
  EXPECT_TRUE(targets({p}, moment(std::nextafter(3, 4))).empty());
}

TEST(FocusPoints, WithoutAnImageAreSkipped) {
  std::vector<FocusPoint> points;
  for (const double z : {10.0, 0.0, -20.0, -50.0, -50.1, -1e9}) points.push_back(point({key(0, {1, 0, z})}));
  points.push_back(point({far_key(0, {0, 0, 1})}));
  points.push_back(point({far_key(0, {0, 0, -1})}));
  EXPECT_EQ(targets(points, moment(0)).size(), 3u);
}

TEST(FocusPoints, OutsideTheImageAreSkipped) {
  FocusTime when = moment(0);
  // Chief rays pass straight through a thin lens: from x at depth 1000 to -0.052 x.
  const auto seen = [&](double x, double y) { return targets({point({key(0, {x, y, -1000})})}, when).size() == 1; };
  EXPECT_TRUE(seen(1e6, 0));
  when.film = Film{.z_mm = 52};
  EXPECT_TRUE(seen(17.99 / 0.052, -11.99 / 0.052));
  EXPECT_FALSE(seen(18.01 / 0.052, 0));
  EXPECT_FALSE(seen(0, 12.01 / 0.052));
  when.film->shift_x_mm = -10;  // shifted to -x: sees more of +x
  EXPECT_TRUE(seen(27.99 / 0.052, 0));
  EXPECT_FALSE(seen(28.01 / 0.052, 0));
  EXPECT_TRUE(seen(-7.99 / 0.052, 0));
  EXPECT_FALSE(seen(-8.01 / 0.052, 0));
  // At infinity by direction.
  const auto seen_far = [&](double slope) { return targets({point({far_key(0, {slope, 0, -1})})}, when).size() == 1; };
  EXPECT_TRUE(seen_far(27.99 / 52));
  EXPECT_FALSE(seen_far(28.01 / 52));
}

TEST(FocusPoints, MayWeighMoreWhenNearer) {
  FocusTime when = moment(0);
  const std::vector<FocusPoint> points{point({key(0, {0, 0, -1000}, 0, 2)}), point({key(0, {0, 0, -4000}, 0, 4)}),
                                       point({far_key(0, {0, 0, -1})})};
  const auto plain = targets(points, when);
  EXPECT_EQ(plain[0].weight, 2);
  EXPECT_EQ(plain[1].weight, 4);
  when.nearer_weighs_more = true;
  const auto weighed = targets(points, when);
  EXPECT_DOUBLE_EQ(weighed[0].weight, 2);
  EXPECT_DOUBLE_EQ(weighed[1].weight, 1);
  EXPECT_EQ(weighed[2].weight, 0);
  EXPECT_EQ(only(points[2], when).weight, 1);  // without nearer points
}

TEST(FocusPoints, WeightsAreNotNegative) {
  const FocusPoint p = point({key(0, {0, 0, -1000}, 0, 5), key(1, {0, 0, -1000}, 0, 0), key(1.1, {0, 0, -1000}, 0, 0),
                              key(2, {0, 0, -1000}, 0, 9)});
  for (double time = 0; time < 2; time += 1e-3) EXPECT_GE(only(p, moment(time)).weight, 0);
  EXPECT_EQ(only(p, moment(1.05)).weight, 0);
}

TEST(FocusPoints, RefuseInvalidPoints) {
  const FocusPoint good = point({key(0, {0, 0, -1000})});
  const std::vector<Vec> mesh{{0, 0, -900}, {100, 0, -900}, {0, 100, -900}};
  FocusTime when = moment(0);
  when.vertices = mesh;
  const auto says = [&](const FocusPoint& bad) { return message([&] { targets({good, bad}, when); }); };
  expect_tokens(says(point({})), {"focus point 1", "keys"});
  expect_tokens(says(point({key(1, {0, 0, -9}), key(1, {0, 0, -9})})), {"focus point 1", "key 1", "time", 1});
  expect_tokens(says(point({key(nan, {0, 0, -9})})), {"focus point 1", "key 0", "time", "nan"});
  expect_tokens(says(point({key(0, {nan, 0, -9})})), {"focus point 1", "key 0", "position", "nan", 0, -9});
  expect_tokens(says(point({far_key(0, {0, 0, 0})})), {"focus point 1", "key 0", "position", 0, 0, 0});
  expect_tokens(says(point({key(0, {0, 0, -9}, infinity)})), {"focus point 1", "key 0", "blur", "inf"});
  expect_tokens(says(point({key(0, {0, 0, -9}, 0, -1)})), {"focus point 1", "key 0", "weight", -1});
  expect_tokens(says(point({on_triangle(0, {0, 1, 3}, {0, 0.5, 0.5})})), {"focus point 1", "key 0", "vertex", 3});
  for (const auto& parts : {std::array{0.5, 0.5, 0.1}, std::array{1.5, -0.5, 0.0}, std::array{nan, 0.0, 0.0}}) {
    expect_tokens(says(point({on_triangle(0, {0, 1, 2}, parts)})), {"key 0", "barycentric"});
  }
  EXPECT_EQ(says(point({on_triangle(0, {0, 1, 2}, {0.5, 0.25, 0.25 + 5e-10})})), "no error");
  FocusPoint late = good;
  late.from = 2, late.until = 1;
  expect_tokens(says(late), {"focus point 1", 2, 1});
  expect_error([&] { targets({good}, moment(nan)); }, {"focus_targets", "time", "nan"});
  when.film = Film{.width_mm = -36};
  expect_error([&] { targets({good}, when); }, {"film", -36});
}

}  // namespace focus_point_test
}  // namespace petzval
