// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/aim.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace layout_figure_test {

constexpr double infinity = std::numeric_limits<double>::infinity();
using testing::count;
using testing::data_lens;
using testing::paths;
using testing::Points;
using testing::scale;

Points film(const std::string& svg) { return paths(svg, "stroke=\"#111\" stroke-width=\"2\"").at(0); }
std::vector<Points> ticks(const std::string& svg) { return paths(svg, "stroke-width=\"2.2\""); }
constexpr const char* first_field = "stroke=\"#1f5fc4\" stroke-width=\"0.9\"";

TEST(LayoutFigure, DrawsEveryLensWithinItsPaper) {
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    const double half = radians(p.half_field_deg.value_or(10));
    const std::array fields{0.0, 0.7 * half, half};
    for (const Meridian section : {Meridian::y, Meridian::x}) {
      const std::string svg = layout_figure(lens, -infinity, fields, section);
      EXPECT_EQ(svg, layout_figure(lens, -infinity, fields, section)) << p.id;
      EXPECT_EQ(svg.find("nan"), std::string::npos) << p.id;
      EXPECT_EQ(svg.find("inf\""), std::string::npos) << p.id;
      EXPECT_GE(paths(svg, first_field).size(), 3u) << p.id;

      const auto size = testing::matches(svg, "width=\"([0-9.]+)\" height=\"([0-9.]+)\"");
      ASSERT_FALSE(size.empty());
      const double width = size[0].number(1), height = size[0].number(2);
      // Lines of text above and below do not overlap the drawing.
      for (const Points& points : paths(svg, "stroke")) {
        for (const auto& [x, y] : points) {
          EXPECT_TRUE(x >= 0 && x <= width && y >= 50 && y <= height - 30) << p.id << ": " << x << ' ' << y;
        }
      }
    }
  }
}

TEST(LayoutFigure, IsToScale) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const std::string svg = layout_figure(lens, -infinity, std::array{0.0, radians(12.95)});
  const LensSurface& stop = lens.surfaces()[5];
  const auto drawn = ticks(svg);
  ASSERT_EQ(drawn.size(), 2u);
  EXPECT_NEAR(film(svg)[0].first - drawn[0][0].first, (lens.film_z() - stop.vertex_z) * scale(svg), 0.03);
  EXPECT_NEAR(drawn[1][0].second - drawn[0][0].second, 2 * stop.semi_diameter * scale(svg), 0.03);
}

TEST(LayoutFigure, RaysEndAtTracedPoints) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const double field = radians(5.0);
  const std::string svg = layout_figure(lens, -infinity, std::array{field});
  const auto plate = film(svg);
  const double axis = (plate[0].second + plate[1].second) / 2;
  const auto end = chief_ray(lens, {field, -infinity}).end.ray;
  const double height = end.origin.y + end.direction.y / end.direction.z * (lens.film_z() - end.origin.z);
  const auto rays = paths(svg, first_field);
  ASSERT_EQ(rays.size(), 5u);
  const double expected = axis - height * scale(svg);
  EXPECT_NEAR(rays[2].back().second, expected, 0.05);
  // From in front of the lens, over each surface, to the film.
  for (const Points& ray : rays) EXPECT_EQ(ray.size(), lens.surface_count() + 2);
}

TEST(LayoutFigure, VignettedRaysStopAtTheirSurface) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const std::string svg = layout_figure(lens, -infinity, std::array{radians(12.95)});
  const auto thin = paths(svg, "stroke-opacity");
  ASSERT_FALSE(thin.empty());
  const AimedRay lost = aim(lens, {radians(12.95), -infinity}, {0, -1 + 1e-9});
  ASSERT_EQ(lost.status, AimStatus::vignetted);
  EXPECT_EQ(thin[0].size(), static_cast<std::size_t>(lost.surface) + 2);
}

TEST(LayoutFigure, FisheyeHasRaysBeyond90Degrees) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  const auto rays = paths(layout_figure(lens, -infinity, std::array{radians(110.0)}), first_field);
  ASSERT_FALSE(rays.empty());
  for (const Points& ray : rays) EXPECT_GT(ray[0].first, ray[1].first);
}

TEST(LayoutFigure, LeavesObscurationsOpen) {
  const auto pieces =
      paths(layout_figure(data_lens("mirror_ritchey_chretien_57.6m_f24"), -infinity, {}), "stroke-width=\"3.5\"");
  EXPECT_EQ(pieces.size(), 3u);  // two of the primary, one of the secondary
}

TEST(LayoutFigure, FillsEachGlassBodyAndNoAir) {
  EXPECT_EQ(count(layout_figure(data_lens("cooke_triplet_50mm_f5"), -infinity, {}), "fill=\"rgb("), 3u);
  EXPECT_EQ(count(layout_figure(data_lens("tessar_100mm_f2.8"), -infinity, {}), "fill=\"rgb("), 4u);
  // The stop inside the ball is not a surface of the glass; the eye is filled to the retina.
  EXPECT_EQ(count(layout_figure(data_lens("ball_10mm"), -infinity, {}), "fill=\"rgb("), 1u);
  EXPECT_EQ(count(layout_figure(data_lens("eye_gullstrand_le_grand"), -infinity, {}), "fill=\"rgb("), 4u);
  EXPECT_EQ(count(layout_figure(data_lens("mirror_newton_200mm_f8"), -infinity, {}), "fill=\"rgb("), 0u);
}

TEST(LayoutFigure, JoinsRimsOfDifferentHeightByAFlatRing) {
  Prescription p;
  p.surfaces = {{.radius = 40, .thickness = 8, .medium = {.nd = 1.5}, .semi_diameter = 14, .stop = true},
                {.radius = 30, .thickness = 60, .semi_diameter = 10}};
  const std::string svg = layout_figure(compile(p), -infinity, {});
  const Points body = paths(svg, "fill=\"rgb(").at(0);
  // After the 49 points of the front comes the corner: at the height of the front rim, above the rear rim.
  ASSERT_EQ(body.size(), 2u * 49u + 2u);
  EXPECT_DOUBLE_EQ(body[49].second, body[48].second);
  EXPECT_DOUBLE_EQ(body[49].first, body[50].first);
  EXPECT_NEAR(body[50].second - body[49].second, 4 * scale(svg), 0.02);
}

TEST(LayoutFigure, MarksAndNamesAnInferredStop) {
  Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  for (auto& row : p.surfaces) row.stop = false;
  const std::string svg = layout_figure(compile(p), -infinity, std::array{0.0});
  EXPECT_EQ(paths(svg, "stroke-dasharray=\"3 2\"").size(), 2u);
  EXPECT_NE(svg.find("stop"), std::string::npos);
}

TEST(LayoutFigure, DrawsSurfacesToTheirApertures) {
  Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  for (auto& row : p.surfaces) {
    if (!row.stop) row.semi_diameter.reset();
  }
  const Lens computed = compile(p);
  const Points body = paths(layout_figure(computed, -infinity, std::array{0.0}), "fill=\"rgb(").at(0);
  const double height =
      (body.front().second - body[48].second) / scale(layout_figure(computed, -infinity, std::array{0.0}));
  EXPECT_NEAR(height, 2 * computed.surfaces()[0].semi_diameter, 1e-2);
}

// A plane plate has no edge.
TEST(LayoutFigure, DrawsUnlimitedSurfacesAsFarAsRaysNeedThem) {
  Prescription p;
  p.surfaces = {{.thickness = 5, .semi_diameter = 5, .stop = true},
                {.thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = infinity},
                {.thickness = 100, .semi_diameter = infinity}};
  const auto front_height = [&](std::span<const double> fields) {
    const std::string svg = layout_figure(compile(p), -infinity, fields);
    const Points body = paths(svg, "fill=\"rgb(").at(0);
    return (body.front().second - body[48].second) / scale(svg);
  };
  const double narrow = front_height(std::array{0.0});
  EXPECT_LT(narrow, 16);
  EXPECT_GT(front_height(std::array{0.0, radians(30.0)}), 1.2 * narrow);
}

TEST(LayoutFigure, CutsACylinderInBothSections) {
  const Lens lens = data_lens("anamorphic_60mm_2x");
  const auto front = [&](Meridian section) {
    const Points body = paths(layout_figure(lens, -infinity, {}, section), "fill=\"rgb(").at(0);
    return body[24].first - body[0].first;
  };
  EXPECT_EQ(front(Meridian::y), 0);  // straight
  EXPECT_GT(front(Meridian::x), 5);  // concave: the vertex lies behind the rim
}

TEST(LayoutFigure, ContinuesRaysBehindALensWithAVirtualImage) {
  Prescription p;
  p.surfaces = {{.radius = -50, .thickness = 3, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                {.radius = 50, .thickness = -48, .semi_diameter = 12}};
  const std::string svg = layout_figure(compile(p), -infinity, std::array{0.0});
  const auto rays = paths(svg, first_field);
  ASSERT_EQ(rays.size(), 5u);
  for (const Points& ray : rays) EXPECT_GT(ray[3].first, ray[2].first + 10);
  EXPECT_LT(film(svg)[0].first, rays[0][1].first);
}

TEST(LayoutFigure, RefusesAnotherNumberOfRays) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  EXPECT_THROW(layout_figure(lens, -infinity, {}, Meridian::y, 2), Error);
  EXPECT_THROW(layout_figure(lens, -infinity, {}, Meridian::y, 8), Error);
  EXPECT_EQ(paths(layout_figure(lens, -infinity, std::array{0.0}, Meridian::y, 3), first_field).size(), 3u);
}

}  // namespace layout_figure_test
}  // namespace petzval
