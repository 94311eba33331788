// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/aim.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "../report.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "trace/sequential.hpp"

namespace petzval {
namespace aim_test {

using testing::data_lens;
using testing::data_prescriptions;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The centre of the stop and eight points on its rim.
std::vector<Vec2<double>> places() {
  std::vector<Vec2<double>> result{{}};
  for (int i = 0; i < 8; ++i) result.push_back({std::sin(radians(45.0 * i)), std::cos(radians(45.0 * i))});
  return result;
}

/// Distance of a traced ray from its target on the stop, in semi-diameters of the stop.
double miss(const Lens& lens, const Ray<double>& ray, const Vec2<double>& target) {
  const std::size_t stop = pupils(lens).stop;
  Vec3<double> hit{infinity, infinity, infinity};
  kernel::trace(petzval::kernel::view<double>(lens), kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction),
                {.apertures = false}, [&](int surface, const kernel::Vec<double>& point, const kernel::Vec<double>&) {
                  if (surface == static_cast<int>(stop)) hit = kernel::to_public(point);
                });
  const double radius = lens.surfaces()[stop].semi_diameter;
  return std::hypot(hit.x / radius - target.x, hit.y / radius - target.y);
}

TEST(Aim, ReachesStopTargetsOfEveryLens) {
  double worst = 0;
  int chief_rays = 0, rays = 0;
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    for (const double part : {0.0, 0.3, 0.7, 0.9, 1.0}) {
      const double field = radians(part * p.half_field_deg.value_or(10));
      for (const double z : {-infinity, -1e7, -100 * std::abs(first_order(lens).effective_focal_length)}) {
        if (std::isfinite(z) && field > radians(89)) continue;
        for (const Vec2<double>& target : places()) {
          const AimedRay aimed = aim(lens, {field, z}, target);
          const bool chief = target.x == 0 && target.y == 0;
          EXPECT_TRUE(aimed || !chief) << part;  // rays through the rim may be vignetted by another surface
          if (!aimed) continue;
          chief_rays += chief, ++rays;
          ASSERT_LE(aimed.residual, 1e-12) << part << " " << target.x << " " << target.y;
          ASSERT_LE(miss(lens, aimed.ray, target), 1e-12);
          worst = std::max(worst, aimed.residual);
        }
      }
    }
  }
  EXPECT_GE(chief_rays, 75 * 5);
  EXPECT_GE(rays, 9940);  // 9946 today
  testing_report::put("aimed rays at the stop, all 75 lenses, stop radii", testing_report::one_ray<double>, worst,
                      "1e-12");
}

TEST(Aim, FisheyeFieldsBeyond90DegreesConverge) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  for (const double field : {95.0, 105.0, 110.0, -110.0}) {
    for (const Vec2<double>& target : places()) {
      const AimedRay aimed = aim(lens, {radians(field), -infinity}, target);
      ASSERT_TRUE(aimed) << field;
      EXPECT_LT(aimed.ray.direction.z, 0) << field;
      EXPECT_LE(miss(lens, aimed.ray, target), 1e-12);
      EXPECT_TRUE(aimed.end.transmitted());
    }
  }
  // A point next to the lens, 200 mm behind the pupil.
  const double z = pupils(lens).entrance.z + 200;
  const AimedRay beside = chief_ray(lens, {radians(100), z});
  EXPECT_EQ(beside.status, AimStatus::converged);
  EXPECT_LE(beside.residual, 1e-12);
}

TEST(Aim, StatusEqualsTraceOfTheRay) {
  int converged = 0, vignetted = 0;
  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_10mm_f4", "modern_58mm_f0.95", "anamorphic_60mm_2x",
                         "catadioptric_mangin_1000mm_f7.5", "biotar_100mm_f1.4"}) {
    const Prescription p = testing::data_prescription(id);
    const Lens lens = compile(p);
    for (double part = 0; part <= 1.2; part += 0.1) {
      for (const Vec2<double>& target : places()) {
        const FieldPoint point{radians(part * *p.half_field_deg), -infinity, 0.3};
        const AimedRay aimed = aim(lens, point, {0.98 * target.x, 0.98 * target.y});
        if (!aimed) continue;
        const auto traced = trace(lens, aimed.ray);
        EXPECT_EQ(aimed.status == AimStatus::converged, traced.transmitted());
        EXPECT_EQ(aimed.surface, traced.transmitted() ? -1 : traced.surface);
        ++(traced.transmitted() ? converged : vignetted);
      }
    }
  }
  EXPECT_GT(converged, 150);
  EXPECT_GT(vignetted, 150);
}

TEST(Aim, RayComesFromTheScenePoint) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const double pupil_z = pupils(lens).entrance.z;
  for (const double z : {-150.0, -1000.0, -1e6}) {
    const FieldPoint point{radians(12), z, radians(30)};
    const AimedRay aimed = aim(lens, point, {0.3, -0.6});
    ASSERT_TRUE(aimed);
    const double height = std::tan(radians(12)) * (pupil_z - z);
    const Vec3<double> place{height * std::sin(radians(30)), height * std::cos(radians(30)), z};
    const auto off = glm::cross(place - aimed.ray.origin, aimed.ray.direction);
    EXPECT_LT(glm::length(off), 4e-16 * std::abs(z) + 1e-13) << z;
  }
}

TEST(Aim, ConvergesAtEveryFNumber) {
  const Lens open = data_lens("modern_58mm_f0.95");
  for (const double f_number : {1.0, 4.0, 64.0}) {
    const Lens lens = with_f_number(open, f_number);
    for (const Vec2<double>& target : places()) {
      const AimedRay aimed = aim(lens, {radians(10), -infinity}, target);
      ASSERT_TRUE(aimed);
      EXPECT_LE(aimed.residual, 1e-12) << f_number;
    }
  }
}

TEST(Aim, HitsPinholes) {
  const Lens open = data_lens("double_gauss_100mm_f2.0");
  for (const double radius : {1e-3, 1e-6, 1e-9}) {
    const Lens lens = with_semi_diameter(open, *open.stop(), radius);
    const AimedRay aimed = aim(lens, {radians(10), -infinity}, {0, 0.5});
    ASSERT_TRUE(aimed) << radius;
    EXPECT_LE(aimed.residual * radius, 1e-13) << radius;
  }
}

TEST(Aim, FindsTheSmallStopsOfFisheyesAtSteepFields) {
  int rays = 0;
  for (const char* id : {"fisheye_6.3mm_f2.8", "fisheye_8mm_f2.8", "fisheye_10mm_f4", "fisheye_16mm_f2.8"}) {
    const double edge = testing::data_prescription(id).half_field_deg.value();
    for (const auto& [f_number, allowed] : {std::pair(5.6, 1e-12), {22.0, 1e-12}, {64.0, 3e-12}}) {
      const Lens lens = with_f_number(data_lens(id), f_number);
      for (double field = 60.5; field <= edge; field += 0.7) {
        for (const Vec2<double>& target : places()) {
          const AimedRay aimed = aim(lens, {radians(field), -infinity}, target);
          if (!aimed && target.y != 0) continue;  // vignetted by another surface
          ++rays;
          ASSERT_TRUE(aimed) << id << " " << field;
          EXPECT_LE(miss(lens, aimed.ray, target), allowed) << id << " f/" << f_number << " " << field;
        }
      }
    }
  }
  EXPECT_GE(rays, 4910);  // 4913 today
}

TEST(Aim, RotatesWithTheAzimuth) {
  const Lens lens = data_lens("fisheye_16mm_f2.8");
  const auto straight = aim(lens, {radians(70), -infinity}, {0.2, 0.5});
  for (const double angle : {0.4, 1.9, -2.2}) {
    const double s = std::sin(angle), c = std::cos(angle);
    const auto turned = aim(lens, {radians(70), -infinity, angle}, {0.2 * c + 0.5 * s, 0.5 * c - 0.2 * s});
    ASSERT_TRUE(turned);
    const auto& d = straight.end.ray.direction;
    EXPECT_NEAR(turned.end.ray.direction.x, d.x * c + d.y * s, 1e-13);
    EXPECT_NEAR(turned.end.ray.direction.y, d.y * c - d.x * s, 1e-13);
  }
}

TEST(ChiefRay, IsTheAxisOnTheAxis) {
  for (const char* id : {"double_gauss_100mm_f2.0", "fisheye_6.3mm_f2.8", "mirror_newton_200mm_f8"}) {
    const AimedRay chief = chief_ray(data_lens(id), {0, -infinity});
    EXPECT_EQ(chief.status, AimStatus::converged) << id;
    EXPECT_EQ(chief.ray.origin.x, 0);
    EXPECT_EQ(chief.ray.origin.y, 0);
    EXPECT_EQ(chief.ray.direction, Vec3<double>(0, 0, 1));
  }
}

TEST(ChiefRay, EqualsTheParaxialChiefRayAtSmallFields) {
  for (const Prescription& p : data_prescriptions()) {
    SCOPED_TRACE(p.id);
    const Lens lens = compile(p);
    const AimedRay chief = chief_ray(lens, {1e-5, -infinity});
    ASSERT_TRUE(chief);
    const double z = pupils(lens).entrance.z;
    const double t = (z - chief.ray.origin.z) / chief.ray.direction.z;
    EXPECT_NEAR(chief.ray.origin.y + t * chief.ray.direction.y, 0, 1e-10 * (1 + std::abs(z)));
  }
}

TEST(ChiefRay, PassesFisheyesBeyondTheParaxialPupil) {
  // From 40 degrees on, a ray through the centre of the paraxial pupil misses the front of this lens, because pupil
  // aberration moves the pupil. The chief ray passes up to 74 degrees; at larger fields it is vignetted by the rim of
  // the front.
  const Lens lens = data_lens("fisheye_10mm_f4");
  for (const double field : {40.0, 54.0, 66.0, 74.0}) {
    EXPECT_EQ(chief_ray(lens, {radians(field), -infinity}).status, AimStatus::converged) << field;
  }
  const AimedRay edge = chief_ray(lens, {radians(77.9), -infinity});
  EXPECT_EQ(edge.status, AimStatus::vignetted);
  EXPECT_EQ(edge.surface, 0);
  EXPECT_TRUE(edge.end.transmitted());
}

TEST(Aim, ReportsFieldsWithoutARay) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  const AimedRay beyond = chief_ray(lens, {radians(89), -infinity});
  EXPECT_FALSE(beyond);
  EXPECT_EQ(beyond.status, AimStatus::no_ray);
  EXPECT_EQ(name(beyond.status), "no_ray");
}

TEST(Aim, RefusesMissingWavelengthsAndStops) {
  const Lens lens = data_lens("double_gauss_100mm_f2.0");
  testing::expect_error([&] { chief_ray(lens, {0, -infinity}, 3); }, {lens.name(), "wavelength", 3});
  Prescription p;
  p.name = "open";
  p.surfaces = {{.radius = 50, .thickness = 45, .medium = {.nd = 1.5}}};
  testing::expect_error([&] { chief_ray(compile(p), {0, -infinity}); }, {"open", "stop", "semi_diameter"});
}

}  // namespace aim_test
}  // namespace petzval
