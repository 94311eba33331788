// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "../data_lenses.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil/pupil_boundary.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace footprint_figure_test {

using testing::count;
using testing::data_lens;
using testing::paths;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr const char* edges = "stroke-linecap=\"round\"";

TEST(FootprintFigure, StatesAreaAndIllumination) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const std::array fields{0.0, radians(12.95)};
  const std::string svg = footprint_figure(lens, -infinity, fields);
  const PupilBoundary axis = pupil_boundary(lens, {0, -infinity}), edge = pupil_boundary(lens, {fields[1], -infinity});
  EXPECT_NE(svg.find("area 1 of"), std::string::npos);
  EXPECT_NE(svg.find("area " + to_text(edge.area() / axis.area(), 3) + " of"), std::string::npos);
  EXPECT_NE(svg.find("relative illumination " + to_text(*relative_illumination(lens, {fields[1], -infinity}), 3)),
            std::string::npos);
  EXPECT_EQ(svg, footprint_figure(lens, -infinity, fields));
}

TEST(FootprintFigure, NamesEachSurfaceThatLimits) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const double field = radians(12.95);
  std::set<int> limiting;
  for (const PupilSpan& span : pupil_boundary(lens, {field, -infinity}).spans) limiting.insert(span.to.surface);
  const std::string svg = footprint_figure(lens, -infinity, std::array{field});
  EXPECT_EQ(paths(svg, edges).size(), limiting.size());
  EXPECT_GE(limiting.size(), 2u);
  for (const int surface : limiting) {
    EXPECT_NE(svg.find(">surface " + std::to_string(surface)), std::string::npos) << surface;
  }
  const std::string from_one = footprint_figure(lens, -infinity, std::array{field}, 1);
  EXPECT_EQ(count(from_one, ">surface "), count(svg, ">surface "));
  for (const int surface : limiting) {
    EXPECT_NE(from_one.find(">surface " + std::to_string(surface + 1)), std::string::npos) << surface;
  }
}

TEST(FootprintFigure, DrawsTheEdgeToScale) {
  const Lens lens = data_lens("achromat_100mm");  // its stop is its front rim
  const std::string svg = footprint_figure(lens, -infinity, std::array{0.0});
  const auto paraxial =
      testing::matches(svg, "<ellipse cx=\"([0-9.]+)\" cy=\"([0-9.]+)\" rx=\"([0-9.]+)\" ry=\"([0-9.]+)\"");
  ASSERT_FALSE(paraxial.empty());
  const double cx = paraxial[0].number(1), cy = paraxial[0].number(2);
  EXPECT_NEAR(paraxial[0].number(3), pupils(lens).entrance.diameter / 2 * testing::scale(svg), 0.02);
  const auto edge = paths(svg, edges);
  ASSERT_EQ(edge.size(), 1u);
  EXPECT_EQ(edge[0].size(), 2u * 256u);
  for (const auto& [x, y] : edge[0]) {
    EXPECT_NEAR(std::hypot(x - cx, y - cy), lens.surfaces()[0].semi_diameter * testing::scale(svg), 0.03);
  }
}

TEST(FootprintFigure, ShowsTheObscurationOfAMirror) {
  const std::string svg = footprint_figure(data_lens("mirror_ritchey_chretien_57.6m_f24"), -infinity, std::array{0.0});
  double nearest = infinity;
  for (const auto& path : paths(svg, edges)) {
    for (const auto& [x, y] : path) nearest = std::min(nearest, std::hypot(x - 124, y - 180));
  }
  EXPECT_GT(nearest, 10);  // px from the middle of the cell
  EXPECT_LT(nearest, 60);
}

TEST(FootprintFigure, FollowsAPupilThatMovesAway) {
  const Lens lens = data_lens("fisheye_6.3mm_f2.8");
  const std::string svg = footprint_figure(lens, -infinity, std::array{0.0, radians(110.0)});
  EXPECT_EQ(count(svg, "<ellipse"), 1u);
  EXPECT_EQ(count(svg, " mm away"), 1u);
}

TEST(FootprintFigure, DrawsEveryLensWithinItsCells) {
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    const double half = radians(p.half_field_deg.value_or(10));
    const std::string svg = footprint_figure(lens, -infinity, std::array{0.0, 0.7 * half, half});
    EXPECT_EQ(svg.find("nan"), std::string::npos) << p.id;
    for (const auto& path : paths(svg, edges)) {
      for (const auto& [x, y] : path) EXPECT_TRUE(x >= 14 && x <= 702 && y >= 70 && y <= 290) << p.id;
    }
  }
}

TEST(FootprintFigure, ReportsDarkFields) {
  const Lens shut = with_semi_diameter(data_lens("double_gauss_100mm_f1.35"), 5, 0);
  EXPECT_EQ(footprint_figure(shut, -infinity, std::array{0.0, 0.1}).find("nan"), std::string::npos);
  const std::string svg = footprint_figure(data_lens("double_gauss_100mm_f1.35"), -infinity, std::array{radians(60.0)});
  EXPECT_NE(svg.find("no ray passes"), std::string::npos);
  EXPECT_THROW(footprint_figure(data_lens("double_gauss_100mm_f1.35"), -infinity, {}), Error);
}

}  // namespace footprint_figure_test
}  // namespace petzval
