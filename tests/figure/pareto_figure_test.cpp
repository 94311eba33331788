// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace pareto_figure_test {

using testing::count;
using testing::paths;

const std::vector<ParetoPoint> ladder{{"first", 1, 1000, 100, true},
                                      {"slow", 5, 2000, 100, false},
                                      {"second", 10, 10, 1, true},
                                      {"exact", 100, 0, 0, true}};

TEST(ParetoFigure, JoinsTheFrontOnLogarithmicAxes) {
  const std::string svg = pareto_figure("A lens", "f/2", ladder);
  const auto front = paths(svg, "stroke-width=\"1.5\" stroke-linejoin").at(0);
  ASSERT_EQ(front.size(), 3u);
  EXPECT_NEAR(front[1].first - front[0].first, front[2].first - front[1].first, 0.05);  // a decade each
  // The front falls by two decades, then to the lower edge of the frame.
  EXPECT_NEAR((front[2].second - front[1].second) / (front[1].second - front[0].second), 0.75, 0.01);
  EXPECT_NEAR(front[2].second, 70 + 420, 0.05);
}

TEST(ParetoFigure, NamesAndMarksEveryModel) {
  const std::string svg = pareto_figure("A <lens>", "f/2 & more", ladder);
  for (const auto& p : ladder) EXPECT_EQ(count(svg, ">" + std::string(p.name)), 1u) << p.name;
  EXPECT_EQ(count(svg, "r=\"5\" fill=\"#1f5fc4\""), 3u);
  EXPECT_EQ(count(svg, "r=\"5\" fill=\"#fff\""), 1u);
  EXPECT_EQ(count(svg, "A &lt;lens&gt;"), 1u);
  EXPECT_EQ(count(svg, ">exact (0)"), 1u);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(ParetoFigure, DrawsOneModelWithoutError) {
  const std::vector<ParetoPoint> one{{"exact", 10, 0, 0, true}};
  const std::string svg = pareto_figure("A lens", "", one);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(count(svg, "r=\"5\""), 1u);
}

TEST(ParetoFigure, RequiresPositiveNumbers) {
  EXPECT_THROW(pareto_figure("", "", {}), Error);
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(pareto_figure("", "", std::vector<ParetoPoint>{{"a", bad, 1, 1, true}}), Error) << bad;
    EXPECT_THROW(pareto_figure("", "", std::vector<ParetoPoint>{{"a", 1, bad, 1, true}}), Error) << bad;
    EXPECT_THROW(pareto_figure("", "", std::vector<ParetoPoint>{{"a", 1, 1, bad, true}}), Error) << bad;
  }
  EXPECT_THROW(pareto_figure("", "", std::vector<ParetoPoint>{{"a", 0, 1, 1, true}}), Error);
}

}  // namespace pareto_figure_test
}  // namespace petzval
