// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/io/json.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace spot_figure_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Indices by the n_d/V_d model: the figure only needs several wavelengths.
Lens lens_of(const std::string& id, const std::vector<double>& wavelengths = {587.5618}, const std::string& name = {}) {
  Prescription p = testing::data_prescription(id);
  if (!name.empty()) p.name = name;
  for (auto& row : p.surfaces) {
    row.medium = {.nd = row.medium.nd, .vd = row.medium.vd};
    row.medium.vd = !row.medium.is_air() ? std::optional(50.0) : std::nullopt;
  }
  return compile(p, wavelengths, {.missing_glass = MissingGlass::abbe});
}

using testing::count;

TEST(SpotFigure, HasACellForEachFieldAndWavelength) {
  const std::vector wavelengths{486.1, 587.6, 656.3};
  const Lens lens = lens_of("double_gauss_100mm_f2.0", wavelengths);
  const std::array fields{0.0, radians(7.0), radians(14.0)};
  const auto spots = spot_diagram(lens, -infinity, fields, 512);
  const std::string svg = spot_figure(lens, spots);
  EXPECT_EQ(count(svg, "stroke=\"#999\""), 3u * 4u);
  EXPECT_EQ(count(svg, "stroke-dasharray"), 3u * 4u);
  EXPECT_EQ(count(svg, "RMS "), 3u * 4u + 1u);
  EXPECT_NE(svg.find("field 14\u00b0"), std::string::npos);
  EXPECT_NE(svg.find("subject at infinity"), std::string::npos);
  for (const char* name : {"486.1 nm", "587.6 nm", "656.3 nm"}) EXPECT_EQ(count(svg, ">" + std::string(name)), 2u);
  for (const Spot& spot : spots.values) {
    EXPECT_NE(svg.find("RMS " + to_text(1e3 * spot.size.rms_radius, 3) + " \u00b5m,  max " +
                       to_text(1e3 * spot.size.max_radius, 3) + " \u00b5m"),
              std::string::npos);
  }
  EXPECT_EQ(svg, spot_figure(lens, spots));
}

TEST(SpotFigure, WeighsTheColumnOfAllWavelengths) {
  const std::vector wavelengths{486.1, 587.6, 656.3};
  const Lens lens = lens_of("double_gauss_100mm_f2.0", wavelengths);
  const auto spots = spot_diagram(lens, -infinity, std::array{radians(7.0)}, 512);
  const auto rms = [](const SpotSize& size) { return "RMS " + to_text(1e3 * size.rms_radius, 3) + " \u00b5m,"; };
  const std::string alone = spot_figure(lens, spots, std::array{0.0, 0.0, 3.0});
  EXPECT_EQ(count(alone, rms(spots[0][2].size)), 2u);
  EXPECT_EQ(count(spot_figure(lens, spots), rms(spots[0][2].size)), 1u);
  EXPECT_EQ(spot_figure(lens, spots, std::array{0.5, 0.5, 0.5}), spot_figure(lens, spots));
  EXPECT_THROW(spot_figure(lens, spots, std::array{1.0, 1.0}), Error);
}

TEST(SpotFigure, DrawsWithinItsCells) {
  const Lens lens = lens_of("double_gauss_100mm_f1.35");
  const std::array fields{0.0, radians(15.0)};
  const std::string svg = spot_figure(lens, spot_diagram(lens, -1500, fields, 2000));
  EXPECT_EQ(testing::expect_marks_within_cells(svg), 2u * 600u);
}

TEST(SpotFigure, ReportsEmptyCells) {
  const Lens lens = lens_of("double_gauss_100mm_f1.35");
  const std::array fields{0.0, radians(60.0)};
  const std::string svg = spot_figure(lens, spot_diagram(lens, -infinity, fields, 256));
  EXPECT_EQ(count(svg, "no rays"), 1u);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf "), std::string::npos);
}

TEST(SpotFigure, ClosedStopHasNoAiryCircle) {
  const Lens lens = with_semi_diameter(lens_of("double_gauss_100mm_f1.35"), 5, 0);
  const std::array fields{0.0};
  const std::string svg = spot_figure(lens, spot_diagram(lens, -infinity, fields, 256));
  EXPECT_EQ(count(svg, "no rays"), 1u);
  EXPECT_EQ(count(svg, "Airy"), 0u);
  EXPECT_EQ(count(svg, "inf "), 0u);
}

TEST(SpotFigure, PerfectLensShowsTheAiryCircle) {
  const Lens lens = lens_of("analytic_plano_hyperbolic_100mm");
  const std::array fields{0.0};
  const std::string svg = spot_figure(lens, spot_diagram(lens, -infinity, fields, 256));
  EXPECT_EQ(count(svg, "stroke-dasharray"), 1u);
  EXPECT_NE(svg.find("at 587.562 nm"), std::string::npos);
}

TEST(SpotFigure, EscapesTheNameOfTheLens) {
  const Lens lens = lens_of("double_gauss_100mm_f1.35", {587.5618}, "A < B & C");
  const std::array fields{0.0};
  const std::string svg = spot_figure(lens, spot_diagram(lens, -infinity, fields, 64));
  EXPECT_NE(svg.find(">A &lt; B &amp; C</text>"), std::string::npos);
}

TEST(SpotFigure, ReplacesInvalidXmlInTheNameOfTheLens) {
  const std::array fields{0.0};
  // A control character, U+FFFE, a surrogate's three bytes, Latin-1, and a character cut off.
  const Lens lens =
      lens_of("double_gauss_100mm_f1.35", {587.5618}, "n\x17p\xEF\xBF\xBEq\xED\xA0\x80r\xB5s\xC2\xB5t\xE2\x82");
  const std::string svg = spot_figure(lens, spot_diagram(lens, -infinity, fields, 64));
  const std::string no = "\xEF\xBF\xBD";
  EXPECT_NE(svg.find(">n" + no + "p" + no + "q" + no + no + no + "r" + no + "s\xC2\xB5t" + no + no + "</text>"),
            std::string::npos);
}

TEST(SpotFigure, RefusesSpotsOfOtherFields) {
  const std::vector wavelengths{486.1, 656.3};
  const Lens lens = lens_of("double_gauss_100mm_f1.35", wavelengths);
  const std::array fields{0.0};
  EXPECT_THROW(spot_figure(lens, {}), Error);
  EXPECT_THROW(spot_figure(lens, {spot_diagram(lens, -infinity, fields, 16).values, 1}), Error);
}

}  // namespace spot_figure_test
}  // namespace petzval
