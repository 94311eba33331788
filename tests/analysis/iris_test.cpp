// SPDX-License-Identifier: Apache-2.0
// Light through a lens with a hexagonal iris, relative to the round stop: the ratio of the areas of hexagon and disc,
// 0.826993.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "../blades.hpp"
#include "../data_lenses.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/f_number.hpp"
#include "petzval/trace/trace.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace iris_test {

const double hexagon_over_disc = 3 * std::numbers::sqrt3 / 2 / std::numbers::pi;
const Iris hexagon{.blades = 6, .rotation_rad = 0.1};

struct Pair {
  Lens round, bladed;
};

Pair pair_of(const Lens& lens) { return {lens, with_iris(lens, hexagon)}; }
Pair double_gauss(double f_number) {
  return pair_of(with_focus(with_f_number(testing::data_lens("double_gauss_100mm_f2.0"), f_number), 3000));
}

TEST(LensWithIris, PupilsHaveTheAreaOfThePolygon) {
  const auto [round, bladed] = pair_of(testing::front_stop_lens());
  const double disc = pupil_boundary(round, {0, -500}).area(), polygon = pupil_boundary(bladed, {0, -500}).area();
  EXPECT_NEAR(polygon / disc, hexagon_over_disc, 5e-4 * hexagon_over_disc);
  EXPECT_EQ(pupil_boundary(bladed, {0.05, -500}).spans[0].to.surface, 0);
  const auto [round_gauss, bladed_gauss] = double_gauss(5.6);
  EXPECT_NEAR(exit_pupil_boundary(bladed_gauss, {}).area() / exit_pupil_boundary(round_gauss, {}).area(),
              hexagon_over_disc, 2e-3);
}

TEST(LensWithIris, BoundaryLiesOnTheIris) {
  const Lens lens = double_gauss(5.6).bladed;
  const PupilBoundary boundary = pupil_boundary(lens, {0.05, -3000});
  const double radius = lens.surfaces()[*lens.stop()].semi_diameter;
  std::size_t beside = 0;
  for (const PupilSpan& span : boundary.spans) {
    const Ray<double> ray = boundary.plane.ray(span.to.x, span.to.y);
    double nearest = 1;
    trace<double>(lens, ray, {}, [&](int surface, const Vec3<double>& p) {
      if (surface != static_cast<int>(*lens.stop())) return;
      nearest = testing::room_between_blades(hexagon, p.x / radius, p.y / radius);
    });
    beside += !(std::abs(nearest) < 1e-10);
    EXPECT_EQ(span.to.surface, static_cast<int>(*lens.stop()));
  }
  EXPECT_EQ(boundary.spans.size(), 256u);
  EXPECT_EQ(beside, 0u);
}

TEST(LensWithIris, PointImageHasItsShapeAndIrradiance) {
  const auto [round, bladed] = double_gauss(4);
  const FieldPoint near{0, -1500};  // well out of focus
  const auto disc = point_image(round, near, {.samples = 1 << 15, .pixels = 64});
  const auto polygon = point_image(bladed, near, {.samples = 1 << 15, .pixels = 64});
  EXPECT_NEAR(polygon.mean_throughput / disc.mean_throughput, hexagon_over_disc, 3e-3);
  EXPECT_LT(polygon.size.rms_radius, disc.size.rms_radius);
  EXPECT_GT(polygon.size.max_radius, 0.97 * disc.size.max_radius);  // the corners reach the rim
}

TEST(LensWithIris, SpotsLoseRaysOutsideThePolygon) {
  const auto [round, bladed] = double_gauss(4);
  const std::vector<double> fields{0.0, 0.1};
  const auto discs = spot_diagram(round, -1500, fields, 4096).values,
             polygons = spot_diagram(bladed, -1500, fields, 4096).values;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const auto area = [&](const Lens& lens) { return pupil_boundary(lens, discs[i].point).area(); };
    EXPECT_NEAR(area(bladed) / area(round), hexagon_over_disc, 0.02) << i;
    EXPECT_EQ(polygons[i].sent, discs[i].sent);
    EXPECT_LT(polygons[i].size.rms_radius, discs[i].size.rms_radius) << i;
  }
}

TEST(LensWithIris, MovesExactFocusAndKeepsParaxialFocus) {
  const Lens lens = testing::data_lens("double_gauss_100mm_f2.0");
  const Lens bladed = with_iris(lens, hexagon);
  const FocusOptions paraxial{.criterion = FocusCriterion::paraxial};
  EXPECT_EQ(with_focus(bladed, 3000, paraxial).film_z(), with_focus(lens, 3000, paraxial).film_z());
  EXPECT_NE(with_focus(bladed, 3000).film_z(), with_focus(lens, 3000).film_z());
}

}  // namespace iris_test
}  // namespace petzval
