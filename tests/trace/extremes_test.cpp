// SPDX-License-Identifier: Apache-2.0
// Single surfaces at the limits of surfaces and rays. Single rays and batches of both arithmetics on every instruction
// set are compared with rays in long double.
//
// The unit of errors is the change of the exact ray for a change of one eps in each of its numbers, plus one eps of the
// height or of a unit direction. On a single surface an error is about
// |dP| cos(incidence) / (eps (height + distance slope)) units.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../digits.hpp"
#include "limits.hpp"

namespace extremes_test {

using namespace testing_limits;
using petzval::Prescription;
using petzval::Section;
using petzval::SurfaceRow;
using petzval::Vec3;
using testing_batches::Numbers;
using testing_batches::text;
using testing_batches::through;
using testing_lenses::one_surface;

template <class T>
class ExtremesOf : public testing::Test {};
using Plain = testing::Types<float, double>;
TYPED_TEST_SUITE(ExtremesOf, Plain);

SurfaceRow glass(double radius, double conic = 0, double n = 1.5) {
  SurfaceRow row;
  row.radius = radius;
  row.conic = conic;
  row.medium.nd = n;
  return row;
}

double sag_at(const SurfaceRow& row, double x, double y) {
  const double c = row.radius == 0 ? 0 : 1 / row.radius;
  const double r2 = (row.curved_in == Section::y ? 0 : x * x) + (row.curved_in == Section::x ? 0 : y * y);
  return c * r2 / (1 + std::sqrt(1 - (1 + row.conic) * c * c * r2));
}

/// The height of the equator of a conic.
double equator(const SurfaceRow& row) {
  return row.radius == 0 || row.conic <= -1 ? std::numeric_limits<double>::infinity()
                                            : std::abs(row.radius) / std::sqrt(1 + row.conic);
}

struct Sweep {
  double height = 20, slope = 0.5, distance = 5;
  std::size_t rays = 200;
};

/// Skew rays to points within the height, from 0.5 to 1.5 of the distance. side: sign of z of their directions.
template <class T>
std::vector<Ray<T>> skew_rays(const SurfaceRow& row, const Sweep& sweep, double side) {
  Numbers random(7);
  std::vector<Ray<T>> rays;
  while (rays.size() < sweep.rays) {
    const double x = sweep.height * random(-1, 1), y = sweep.height * random(-1, 1);
    if (!(x * x + y * y <= sweep.height * sweep.height)) continue;
    const double turn = random(0, 2 * std::numbers::pi), slope = sweep.slope * random(0, 1);
    rays.push_back(through<T>({x, y, sag_at(row, x, y)}, {slope * std::cos(turn), slope * std::sin(turn), side},
                              sweep.distance * random(0.5, 1.5)));
  }
  return rays;
}

/// Skew rays through a surface in both directions.
template <class T>
void both_ways(Judge<T>& judge, const SurfaceRow& row, Sweep sweep, const std::string& what, double n_in = 1) {
  const double limit = 0.95 * equator(row);
  if (sweep.height > limit) {
    sweep.distance *= std::min(1.0, limit);
    sweep.height = limit;
  }
  const Lens lens = one_surface(row, n_in);
  const Floors floors{.place = sweep.height};
  judge(lens, skew_rays<T>(row, sweep, 1), Travel::to_film, floors, what + " to film");
  judge(lens, skew_rays<T>(row, sweep, row.mirror ? 1 : -1), Travel::to_scene, floors, what + " to scene");
}

TYPED_TEST(ExtremesOf, EveryRadius) {
  Judge<TypeParam> judge;
  for (const double radius : {1e-9, 1e-6, 1e-3, 1.0, 50.0, 1e3, 1e5, 1e7, 1e12, 1e300, 0.0}) {
    for (const double sign : {1.0, -1.0}) {
      both_ways(judge, glass(sign * radius), {}, "radius " + petzval::testing::digits(sign * radius));
    }
  }
  judge.close("radius 1e-9 to 1e12 mm and plane", 4);
}

TYPED_TEST(ExtremesOf, EveryConic) {
  Judge<TypeParam> judge;
  const double ulp = std::numeric_limits<double>::epsilon();
  for (const double k :
       {-1e6, -100.0, -2.25, -1 - 1e-4, -1 - 2 * ulp, -1 - ulp, -1.0, -1 + ulp, -1 + 1e-4, -0.5, 1.0, 3.0, 5.0}) {
    for (const double radius : {50.0, -50.0, 200.0}) {
      for (const double distance : {5.0, 100.0}) {
        both_ways(judge, glass(radius, k), {.distance = distance},
                  "k " + petzval::testing::digits(k) + " radius " + petzval::testing::digits(radius));
      }
    }
  }
  judge.close("conic -1e6 to 5, skew rays", 4);
}

TYPED_TEST(ExtremesOf, CylindersAndMirrors) {
  Judge<TypeParam> judge;
  for (const double radius : {2.5, -50.0, 1e7}) {
    for (const double k : {-1.5, 0.0, 1.0}) {
      SurfaceRow row = glass(radius, k);
      const std::string what = "radius " + petzval::testing::digits(radius) + " k " + petzval::testing::digits(k);
      row.curved_in = Section::x;
      both_ways(judge, row, {}, "cylinder in x, " + what);
      row.curved_in = Section::y;
      both_ways(judge, row, {}, "cylinder in y, " + what);
      row = glass(radius, k, 1);
      row.mirror = true;
      both_ways(judge, row, {}, "mirror, " + what);
    }
  }
  judge.close("cylinders and mirrors", 6);
}

TYPED_TEST(ExtremesOf, Aspheres) {
  Judge<TypeParam> judge;
  const auto asphere = [](double radius, double conic, double rim, std::vector<petzval::AsphereTerm> terms) {
    SurfaceRow row = glass(radius, conic);
    row.semi_diameter = rim;
    row.aspheric = std::move(terms);
    return row;
  };
  for (const SurfaceRow& row :
       {asphere(40, -0.5, 18, {{4, -2e-6}, {6, 3e-9}, {8, -4e-12}}),
        asphere(1.674, -8.617, 2.5, {{3, 0.07429}, {4, -0.06933}, {5, -0.005811}, {6, 0.002396}, {7, 0.0021}}),
        asphere(2.2, -1, 2.8, {{4, -0.085}, {6, 0.0075}, {8, -0.0002}}), asphere(1000, 0, 300, {{16, 1e-41}}),
        asphere(0, 0, 3, {{2, 0.5}, {4, -0.15}, {6, 0.0105}})}) {
    const double rim = *row.semi_diameter;
    both_ways(judge, row, {.height = rim, .slope = 0.8, .distance = rim},
              "asphere, rim " + petzval::testing::digits(rim));
  }
  judge.close("aspheres, gull wings among them, steep rays", 8);
}

TYPED_TEST(ExtremesOf, GrazingRays) {
  Judge<TypeParam> judge;
  for (const double k : {0.0, -0.5, -1.0, 1.0}) {
    const SurfaceRow row = glass(50, k);
    const Lens lens = one_surface(row);
    for (const double grazing : {0.1, 1e-2, 1e-3, 1e-5}) {
      Numbers random(8);
      std::vector<Ray<TypeParam>> rays;
      for (int i = 0; i < 200; ++i) {
        const double x = random(-21, 21), y = random(-21, 21), z = sag_at(row, x, y);
        // A direction in the tangent plane, raised by the grazing angle.
        const double turn = random(0, 2 * std::numbers::pi), c = 1 / row.radius;
        const double nx = -c * x, ny = -c * y, nz = 1 - c * (1 + k) * z, n = std::sqrt(nx * nx + ny * ny + nz * nz);
        Vec3<double> along{std::cos(turn), std::sin(turn), 0};
        along.z = -(nx * along.x + ny * along.y) / nz;
        along /= std::sqrt(along.x * along.x + along.y * along.y + along.z * along.z);
        along += Vec3<double>{nx, ny, nz} * (grazing / n);
        rays.push_back(through<TypeParam>({x, y, z}, along, 5));
      }
      judge(lens, rays, Travel::to_film, {.place = 30},
            "k " + petzval::testing::digits(k) + " grazing " + petzval::testing::digits(grazing));
    }
  }
  judge.close("grazing to 1e-5 rad", 4);
}

// On fisheyes a ray towards the film may run towards -z.
TYPED_TEST(ExtremesOf, RaysAcrossAndAgainstTheAxis) {
  Judge<TypeParam> judge;
  for (const double radius : {50.0, -50.0}) {
    const SurfaceRow row = glass(radius);
    const Lens lens = one_surface(row);
    for (const double degrees : {74.0, 80.0, 86.0, 89.4, 89.95, 90.0, 95.0, 110.0, 130.0}) {
      const double angle = degrees * std::numbers::pi / 180;
      for (const double side : {1.0, -1.0}) {
        Numbers random(9);
        std::vector<Ray<TypeParam>> rays;
        for (int i = 0; i < 200; ++i) {
          const double x = random(-34, 34), y = random(-34, 34), turn = random(0, 2 * std::numbers::pi);
          rays.push_back(through<TypeParam>(
              {x, y, sag_at(row, x, y)},
              {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), side * std::cos(angle)}, 7));
        }
        judge(lens, rays, side > 0 ? Travel::to_film : Travel::to_scene, {.place = 48},
              petzval::testing::digits(degrees) + " degrees, radius " + petzval::testing::digits(radius));
      }
    }
  }
  judge.close("rays 74 to 130 degrees off axis", 4, 0.1);
}

TYPED_TEST(ExtremesOf, FarStarts) {
  Judge<TypeParam> judge;
  for (const double k : {0.0, -0.7, -100.0}) {
    for (const double distance : {1e2, 1e3, 1e4, 1e6, 1e9}) {
      for (const double slope : {0.3, 20 / distance, 0.0}) {
        both_ways(judge, glass(50, k), {.slope = slope, .distance = distance},
                  "k " + petzval::testing::digits(k) + " from " + petzval::testing::digits(distance));
      }
    }
  }
  judge.close("start up to 1e9 mm away", 4);
}

TEST(Extremes, HitsFromAKilometreAwayLieOnTheSurface) {
  double most = 0;
  for (const double k : {0.0, -0.7, -1.0, 0.5}) {
    const SurfaceRow row = glass(50, k, 1);
    const Lens lens = one_surface(row);
    Numbers random(10);
    std::vector<Ray<double>> rays;
    for (int i = 0; i < 1000; ++i) {
      rays.push_back(
          through<double>({random(-14, 14), random(-14, 14), 0}, {random(-0.4, 0.4), random(-0.4, 0.4), 1}, 1e6));
    }
    for (const auto& options : testing_batches::every_batch()) {
      const auto answer = testing_batches::traced(lens, rays, options);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(answer.fates[i], RayFate::transmitted);
        const Vec3<double> p = answer.rays[i].origin;
        const double off = std::abs((p.x * p.x + p.y * p.y + (1 + k) * p.z * p.z) / 100 - p.z);
        EXPECT_LE(off, 2e-14) << "k " << k << " " << text(options) << " ray " << i;
        most = std::max(most, off);
      }
    }
  }
  testing_report::put("off the surface, start 1 km away", testing_report::batch<double>,
                      petzval::testing::digits(most, 2) + " mm", "2e-14 mm");
}

TYPED_TEST(ExtremesOf, NearlyEqualIndices) {
  Judge<TypeParam> judge;
  for (const double difference : {1e-9, -1e-9, 1e-6, -1e-6, 1e-3, -1e-3, 0.0}) {
    for (const double radius : {50.0, -30.0, 0.0}) {
      both_ways(judge, glass(radius, 0, 1.5 * (1 + difference)), {}, "indices " + petzval::testing::digits(difference),
                1.5);
    }
  }
  judge.close("index ratio to 1 +- 1e-9", 4);
}

TYPED_TEST(ExtremesOf, EqualMediaKeepDirectionsWithinOneEps) {
  using T = TypeParam;
  double most = 0;
  for (const double n : {1.0, 1.5, 1.7283}) {
    for (SurfaceRow row : {glass(50, 0, n), glass(-30, -2.5, n), glass(0, 0, n)}) {
      const Lens lens = one_surface(row, n);
      const auto rays = skew_rays<T>(row, {}, 1);
      for (const auto& options : testing_batches::every_batch()) {
        const auto answer = testing_batches::traced(lens, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          ASSERT_EQ(answer.fates[i], RayFate::transmitted) << text(options);
          for (int k = 0; k < 3; ++k) {
            const double off = std::abs(static_cast<double>(answer.rays[i].direction[k]) - rays[i].direction[k]);
            most = std::max(most, off / std::numeric_limits<T>::epsilon());
          }
        }
      }
    }
  }
  EXPECT_LE(most, 1);
  testing_report::put("equal indices, change of direction", testing_report::batch<T>, petzval::testing::digits(most, 2),
                      "1 eps");
}

// The next surface may lie in front of the start of the ray, because sags of prescriptions may overlap.
TYPED_TEST(ExtremesOf, FromSurfaceToSurface) {
  Judge<TypeParam> judge;
  for (const double first : {20.0, -20.0, 60.0, 0.0}) {
    for (const double second : {20.0, -20.0, 21.0, -60.0, 1e3, 0.0}) {
      for (const double gap : {0.0, 0.5, 15.0, 19.0, 40.0}) {
        for (const double n : {1.0, 1.8}) {  // behind the first surface; without refraction rays stay steep
          SurfaceRow front = glass(first, 0, n);
          front.thickness = gap;
          Prescription p;
          p.name = "two surfaces";
          p.surfaces = {front, glass(second, 0, 1.5)};
          const Lens lens = petzval::compile(p);
          const Sweep sweep{.height = 18, .slope = 8, .rays = 60};
          const std::string what = "radii " + petzval::testing::digits(first) + " " + petzval::testing::digits(second) +
                                   " gap " + petzval::testing::digits(gap) + " n " + petzval::testing::digits(n);
          judge(lens, skew_rays<TypeParam>(front, sweep, 1), Travel::to_film, {.place = 20}, what + " to film");
          auto back = skew_rays<TypeParam>(p.surfaces[1], sweep, -1);
          for (auto& ray : back) ray.origin.z += static_cast<TypeParam>(gap);
          judge(lens, back, Travel::to_scene, {.place = 20}, what + " to scene");
        }
      }
    }
  }
  judge.close("from surface to surface, overlapping and steep", 16, 0.1);
}

/// Weak lenses of 400 mm focal length, 4 mm apart, which keep rays near the axis.
Lens guide(int surfaces) {
  Prescription p;
  p.name = "guide";
  for (int i = 0; i < surfaces; ++i) {
    SurfaceRow row = i % 2 ? glass(-400, 0, 1) : glass(400);
    row.thickness = 2;
    row.semi_diameter = 20;
    p.surfaces.push_back(row);
  }
  return petzval::compile(p);
}

TYPED_TEST(ExtremesOf, AThousandSurfaces) {
  Judge<TypeParam> judge;
  for (const Travel travel : {Travel::to_film, Travel::to_scene}) {
    const Lens lens = guide(1000);
    Numbers random(11);
    std::vector<Ray<TypeParam>> rays;
    for (int i = 0; i < 100; ++i) {
      const bool to_film = travel == Travel::to_film;
      rays.push_back(through<TypeParam>({random(-5, 5), random(-5, 5), to_film ? 0 : lens.surfaces().back().vertex_z},
                                        {random(-0.02, 0.02), random(-0.02, 0.02), to_film ? 1 : -1}, 3));
    }
    judge(lens, rays, travel, {.place = 5, .turn = 1}, "guide");
  }
  judge.close("1000 surfaces", 60);
}

TYPED_TEST(ExtremesOf, BackwardRaysIntoAFisheye) {
  using T = TypeParam;
  const auto sample = testing_lenses::load("fisheye_6.3mm_f2.8");
  // Rays start at the stop, because few rays that meet the front in direction -z pass.
  const auto view = petzval::kernel::view<double>(sample.lens);
  const std::size_t stop = sample.lens.stop().value();
  Numbers random(12);
  std::vector<Ray<T>> rays;
  for (int i = 0; i < 20000 && rays.size() < 200; ++i) {
    const double reach = 0.9 * sample.lens.surfaces()[stop].semi_diameter, slope = random(0, 0.5);
    const double turn = random(0, 2 * std::numbers::pi);
    const auto start = through<double>({reach * random(-0.7, 0.7), reach * random(-0.7, 0.7), view.vertex_z[stop]},
                                       {slope * std::cos(turn), slope * std::sin(turn), -1}, 0);
    const auto out =
        petzval::kernel::trace(view, petzval::kernel::to_kernel(start.origin),
                               petzval::kernel::to_kernel(start.direction), {.travel = Travel::to_scene, .last = stop});
    if (out.fate != RayFate::transmitted || out.direction.z < 0) continue;
    rays.push_back(through<T>(petzval::kernel::to_public(out.origin), -petzval::kernel::to_public(out.direction), 20));
  }
  ASSERT_GE(rays.size(), 20u);
  Judge<T> judge;
  judge(sample.lens, rays, Travel::to_film, {.place = sample.size, .turn = 1}, "fisheye");
  judge.close("fisheye, rays from behind its front", 4);
}

}  // namespace extremes_test
