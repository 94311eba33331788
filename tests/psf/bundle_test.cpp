// SPDX-License-Identifier: Apache-2.0
#include "petzval/psf/bundle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>

#include "lenses.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/units.hpp"
#include "petzval/psf/sobol.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(RayThrough, RunsFromTheScenePointThroughThePupilPoint) {
  const Pupil entrance{30, 20};
  const ScenePoint point{radians(25), -970};
  const Ray<double> ray = ray_through(point, entrance, 3, -4);
  EXPECT_EQ(ray.origin, Vec3<double>(3, -4, 30));
  EXPECT_NEAR(glm::dot(ray.direction, ray.direction), 1, 4e-16);
  const double t = (point.z - ray.origin.z) / ray.direction.z;
  EXPECT_NEAR(ray.origin.x + t * ray.direction.x, 0, 1e-12);
  EXPECT_NEAR(ray.origin.y + t * ray.direction.y, 1000 * std::tan(radians(25)), 1e-12);
}

TEST(RayThrough, FarPointsBecomeInfinity) {
  const Pupil entrance{30, 20};
  const auto at_infinity = ray_through({radians(40), -infinity}, entrance, 5, 7);
  EXPECT_NEAR(at_infinity.direction.y, -std::sin(radians(40)), 1e-16);
  for (const double z : {-1e9, -1e15, -1e300}) {
    const auto ray = ray_through({radians(40), z}, entrance, 5, 7);
    EXPECT_NEAR(ray.direction.x, 5 / -z * std::cos(radians(40)), std::abs(500 / (z * z)) + 1e-30);
    EXPECT_NEAR(ray.direction.y, at_infinity.direction.y, std::abs(7 / z) + 2e-16);
  }
}

TEST(RayThrough, MirrorsBitForBit) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const Pupil entrance = pupils(lens).entrance;
  for (const double z : {-infinity, -700.0}) {
    for (std::uint32_t i = 0; i < 200; ++i) {
      const auto [u, v] = owen_sobol(i, 9);
      const double x = 60 * (u - 0.5), y = 60 * (v - 0.5);
      const auto up = trace(lens, ray_through({0.2, z}, entrance, x, y));
      const auto down = trace(lens, ray_through({-0.2, z}, entrance, -x, -y));
      ASSERT_EQ(up.fate, down.fate);
      ASSERT_EQ(up.ray.origin.x, -down.ray.origin.x);
      ASSERT_EQ(up.ray.origin.y, -down.ray.origin.y);
      ASSERT_EQ(up.ray.direction.y, -down.ray.direction.y);
    }
  }
}

struct Case {
  const char* lens;
  double field_deg;
  double fill;  ///< part of the window that passes, at least
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.lens << " at " << c.field_deg; }

class Window : public testing::TestWithParam<Case> {};

TEST_P(Window, HoldsEveryRayThatPasses) {
  const auto& [id, field_deg, fill] = GetParam();
  const Lens lens = data_lens(id);
  const Pupil entrance = pupils(lens).entrance;
  for (const double z : {-infinity, -2000.0}) {
    const ScenePoint point{radians(field_deg), z};
    const PupilWindow window = pupil_window(lens, point);
    ASSERT_FALSE(window.empty);
    const double width = window.x_max - window.x_min, height = window.y_max - window.y_min;
    // A band about the window; and over four times the front, cast onto the pupil's plane.
    const double front = 4 * lens.surfaces().front().semi_diameter;
    const double magnification = std::isinf(z) ? 1 : (window.plane_z - z) / -z;
    const double chief = std::tan(point.field_rad) * window.plane_z;
    int inside = 0, outside = 0;
    for (std::uint32_t i = 0; i < 40000; ++i) {
      const auto [u, v] = owen_sobol(i, 5);
      const std::array<std::array<double, 2>, 2> places{
          {{window.x_min + width * (1.1 * u - 0.05), window.y_min + height * (1.1 * v - 0.05)},
           {magnification * front * (2 * u - 1), magnification * (front * (2 * v - 1) - chief)}}};
      for (const auto& [x, y] : places) {
        if (!trace(lens, ray_through(point, entrance, x, y)).transmitted()) continue;
        const bool in = x >= window.x_min && x <= window.x_max && y >= window.y_min && y <= window.y_max;
        ++(in ? inside : outside);
      }
    }
    EXPECT_EQ(outside, 0) << z;
    EXPECT_GT(inside, 500) << z;
    const FilmHits hits = trace_bundle(lens, window, 4096);
    EXPECT_GT(static_cast<double>(hits.x.size()) / 4096, fill) << z;
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, Window,
                         testing::Values(Case{"double_gauss_100mm_f1.35", 0, 0.6},
                                         Case{"double_gauss_100mm_f1.35", 14, 0.6},
                                         Case{"double_gauss_100mm_f1.35", 21, 0.5}, Case{"fisheye_10mm_f4", 0, 0.6},
                                         Case{"fisheye_10mm_f4", 70, 0.6}, Case{"fisheye_6.3mm_f2.8", 80, 0.6},
                                         Case{"catadioptric_corrector_25mm_f1.25", 0, 0.4},
                                         Case{"catadioptric_maksutov_1280mm_f14.4", 0.5, 0.4},
                                         Case{"catadioptric_mangin_1000mm_f7.5", 1, 0.4},
                                         Case{"anamorphic_60mm_2x", 5, 0.5}, Case{"telephoto_200mm_f1.8", 5, 0.6},
                                         Case{"phone_5.6mm_f3.5", 30, 0.5}, Case{"wide_100mm_roosinov", 40, 0.5},
                                         Case{"mirror_newton_200mm_f8", 1, 0.5},
                                         Case{"analytic_ellipsoid_concentric_150mm", 60, 0.3},
                                         Case{"analytic_ellipsoid_concentric_150mm", 70, 0.1},  // a thin crescent
                                         Case{"cylinder_3.9mm", 45, 0.2}));

TEST(PupilWindow, IsEmptyWhereNothingGetsThrough) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const PupilWindow window = pupil_window(lens, {radians(60), -infinity});
  EXPECT_TRUE(window.empty);
  EXPECT_EQ(window.area(), 0);
  const FilmHits hits = trace_bundle(lens, window, 1000);
  EXPECT_EQ(hits.sent, 1000u);
  EXPECT_TRUE(hits.x.empty());
  EXPECT_EQ(hits.transmitted_area(), 0);
  EXPECT_TRUE(pupil_window(front_stop_lens(0), {0, -infinity}).empty);
}

TEST(PupilWindow, FindsTheStopOfAFarStoppedDownLens) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f1.35"), 128);
  const PupilWindow window = pupil_window(lens, {0, -infinity});
  ASSERT_FALSE(window.empty);
  EXPECT_NEAR(window.x_max, 100.437 / 256, 0.1);
  EXPECT_GT(trace_bundle(lens, window, 4096).x.size(), 2000u);
}

std::string message(const Lens& lens, const ScenePoint& point, std::size_t wavelength = 0) {
  try {
    pupil_window(lens, point, wavelength);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(PupilWindow, RefusesPointsThatItCannotSee) {
  const Lens lens = front_stop_lens();
  const auto starts = [](const std::string& text, const std::string& with) {
    return text.rfind("front stop: scene point: " + with, 0) == 0;
  };
  EXPECT_TRUE(starts(message(lens, {radians(90), -1000}), "field is 90 degrees, wanted less than 90"));
  EXPECT_TRUE(starts(message(lens, {radians(-120), -1000}), "field is -120 degrees"));
  EXPECT_TRUE(starts(message(lens, {std::nan(""), -1000}), "field is nan degrees"));
  EXPECT_TRUE(starts(message(lens, {0, std::nan("")}), "z is nan mm"));
  EXPECT_TRUE(starts(message(lens, {0, infinity}), "z is inf mm"));
  EXPECT_TRUE(starts(message(lens, {0, 50}), "z is 50 mm, wanted less than where the first surface begins"));
  EXPECT_TRUE(starts(message(lens, {0, 0}), "z is 0 mm, that of the entrance pupil"));
  EXPECT_TRUE(starts(message(lens, {0, -1000}, 3), "wavelength 3 does not exist, wanted one of 1"));

  // The stop in the rear focal plane of what stands before it: the entrance pupil is at infinity.
  Prescription p;
  p.name = "front stop";
  p.surfaces = {{.radius = 50, .medium = {.nd = 1.5}, .semi_diameter = 10},
                {.thickness = 100, .semi_diameter = 10},
                {.thickness = 20, .semi_diameter = 5, .stop = true}};
  EXPECT_TRUE(starts(message(compile(p), {0, -1000}), "the entrance pupil is at infinity"));
}

TEST(TraceBundle, IsTheSameForAnyNumberOfThreads) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const PupilWindow window = pupil_window(lens, {radians(10), -1500});
  const FilmHits one = trace_bundle(lens, window, 50000, 0, 3, 1);
  EXPECT_GT(one.x.size(), 20000u);
  for (const int threads : {2, 3, 7, 64}) {
    const FilmHits many = trace_bundle(lens, window, 50000, 0, 3, threads);
    EXPECT_EQ(many.x, one.x) << threads;
    EXPECT_EQ(many.y, one.y) << threads;
  }
  EXPECT_NE(trace_bundle(lens, window, 50000, 0, 4, 1).x, one.x);
  EXPECT_THROW(trace_bundle(lens, window, 10, 0, 0, 0), Error);
}

TEST(TraceBundle, BeginsWithTheHitsOfFewerSamples) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const PupilWindow window = pupil_window(lens, {0, -1500});
  const FilmHits few = trace_bundle(lens, window, 5000), many = trace_bundle(lens, window, 9000);
  ASSERT_LT(few.x.size(), many.x.size());
  EXPECT_TRUE(std::equal(few.x.begin(), few.x.end(), many.x.begin()));
}

TEST(TraceBundle, HitsAreThoseOfSingleRays) {
  const Lens lens = data_lens("catadioptric_mangin_1000mm_f7.5");
  const PupilWindow window = pupil_window(lens, {radians(0.5), -infinity});
  const FilmHits hits = trace_bundle(lens, window, 500, 0, 8);
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const auto [u, v] = owen_sobol(i, 8);
    const auto end =
        trace(lens, ray_through(window.point, {window.plane_z, 0}, window.x_min + u * (window.x_max - window.x_min),
                                window.y_min + v * (window.y_max - window.y_min)));
    if (!end.transmitted()) continue;
    const double t = (lens.film_z() - end.ray.origin.z) / end.ray.direction.z;
    ASSERT_LT(next, hits.x.size());
    EXPECT_NEAR(hits.x[next], end.ray.origin.x + t * end.ray.direction.x, 1e-12);
    EXPECT_NEAR(hits.y[next], end.ray.origin.y + t * end.ray.direction.y, 1e-12);
    ++next;
  }
  EXPECT_EQ(next, hits.x.size());
}

}  // namespace
}  // namespace petzval
