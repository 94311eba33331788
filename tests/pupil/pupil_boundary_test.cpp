// SPDX-License-Identifier: Apache-2.0
#include "pupil/pupil_boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>

#include "../blades.hpp"
#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {
namespace pupil_boundary_test {

using testing::data_lens;
using testing::expect_error;
using testing::front_stop_lens;
using testing::room_between_blades;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

struct Case {
  const char* lens;
  double field_deg;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.lens << " at " << c.field_deg; }

class PupilBoundaryTest : public ::testing::TestWithParam<Case> {};

TEST_P(PupilBoundaryTest, AreaConvergesWithDirections) {
  const Lens lens = data_lens(GetParam().lens);
  const FieldPoint point{radians(GetParam().field_deg), -infinity};
  const PupilBoundary usual = pupil_boundary(lens, point), fine = pupil_boundary(lens, point, 0, 2048);
  const std::string lens_of = GetParam().lens;
  const bool crescent = lens_of == "cylinder_3.9mm" || lens_of == "analytic_ellipsoid_concentric_150mm";
  EXPECT_NEAR(usual.area() / fine.area(), 1, crescent ? 3e-3 : 5e-4);
}

INSTANTIATE_TEST_SUITE_P(
    Lenses, PupilBoundaryTest,
    ::testing::Values(Case{"double_gauss_100mm_f1.35", 0}, Case{"double_gauss_100mm_f1.35", 12},
                      Case{"double_gauss_100mm_f1.35", 21}, Case{"biogon_35mm_f2.8", 31}, Case{"fisheye_10mm_f4", 76},
                      Case{"fisheye_6.3mm_f2.8", 80}, Case{"fisheye_6.3mm_f2.8", 110},
                      Case{"catadioptric_maksutov_1280mm_f14.4", 0.25}, Case{"catadioptric_mangin_1000mm_f7.5", 1},
                      Case{"anamorphic_60mm_2x", 8}, Case{"phone_5.6mm_f3.5", 30}, Case{"mirror_newton_200mm_f8", 1},
                      Case{"telephoto_200mm_f1.8", 5}, Case{"analytic_ellipsoid_concentric_150mm", 70},
                      Case{"cylinder_3.9mm", 45}));

TEST(PupilBoundary, FrontStopIsThePupil) {
  for (const double field : {0.0, 10.0, 30.0}) {
    for (const double z : {-infinity, -50.0}) {
      const PupilBoundary boundary = pupil_boundary(front_stop_lens(), {radians(field), z}, 0, 32);
      EXPECT_NEAR(boundary.area(), 4 * pi, 1e-12);
      for (const PupilSpan& span : boundary.spans) {
        EXPECT_NEAR(std::hypot(span.to.x, span.to.y), 2, 1e-12);
        EXPECT_EQ(span.to.surface, 0);
        EXPECT_EQ(span.to.next_fate, RayFate::vignetted);
      }
    }
  }
}

TEST(PupilBoundary, CentralObscurationGivesARing) {
  Prescription p;
  p.name = "ring";
  p.surfaces = {{.thickness = 2, .semi_diameter = 5, .obscuration_semi_diameter = 2, .stop = true},
                {.radius = 100, .thickness = 50, .medium = {.nd = 1.5}, .semi_diameter = 30}};
  const PupilBoundary boundary = pupil_boundary(compile(p), {0, -infinity}, 0, 32);
  EXPECT_NEAR(boundary.area(), 21 * pi, 1e-11);
  EXPECT_EQ(boundary.spans.size(), 32u);
}

TEST(PupilBoundary, IrisGivesItsPolygon) {
  const Lens lens = with_iris(front_stop_lens(), {.blades = 6, .rotation_rad = 0.1});
  for (const double field : {0.0, 10.0}) {
    const PupilBoundary boundary = pupil_boundary(lens, {radians(field), -infinity});
    EXPECT_NEAR(boundary.area() / (6 * std::sqrt(3.0)), 1, 5e-4);
    for (const PupilSpan& span : boundary.spans) {
      EXPECT_EQ(span.to.surface, 0);
      EXPECT_NEAR(room_between_blades(lens.iris(), span.to.x / 2, span.to.y / 2), 0, 1e-12);
    }
  }
}

TEST(PupilBoundary, OneDirectionSufficesOnTheAxis) {
  for (const char* id : {"double_gauss_100mm_f1.35", "catadioptric_mangin_1000mm_f7.5", "fisheye_6.3mm_f2.8"}) {
    const Lens lens = data_lens(id);
    const PupilBoundary one = pupil_boundary(lens, {0, -infinity}, 0, 1), many = pupil_boundary(lens, {0, -infinity});
    EXPECT_NEAR(one.area() / many.area(), 1, 1e-13) << id;
  }
}

TEST(PupilBoundary, FindsTheStopOfAFarStoppedDownLens) {
  const Lens lens = with_f_number(data_lens("double_gauss_100mm_f1.35"), 128);
  const PupilBoundary boundary = pupil_boundary(lens, {radians(5), -infinity});
  EXPECT_NEAR(boundary.half_axes[0], 100.437 / 256, 0.01);
}

TEST(PupilBoundary, FindsThinRegionsThatTheChiefRayMisses) {
  // Beyond the last field with a chief ray, slivers of the pupil remain.
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  int slivers = 0;
  double last = infinity;
  for (double field = 14; field < 26; field += 0.5) {
    const FieldPoint point{radians(field), -infinity};
    const PupilBoundary boundary = pupil_boundary(lens, point);
    EXPECT_LT(boundary.area(), last) << field;
    last = std::max(boundary.area(), 1e-9);
    slivers += !boundary.empty() && chief_ray(lens, point).status != AimStatus::converged;
  }
  EXPECT_GE(slivers, 3);
}

TEST(PupilBoundary, RefusesInvalidDirectionsAndWavelengths) {
  const Lens lens = front_stop_lens();
  const auto of = [&](double field, std::size_t directions, std::size_t wavelength = 0) {
    return [=, &lens] { pupil_boundary(lens, {field, -infinity}, wavelength, directions); };
  };
  EXPECT_NO_THROW(of(0, 1)());
  EXPECT_NO_THROW(of(0.1, 3)());
  expect_error(of(0.1, 1), {"front stop", "directions", 1, 3, 1 << 20});
  expect_error(of(0, (1 << 20) + 1), {"front stop", "directions", (1 << 20) + 1, 3, 1 << 20});
  expect_error(of(0, 0), {"front stop", "directions", 0});
  expect_error(of(0, 8, 2), {"front stop", "wavelength", 2});
}

}  // namespace pupil_boundary_test
}  // namespace petzval
