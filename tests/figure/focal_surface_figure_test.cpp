// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/error.hpp"
#include "petzval/figure/figures.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace focal_surface_figure_test {

using testing::count;
using testing::marks;
using testing::Points;

const IdealLens lens = thin_lens(50, 2);
const Film film{.width_mm = 36, .height_mm = 24, .z_mm = 51.2};

/// Points in the section from the side.
const std::vector<FocalPoint> in_section{{.film_point = {0, -9}, .inverse_distance = 1 / 1500.0},
                                         {.film_point = {0, 1}, .inverse_distance = 1 / 3000.0},
                                         {.film_point = {0, 8}, .inverse_distance = 1 / 6000.0}};

std::string drawn(const std::vector<FocalPoint>& points, const Film& on = film) {
  const FocalSurface surface(lens, film, points);
  return focal_surface_figure("A <lens>", "f/2 & more", lens, on, surface, points);
}

TEST(FocalSurfaceFigure, TheSurfaceGoesThroughItsPoints) {
  const std::string svg = drawn(in_section);
  const Points at = marks(svg);
  ASSERT_EQ(at.size(), 6u);  // from the side, then from above
  const auto strokes = testing::paths(svg, "stroke=\"#1a8f3c\" stroke-width=\"2\"");
  for (std::size_t i = 0; i < 3; ++i) {
    double nearest = 1e9;
    for (const Points& stroke : strokes) {
      for (const auto& [x, y] : stroke) nearest = std::min(nearest, std::hypot(x - at[i].first, y - at[i].second));
    }
    EXPECT_LT(nearest, 3) << i;
  }
}

TEST(FocalSurfaceFigure, PointsLieAtTheirDistancesToScale) {
  const Points at = marks(drawn(in_section));
  ASSERT_EQ(at.size(), 6u);
  for (const std::size_t panel : {0u, 3u}) {
    const double near = at[panel].first - at[panel + 1].first, far = at[panel + 1].first - at[panel + 2].first;
    EXPECT_NEAR(far / near, (6000.0 - 3000) / (3000 - 1500), 0.01);
  }
  // Through a pinhole the film point (0, y) shows the height y distance / film distance, inverted.
  const double per_mm = (at[0].first - at[2].first) / 4500;
  const double across = 9 * 1500 / 51.2 + 8 * 6000 / 51.2;
  EXPECT_NEAR((at[2].second - at[0].second) / per_mm, across, 0.02 * across);
}

TEST(FocalSurfaceFigure, MarksPointsWithADistanceAndRingsPointsWithABlur) {
  std::vector<FocalPoint> points = in_section;
  points[1].blur_mm = 0.05;
  points.push_back({.film_point = {3, 3}, .inverse_distance = 0});
  points.push_back({.film_point = {-3, 3}, .extent_stops = 2});
  const std::string svg = drawn(points);
  EXPECT_EQ(marks(svg).size(), 6u);
  EXPECT_EQ(count(svg, "r=\"4\" fill=\"#fff\""), 2u);
  EXPECT_EQ(count(svg, "A &lt;lens&gt;"), 1u);
  EXPECT_EQ(count(svg, "f/2 &amp; more"), 1u);
  for (const char* word : {"nan", "inf\""}) EXPECT_EQ(svg.find(word), std::string::npos) << word;
  EXPECT_EQ(svg, drawn(points));
}

TEST(FocalSurfaceFigure, RequiresAPositionedFilmWithASize) {
  Film bad = film;
  bad.z_mm.reset();
  EXPECT_THROW(drawn(in_section, bad), Error);
  bad.z_mm = std::numeric_limits<double>::infinity();
  EXPECT_THROW(drawn(in_section, bad), Error);
  bad = film;
  bad.height_mm = 0;
  EXPECT_THROW(drawn(in_section, bad), Error);
}

}  // namespace focal_surface_figure_test
}  // namespace petzval
