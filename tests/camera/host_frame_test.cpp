// SPDX-License-Identifier: Apache-2.0
#include "petzval/camera/camera.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace host_frame_test {

constexpr std::array hosts{Host::pbrt, Host::mitsuba, Host::cycles, Host::arnold, Host::appleseed};
constexpr std::array origins{DistanceOrigin::film, DistanceOrigin::front_vertex, DistanceOrigin::entrance_pupil};

const Lens& gauss() {
  static const Lens lens = testing::data_lens("double_gauss_100mm_f2_28deg");
  return lens;
}

/// The camera frame of a host: the directions right, up and ahead, and the unit.
struct Says {
  Host host;
  Vec3<double> right, up, ahead;
  double per_mm;
};

class HostFrames : public ::testing::TestWithParam<Says> {};

TEST_P(HostFrames, AxesAndUnitsEqualTheHost) {
  const auto& [host, right, up, ahead, per_mm] = GetParam();
  const HostFrame frame(host, gauss(), DistanceOrigin::front_vertex);
  EXPECT_EQ(frame.units_per_mm(), per_mm);
  // In the lens frame a camera looks along -z; +y is up and +x is right.
  EXPECT_EQ(frame.direction_to_host({1, 0, 0}), right);
  EXPECT_EQ(frame.direction_to_host({0, 1, 0}), up);
  EXPECT_EQ(frame.direction_to_host({0, 0, -1}), ahead);
  EXPECT_NEAR(
      glm::distance(frame.point_to_host({2000, 3000, -5000}), (right * 2000.0 + up * 3000.0 + ahead * 5000.0) * per_mm),
      0, 1e-12 * 5000 * per_mm);
  // In a right-handed frame, right is the cross product of ahead and up.
  const bool right_handed = glm::dot(glm::cross(ahead, up), right) > 0;
  EXPECT_EQ(right_handed, host == Host::mitsuba || host == Host::arnold || host == Host::appleseed);
}

INSTANTIATE_TEST_SUITE_P(Hosts, HostFrames,
                         ::testing::Values(Says{Host::pbrt, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.001},
                                           Says{Host::mitsuba, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.001},
                                           Says{Host::cycles, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.001},
                                           Says{Host::arnold, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0.1},
                                           Says{Host::appleseed, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0.001}));

TEST(HostFrame, RoundTrips) {
  const Ray<double> ray{{12.5, -340, -2000}, {0.36, 0.48, 0.8}};
  for (const Host host : hosts) {
    for (const DistanceOrigin origin : origins) {
      for (const double per_mm : {0.001, 0.1, 1.0, 0.5}) {
        const HostFrame frame(host, gauss(), origin, per_mm);
        EXPECT_EQ(frame.units_per_mm(), per_mm);
        const Ray<double> there = frame.to_host(ray), back = frame.to_lens(there);
        EXPECT_NEAR(glm::distance(back.origin, ray.origin), 0, 1e-12);
        EXPECT_EQ(back.direction, ray.direction);
        EXPECT_NEAR(glm::length(there.direction), 1, 1e-15);
        EXPECT_EQ(there.origin, frame.point_to_host(ray.origin));
        EXPECT_EQ(there.direction, frame.direction_to_host(ray.direction));
        EXPECT_EQ(back.origin, frame.point_to_lens(there.origin));
        EXPECT_EQ(back.direction, frame.direction_to_lens(there.direction));
        // Lengths scale for every host.
        EXPECT_NEAR(glm::distance(there.origin, frame.point_to_host({0, 0, 0})), glm::length(ray.origin) * per_mm,
                    1e-12 * 2000 * per_mm);
      }
    }
  }
}

TEST(HostFrame, OriginIsTheRequestedPoint) {
  const double pupil_z = pupils(gauss()).entrance.z;
  for (const Host host : hosts) {
    const auto at = [&](DistanceOrigin origin, double z) {
      return HostFrame(host, gauss(), origin).point_to_host({0, 0, z});
    };
    EXPECT_EQ(at(DistanceOrigin::film, gauss().film_z()), Vec3<double>(0));
    EXPECT_EQ(at(DistanceOrigin::front_vertex, 0), Vec3<double>(0));
    EXPECT_EQ(at(DistanceOrigin::entrance_pupil, pupil_z), Vec3<double>(0));
  }
}

TEST(HostFrame, RefusesInvalidFrames) {
  using testing::expect_error;
  for (const double unit : {0.0, -0.001, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_error([&] { HostFrame(Host::pbrt, gauss(), DistanceOrigin::film, unit); }, {"units_per_mm", unit});
  }
  Prescription p;
  p.name = "telecentric";
  p.surfaces = {{.radius = 60, .thickness = 5, .medium = {.nd = 1.6}, .semi_diameter = 12},
                {.radius = -80, .semi_diameter = 12}};
  p.surfaces[1].thickness = first_order(compile(p)).back_focal_distance;
  p.surfaces.push_back({.semi_diameter = 3, .stop = true});
  const Lens telecentric = compile(p);
  expect_error([&] { HostFrame(Host::pbrt, telecentric, DistanceOrigin::entrance_pupil); },
               {"telecentric", "entrance_pupil"});
  EXPECT_NO_THROW(HostFrame(Host::pbrt, telecentric, DistanceOrigin::film));
}

}  // namespace host_frame_test
}  // namespace petzval
