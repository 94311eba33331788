// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "petzval/core/error.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace focus_pull_figure_test {

using testing::count;
using testing::paths;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<FocusPullFrame> pull() {
  std::vector<FocusPullFrame> frames;
  for (const double distance : {500.0, 1000.0, 2000.0, infinity}) {
    const auto time = static_cast<double>(frames.size());
    frames.push_back({.time = time, .film = {.z_mm = 60 - time}, .subject_distance = distance, .rms_mm = 0.01});
  }
  return frames;
}

TEST(FocusPullFigure, ShowsInverseDistances) {
  const auto frames = pull();
  const std::string svg = focus_pull_figure("A <lens>", "", frames, std::vector<double>{1, 2});
  const auto curve = paths(svg, "stroke=\"#1a8f3c\"").at(0);
  ASSERT_EQ(curve.size(), 4u);
  const auto rise = [&](std::size_t i) { return curve[i + 1].second - curve[i].second; };
  EXPECT_NEAR(rise(0), 2 * rise(1), 0.05);  // 2, 1, 0.5 and 0 dioptres
  EXPECT_NEAR(rise(1), rise(2), 0.05);
  EXPECT_NEAR(curve[3].second, 76 + 170, 0.05);              // at the foot
  EXPECT_EQ(paths(svg, "stroke=\"#999\"").size(), 2u * 3u);  // keys, in each diagram
  EXPECT_EQ(svg.find("swing"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(count(svg, "A &lt;lens&gt;"), 1u);
}

TEST(FocusPullFigure, OmitsTheColourIfTheFilmIsKept) {
  auto frames = pull();
  frames[1].rms_mm = frames[2].rms_mm = std::nan("");
  const std::string svg = focus_pull_figure("", "", frames, {});
  EXPECT_EQ(paths(svg, "stroke=\"#1f5fc4\"").size(), 0u);  // no two neighbours left
  EXPECT_EQ(paths(svg, "stroke=\"#aaa\"").at(1).size(), 4u);
}

TEST(FocusPullFigure, ShowsTilt) {
  auto frames = pull();
  frames[2].film.tilt_rad = 0.1;
  EXPECT_NE(focus_pull_figure("", "", frames, {}).find(">tilt, swing"), std::string::npos);
}

TEST(FocusPullFigure, DrawsOneFrame) {
  const std::vector<FocusPullFrame> one{{.time = 3, .film = {.z_mm = 50}, .subject_distance = 1000, .rms_mm = 0}};
  EXPECT_EQ(focus_pull_figure("", "", one, {}).find("nan"), std::string::npos);
}

TEST(FocusPullFigure, RequiresFiniteFramesInOrder) {
  EXPECT_THROW(focus_pull_figure("", "", {}, {}), Error);
  const auto refuses = [](auto change) {
    auto frames = pull();
    change(frames[1]);
    EXPECT_THROW(focus_pull_figure("", "", frames, {}), Error);
  };
  refuses([](FocusPullFrame& f) { f.time = 0; });
  refuses([](FocusPullFrame& f) { f.film.z_mm = infinity; });
  refuses([](FocusPullFrame& f) { f.subject_distance = 0; });
  refuses([](FocusPullFrame& f) { f.subject_distance = std::nan(""); });
  refuses([](FocusPullFrame& f) { f.rms_mm = infinity; });
  refuses([](FocusPullFrame& f) { f.film.swing_rad = std::nan(""); });
}

}  // namespace focus_pull_figure_test
}  // namespace petzval
