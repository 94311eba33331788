// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../data_lenses.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/illumination.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace illumination_figure_test {

using testing::data_lens;
using testing::paths;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The height of the last point of a curve, relative to its first; the bottom of the frame is 0.
double last(const std::string& svg, const std::string& style) {
  constexpr double foot = 70 + 300;
  const auto curve = paths(svg, style).at(0);
  return (foot - curve.back().second) / (foot - curve.front().second);
}

TEST(IlluminationFigure, EndsAtTheComputedValue) {
  for (const char* id : {"biogon_35mm_f2.8", "double_gauss_100mm_f1.35"}) {
    const Lens lens = data_lens(id);
    const double field = radians(12.0);
    const std::string svg = illumination_figure(lens, -infinity, field);
    const double wanted = *relative_illumination(lens, {field, -infinity});
    EXPECT_NEAR(last(svg, "stroke-width=\"2\" stroke-linejoin"), wanted, 1e-4) << id;
    EXPECT_NEAR(last(svg, "stroke=\"#888\" stroke-width=\"1\""), std::pow(std::cos(field), 4), 1e-4) << id;
    EXPECT_EQ(svg, illumination_figure(lens, -infinity, field));
  }
}

TEST(IlluminationFigure, GoesBeyondNinetyDegrees) {
  const std::string svg = illumination_figure(data_lens("fisheye_6.3mm_f2.8"), -infinity, radians(110.0));
  EXPECT_GT(last(svg, "stroke-width=\"2\" stroke-linejoin"), 0.2);
  EXPECT_EQ(last(svg, "stroke=\"#888\" stroke-width=\"1\""), 0);
}

TEST(IlluminationFigure, RequiresAField) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  EXPECT_THROW(illumination_figure(lens, -infinity, 0), Error);
  EXPECT_THROW(illumination_figure(lens, -infinity, -0.1), Error);
  EXPECT_THROW(illumination_figure(lens, -infinity, std::nan("")), Error);
}

}  // namespace illumination_figure_test
}  // namespace petzval
