// SPDX-License-Identifier: Apache-2.0
// The hits of single rays and batches on surfaces that steep rays cross several times, compared with a scan in long
// double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "../asphere_scan.hpp"
#include "batches.hpp"

namespace asphere_search_test {

using petzval::Ray;
using petzval::RayFate;
using petzval::Travel;
using testing_aspheres::scan;
using testing_batches::traced;
using Vec = petzval::kernel::Vec<double>;

/// Rays through points of the surface or its surroundings, most of them steep.
template <class T>
std::vector<Ray<T>> steep_rays(const petzval::SurfaceRow& row, std::mt19937& random, double height, std::size_t count,
                               double sense) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random);
  };
  std::vector<Ray<T>> rays;
  while (rays.size() < count) {
    const double reach = height * std::sqrt(uniform(0, 1.2)), turn = uniform(0, 6.3), heading = uniform(0, 6.3);
    const double cosine = sense * std::pow(uniform(0.15, 1), 2), slope = std::sqrt(1 - cosine * cosine);
    const auto z = static_cast<double>(testing_aspheres::Sag{row}.value(std::min(reach, height)));
    const double d[3] = {slope * std::cos(heading), slope * std::sin(heading), cosine};
    const double at[3] = {reach * std::cos(turn), reach * std::sin(turn), z}, back = height * uniform(0.5, 2);
    Ray<T> ray;
    for (int k = 0; k < 3; ++k) {
      ray.origin[k] = static_cast<T>(at[k] - back * d[k]);
      ray.direction[k] = static_cast<T>(d[k]);
    }
    rays.push_back(ray);
  }
  return rays;
}

struct Count {
  int rays = 0, several = 0, doubtful = 0, wrong = 0, unsettled = 0;
};

/// Between equal media a ray keeps its direction and starts from its hit.
template <class T>
void judge(const petzval::SurfaceRow& row, std::mt19937& random, const std::string& what, Count& count) {
  const petzval::Lens lens = testing_lenses::one_surface(row);
  const double height = petzval::kernel::view<double>(lens).aspheres[0].height;
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    const int sense = travel == Travel::to_film ? 1 : -1;
    const auto rays = steep_rays<T>(row, random, height, 64, sense);
    std::vector<std::optional<std::vector<testing_aspheres::Crossing>>> crossings;
    for (const Ray<T>& ray : rays) {
      const auto &o = ray.origin, &d = ray.direction;
      crossings.push_back(scan(row, height, Vec{o.x, o.y, o.z}, Vec{d.x, d.y, d.z}, sense));
      ++count.rays;
      count.doubtful += !crossings.back();
      count.several += crossings.back() && crossings.back()->size() > 1;
    }
    const auto check = [&](std::size_t i, RayFate fate, const petzval::Vec3<double>& hit, const std::string& how) {
      count.unsettled += fate == RayFate::no_convergence;
      if (!crossings[i]) return;
      const petzval::Vec3<double> o(rays[i].origin), d(rays[i].direction);
      const bool transmitted = fate == RayFate::transmitted;
      bool right = !(transmitted && std::hypot(hit.x, hit.y) < height * (1 - 1e-5));
      if (!crossings[i]->empty()) {
        const petzval::Vec3<double> point = o + d * crossings[i]->front().t;
        if (std::hypot(point.x, point.y) > height * (1 - 1e-5)) return;
        const petzval::Vec3<double> off = hit - point;
        right = transmitted && std::hypot(off.x, off.y, off.z) < 1e-3 * height;
      }
      if (!right && ++count.wrong <= 10) {
        ADD_FAILURE() << what << ", " << how << ", ray " << i << ": " << petzval::name(fate) << " at " << hit.x << " "
                      << hit.y << " " << hit.z;
      }
    };
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto one = petzval::trace(lens, rays[i], {.travel = travel});
      check(i, one.fate, petzval::Vec3<double>(one.ray.origin), "one ray");
    }
    for (const auto& options : testing_batches::every_batch(travel)) {
      const auto answer = traced(lens, rays, options);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        check(i, answer.fates[i], petzval::Vec3<double>(answer.rays[i].origin), testing_batches::text(options));
      }
    }
  }
}

template <class T>
class AsphereSearch : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(AsphereSearch, Plain);

TYPED_TEST(AsphereSearch, FindsTheFirstCrossingOfEveryLane) {
  std::mt19937 random(17);
  Count count;
  for (int i = 0; i < 100; ++i) {
    judge<TypeParam>(testing_aspheres::wild(random), random, "wild " + std::to_string(i), count);
  }
  EXPECT_EQ(count.wrong, 0);
  EXPECT_EQ(count.unsettled, 0);
  EXPECT_GT(count.several, count.rays / 300) << "the rays are too easy";
  EXPECT_LT(count.doubtful, count.rays / 5);
}

/// Without a rim, a term of 1e-10 mm moves hits by at most 1e-10 mm, although its slope is large at 1e12 mm.
TYPED_TEST(AsphereSearch, WeakTermsChangeHitsByTheirSize) {
  using T = TypeParam;
  constexpr double eps = std::numeric_limits<T>::epsilon();
  testing_batches::Numbers random(5);
  std::vector<Ray<T>> rays;
  for (int i = 0; i < 1000; ++i) {
    const double x = random(-0.7, 0.7), y = random(-0.7, 0.7);
    const petzval::Vec3<double> at{random(-20, 20), random(-20, 20), random(-20, 20)};
    rays.push_back(testing_batches::through<T>(at, {x, y, std::sqrt(1 - x * x - y * y)}, 5));
  }
  int missed = 0;
  for (const double radius : {0.0, -400.0, 60.0}) {
    for (const double conic : {-2.46, -1.0, 0.3}) {
      petzval::SurfaceRow row;
      row.radius = radius, row.conic = conic;
      const petzval::Lens base = testing_lenses::one_surface(row);
      row.aspheric = {{2, 1e-13}};
      const petzval::Lens asphere = testing_lenses::one_surface(row);
      for (const auto& options : testing_batches::every_batch()) {
        const auto wanted = traced(base, rays, options), found = traced(asphere, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const petzval::Vec3<double> hit(wanted.rays[i].origin), other(found.rays[i].origin), off = other - hit;
          const double size = 20 + std::hypot(hit.x, hit.y, hit.z), near = 1000 * eps * size + 1e-12 * size * size;
          const bool passes = wanted.fates[i] == RayFate::transmitted;
          missed += !passes;
          const bool found_one = found.fates[i] == RayFate::transmitted;
          if (found_one != passes || (passes && !(std::hypot(off.x, off.y, off.z) < near))) {
            ADD_FAILURE() << "R " << radius << ", conic " << conic << ", " << testing_batches::text(options) << ", ray "
                          << i << ": " << petzval::name(found.fates[i]) << " at " << other.x << " " << other.y << " "
                          << other.z << ", expected " << petzval::name(wanted.fates[i]) << " at " << hit.x << " "
                          << hit.y << " " << hit.z;
          }
        }
      }
    }
  }
  EXPECT_GT(missed, 100);
}

/// The slope of this asphere is 4 at 5.83 mm, where its clear aperture ends.
TYPED_TEST(AsphereSearch, RimsEndWhereAspheresAreSteep) {
  petzval::SurfaceRow row;
  row.radius = 177.4, row.semi_diameter = 21.3;
  row.aspheric = {{7, -1.451e-5}};
  const petzval::Lens lens = testing_lenses::one_surface(row);
  const double height = petzval::kernel::view<double>(lens).aspheres[0].height;
  EXPECT_NEAR(height, 5.83, 0.03);
  std::mt19937 random(3);
  const auto rays = steep_rays<TypeParam>(row, random, 1.3 * height, 2000, 1);
  for (const auto& options : testing_batches::every_batch()) {
    const auto found = traced(lens, rays, options);
    int passing = 0, beyond = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (found.fates[i] != RayFate::transmitted) continue;
      ++passing;
      beyond += std::hypot(found.rays[i].origin.x, found.rays[i].origin.y) > height * (1 + 1e-5);
    }
    EXPECT_GT(passing, 500) << testing_batches::text(options);
    EXPECT_EQ(beyond, 0) << testing_batches::text(options);
  }
}

}  // namespace asphere_search_test
