// SPDX-License-Identifier: Apache-2.0
// Every slot of a result is written and finite, for every input.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "batches.hpp"

namespace robust_test {

using petzval::Ray;
using petzval::RayFate;
using petzval::TracedRay;
using petzval::TraceOptions;
using petzval::Travel;
using testing_batches::finite;

using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A random lens: 1 to 40 surfaces of all kinds and sizes.
petzval::Lens random_lens(Random& random) {
  const double scale = std::pow(10.0, uniform(random, -6, 6));
  petzval::Prescription p;
  p.name = "random";
  const std::size_t count = 1 + random() % 40;
  for (std::size_t i = 0; i < count; ++i) {
    petzval::SurfaceRow row;
    const auto kind = random() % 8;
    row.radius = kind == 0 ? 0 : scale * std::pow(10.0, uniform(random, -1, 3)) * (random() % 2 ? 1 : -1);
    row.thickness = scale * uniform(random, random() % 10 ? 0 : -1, 1);
    row.medium.nd = random() % 2 ? 1 : uniform(random, 0.8, 4);
    row.semi_diameter = random() % 3 ? scale * uniform(random, 0.1, 3) : std::numeric_limits<double>::infinity();
    if (random() % 10 == 0) row.obscuration_semi_diameter = std::min(*row.semi_diameter, scale) * 0.3;
    if (kind == 1) row.conic = uniform(random, -20, 5);
    if (kind == 2 && row.radius != 0) row.curved_in = random() % 2 ? petzval::Section::x : petzval::Section::y;
    if (kind == 3) {
      for (const int order : {3, 4, 6, 7})
        row.aspheric.push_back({order, uniform(random, -0.2, 0.2) * std::pow(scale, 1 - order)});
    }
    if (random() % 12 == 0) {
      row.mirror = true;
      row.medium = p.surfaces.empty() ? petzval::Medium{} : p.surfaces.back().medium;
    }
    row.stop = i == count / 2;
    p.surfaces.push_back(std::move(row));
  }
  return petzval::compile(p);
}

/// Random rays, some with absurd positions or directions.
template <class T>
Ray<T> random_ray(Random& random, double scale) {
  constexpr auto limits = std::numeric_limits<T>();
  const std::array<T, 10> absurd{0,
                                 -T(0),
                                 1,
                                 limits.max(),
                                 -limits.max(),
                                 limits.min(),
                                 limits.denorm_min(),
                                 limits.quiet_NaN(),
                                 limits.infinity(),
                                 T(1e18)};
  Ray<T> ray;
  const double x = uniform(random, -0.4, 0.4), y = uniform(random, -0.4, 0.4);
  ray.direction = {static_cast<T>(x), static_cast<T>(y),
                   static_cast<T>((random() % 8 ? 1 : -1) * std::sqrt(1 - x * x - y * y))};
  for (int i = 0; i < 3; ++i) ray.origin[i] = static_cast<T>(scale * uniform(random, -1.5, 1.5));
  if (random() % 4 == 0) ray.origin[static_cast<int>(random() % 3)] = absurd[random() % absurd.size()];
  if (random() % 8 == 0) ray.direction[static_cast<int>(random() % 3)] = absurd[random() % absurd.size()];
  return ray;
}

template <class T>
class Robust : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(Robust, Plain);

TYPED_TEST(Robust, ResultsAreFiniteForAnyLens) {
  using T = TypeParam;
  Random random(2024);
  std::array<int, 5> fates{};
  for (int lens_number = 0; lens_number < 1000; ++lens_number) {
    const petzval::Lens lens = random_lens(random);
    double scale = 1;
    for (const auto& s : lens.surfaces()) scale = std::max(std::abs(s.thickness), scale * (s.vertex_z == 0 ? 0 : 1));
    for (int i = 0; i < 500; ++i) {
      const Ray<T> ray = random_ray<T>(random, scale);
      const Travel travel = random() % 2 ? Travel::to_film : Travel::to_scene;
      const TracedRay<T> end = petzval::trace(lens, ray, {.travel = travel, .apertures = random() % 2 == 0});
      ASSERT_TRUE(finite(end.ray)) << "lens " << lens_number << " ray " << i;
      ASSERT_LE(static_cast<std::size_t>(end.fate), 4u) << "lens " << lens_number << " ray " << i;
      ASSERT_GE(end.surface, 0) << "lens " << lens_number << " ray " << i;
      ASSERT_LT(end.surface, static_cast<int>(lens.surface_count())) << "lens " << lens_number << " ray " << i;
      ++fates[static_cast<std::size_t>(end.fate)];
    }
  }
  // Every fate occurred except the last, which should be rare.
  for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(fates[i], 1000) << petzval::name(static_cast<RayFate>(i));
  EXPECT_LT(fates[4], 50);
  this->RecordProperty("no_convergence", fates[4]);
}

TEST(Robust, MissedRaysEndOnTheSurfaceBefore) {
  petzval::Prescription p;
  p.name = "window and ball";
  p.surfaces = {{.radius = 0, .thickness = 5}, {.radius = 10, .thickness = 20, .medium = {.nd = 1.5}}};
  const petzval::Lens lens = petzval::compile(p);
  for (const auto travel : {Travel::to_film, Travel::to_scene}) {
    const double sense = travel == Travel::to_film ? 1 : -1;
    const auto end = petzval::trace(lens, Ray<double>{{0, 11, 40}, {0, 0, sense}}, {.travel = travel});
    EXPECT_EQ(end.fate, RayFate::missed_surface);
    EXPECT_EQ(end.surface, 1);
    EXPECT_EQ(end.ray.origin, petzval::Vec3<double>(0, 11, travel == Travel::to_film ? 0 : 40));
    EXPECT_EQ(end.ray.direction, petzval::Vec3<double>(0, 0, sense));
  }
}

TEST(Robust, InvalidRaysAreMisses) {
  const auto lens = testing_lenses::load("double_gauss_100mm_f2.0").lens;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const int last = static_cast<int>(lens.surface_count()) - 1;
  for (const Ray<double>& ray : {Ray<double>{{nan, 0, 0}, {0, 0, 1}}, Ray<double>{{0, inf, 0}, {0, 0, 1}},
                                 Ray<double>{{0, 0, -9}, {0, 0, 0}}, Ray<double>{{0, 0, -9}, {0, 0, 1e200}},
                                 Ray<double>{{0, 0, -9}, {0, 0, 1.1}}, Ray<double>{{0, 0, -9}, {0, nan, 1}}}) {
    const auto in = petzval::trace(lens, ray);
    EXPECT_EQ(in.fate, RayFate::missed_surface);
    EXPECT_EQ(in.surface, 0);
    EXPECT_TRUE(finite(in.ray));
    const auto out = petzval::trace(lens, ray, {.travel = Travel::to_scene});
    EXPECT_EQ(out.fate, RayFate::missed_surface);
    EXPECT_EQ(out.surface, last);
  }
}

TEST(Robust, MissingWavelengthLosesEveryRay) {
  const auto lens = testing_lenses::load("double_gauss_100mm_f2.0").lens;
  const Ray<double> axial{{0, 0, -9}, {0, 0, 1}};
  EXPECT_TRUE(petzval::trace(lens, axial, {.wavelength = 0}).transmitted());
  for (const std::size_t beyond : {std::size_t{1}, std::size_t{1000000}, static_cast<std::size_t>(-1)}) {
    const auto end = petzval::trace(lens, axial, {.wavelength = beyond});
    EXPECT_EQ(end.fate, RayFate::missed_surface);
    EXPECT_EQ(end.surface, 0);
  }
}

// Reproducible batches are equal on every instruction set, also if the fates of lanes differ.
TYPED_TEST(Robust, ResultsAreFiniteForAnyBatch) {
  using T = TypeParam;
  Random random(2025);
  std::size_t rays_met = 0, otherwise = 0;
  for (int lens_number = 0; lens_number < 250; ++lens_number) {
    const petzval::Lens lens = random_lens(random);
    double scale = 1;
    for (const auto& s : lens.surfaces()) scale = std::max(std::abs(s.thickness), scale * (s.vertex_z == 0 ? 0 : 1));
    std::vector<Ray<T>> rays(100);
    for (auto& ray : rays) ray = random_ray<T>(random, scale);
    const bool apertures = random() % 2 == 0;
    const Travel travel = random() % 2 ? Travel::to_film : Travel::to_scene;
    std::optional<testing_batches::Answer<T>> first;
    for (auto options : testing_batches::every_batch(travel)) {  // fast options first
      options.apertures = apertures;
      const auto answer = testing_batches::traced(lens, rays, options);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::string what =
            testing_batches::text(options) + " lens " + std::to_string(lens_number) + " ray " + std::to_string(i);
        ASSERT_TRUE(finite(answer.rays[i])) << what;
        ASSERT_LE(static_cast<std::size_t>(answer.fates[i]), 4u) << what;
        ASSERT_GE(answer.surfaces[i], 0) << what;
        ASSERT_LT(answer.surfaces[i], static_cast<int>(lens.surface_count())) << what;
        ASSERT_TRUE(!first || same_bits(answer, i, *first, i)) << what;
        const auto one = petzval::trace(lens, rays[i], {.travel = travel, .apertures = apertures});
        ++rays_met;
        otherwise += one.fate != answer.fates[i] || one.surface != answer.surfaces[i];
      }
      if (options.arithmetic == petzval::Arithmetic::reproducible && !first) first = answer;
    }
  }
  // One ray in eight starts at the limits of the type, where only rounding decides.
  EXPECT_LT(otherwise, rays_met / 100);
  this->RecordProperty("otherwise", static_cast<int>(otherwise));
}

/// True if the end of the ray lies on the last surface, a sphere, and its direction has unit length.
template <class T>
void expect_right(const petzval::Lens& lens, const Ray<T>& end, const std::string& what) {
  // A hit may lose half of its digits; the tolerance is twice the largest error.
  const double near = 8 * std::sqrt(double{std::numeric_limits<T>::epsilon()});
  const petzval::Vec3<double> o(end.origin), d(end.direction);
  const auto& last = lens.surfaces().back();
  const double z = o.z - last.vertex_z - 1 / last.curvature;
  EXPECT_NEAR(std::hypot(d.x, d.y, d.z), 1, near) << what;
  EXPECT_NEAR(std::hypot(o.x, o.y, z) * std::abs(last.curvature), 1, near) << what;
}

// A grazing ray meets a plane so far out that the next sphere is a point, and the digits of its hit may be lost.
TYPED_TEST(Robust, RaysThatMeetAPlaneFarOutAreLostOrCorrect) {
  using T = TypeParam;
  std::vector<petzval::Lens> lenses{testing_lenses::load("ball_10mm").lens};
  // The plane refracts, and the second sphere has a large radius.
  petzval::Prescription p;
  p.name = "window and ball";
  p.surfaces = {{.radius = 0, .thickness = 5, .medium = {.nd = 1.0000001}},
                {.radius = 1e9, .thickness = 1, .medium = {.nd = 1}},
                {.radius = 7, .thickness = 14, .medium = {.nd = 1.5}},
                {.radius = -7, .thickness = 2, .medium = {.nd = 1}}};
  lenses.push_back(petzval::compile(p));
  int passed = 0, lost = 0;
  for (const petzval::Lens& lens : lenses) {
    std::vector<Ray<T>> rays;
    const double middle = lens.surfaces().back().vertex_z + 1 / lens.surfaces().back().curvature;
    for (int k = 0; k <= 70; ++k) {
      for (const double away : {-1.3, -0.95, -0.5, -0.1}) {
        const double slope = std::pow(10.0, -0.2 * k);
        rays.push_back({{T(6.2), T(0), static_cast<T>(middle + away)},
                        {static_cast<T>(std::sqrt(1 - slope * slope)), T(0), static_cast<T>(slope)}});
      }
    }
    for (auto options : testing_batches::every_batch()) {
      options.apertures = false;
      const auto answer = testing_batches::traced(lens, rays, options);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::string what = lens.name() + ", ray " + std::to_string(i) + ", " + testing_batches::text(options);
        const bool transmitted = answer.fates[i] == RayFate::transmitted;
        if (transmitted) expect_right(lens, answer.rays[i], what);
        ++(transmitted ? passed : lost);
      }
    }
    for (const Ray<T>& ray : rays) {
      const auto end = petzval::trace(lens, ray, {.apertures = false});
      if (end.transmitted()) expect_right(lens, end.ray, lens.name() + ", one ray");
    }
  }
  EXPECT_GT(passed, 10);
  EXPECT_GT(lost, 10);
  // A ray that fuzzing found: every tracer loses it at the plane.
  if constexpr (std::is_same_v<T, double>) {
    const Ray<double> ray{{6.2, 0, 9.05}, {std::sqrt(1 - 1e-24), 0, 1e-12}};
    for (auto options : testing_batches::every_batch()) {
      options.apertures = false;
      const auto answer = testing_batches::traced(lenses[0], std::vector<Ray<double>>(3, ray), options);
      EXPECT_EQ(answer.fates[1], RayFate::vignetted) << testing_batches::text(options);
      EXPECT_EQ(answer.surfaces[1], 0);
    }
  }
}

// Cylinders are unbounded along their axis: at 4e25 mm directions lost their unit length.
TEST(Robust, RaysThatMeetASurfaceBeyond1e15MmAreLost) {
  petzval::Prescription p;
  p.name = "cylinder";
  p.surfaces = {
      {.radius = 2, .thickness = 4, .medium = {.nd = 1.5}, .aspheric = {{4, 1e-3}}, .curved_in = petzval::Section::y},
      {.thickness = 2}};
  const petzval::Lens lens = petzval::compile(p);
  for (const double x : {1e14, 4e25}) {
    const Ray<double> ray{{x, 0.5, -3}, {0.28, 0.28, std::sqrt(1 - 2 * 0.28 * 0.28)}};
    const auto end = petzval::trace(lens, ray, {.apertures = false});
    EXPECT_EQ(end.fate, x < 1e15 ? RayFate::transmitted : RayFate::vignetted) << x;
    EXPECT_EQ(end.surface, x < 1e15 ? 1 : 0) << x;
  }
}

}  // namespace robust_test
