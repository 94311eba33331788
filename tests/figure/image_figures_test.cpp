// SPDX-License-Identifier: Apache-2.0
// Spots through focus, encircled energy, MTF, MTF over the field and colour.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "../expect_error.hpp"
#include "core/text.hpp"
#include "petzval/analysis/aberrations.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/analysis/wavefront.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/pupil/f_number.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace image_figures_test {

using testing::count;
constexpr double far = -std::numeric_limits<double>::infinity();
constexpr std::array f_d_c{486.1327, 587.5618, 656.2725};

Lens double_gauss() { return compile(testing::data_prescription("double_gauss_100mm_f2.0"), f_d_c); }

/// Checks that the sheet is wide enough for its text, with 5.3 px for each character of the small text.
void expect_text_within_sheet(const std::string& svg) {
  const double width = testing::matches(svg, "<svg [^>]*width=\"([0-9.]+)\"").at(0).number(1);
  for (const testing::Match& text :
       testing::matches(svg, "<text x=\"([0-9.]+)\" y=\"[0-9.]+\" font-size=\"11\" fill=\"#555\">([^<]*)<")) {
    EXPECT_LT(text.number(1) + 5.3 * static_cast<double>(text[2].size()), width) << text[2];
  }
}

TEST(ThroughFocusFigure, PrintsTheRadiusOfEachFieldAndFilm) {
  const Lens lens = double_gauss();
  const std::array fields{0.0, radians(9.0)};
  const std::array shifts{-0.3, -0.15, 0.0, 0.15, 0.3};
  const std::array weights{1.0, 2.0, 1.0};
  const auto spots = spot_diagram(lens, far, fields, 512);
  const std::string svg = through_focus_figure(lens, spots, shifts, weights);
  EXPECT_EQ(count(svg, "stroke=\"#999\""), 10u);
  double error = 0;
  for (const ThroughFocusSpot& spot : through_focus(spots, shifts, weights).values) {
    EXPECT_NE(svg.find(">RMS " + to_text(1e3 * *spot.rms_radius_mm, 3) + " \u00b5m<"), std::string::npos);
    error = std::max(error, spot.sampling_error_mm);
  }
  EXPECT_NE(svg.find("(from quarters of the rays): " + to_text(1e3 * error, 3) + " \u00b5m"), std::string::npos);
  for (const char* film : {">film<", ">film +150 \u00b5m<", ">film \u2212300 \u00b5m<", ">field 9\u00b0<"}) {
    EXPECT_NE(svg.find(film), std::string::npos) << film;
  }
  EXPECT_EQ(svg, through_focus_figure(lens, spots, shifts, weights));
  expect_text_within_sheet(svg);
  testing::expect_error([&] { through_focus_figure(lens, {}, shifts); }, {0, "spots"});
  testing::expect_error([&] { through_focus_figure(lens, spots, {}); }, {0, "films"});
  const Lens closed = with_semi_diameter(lens, *lens.stop(), 0);
  EXPECT_EQ(count(through_focus_figure(closed, spot_diagram(closed, far, fields, 64), shifts), ">no rays<"), 10u);
}

// The markers stay within their cells.
TEST(ThroughFocusFigure, DrawsWithinItsCells) {
  const Lens lens = testing::data_lens("mirror_newton_200mm_f8");
  const auto spots = spot_diagram(lens, far, std::array{0.0, radians(1.0)}, 256);
  const std::string svg = through_focus_figure(lens, spots, std::array{-0.2, 0.0, 0.4});
  EXPECT_GT(testing::expect_marks_within_cells(svg), 1000u);
}

TEST(EnergyFigure, HasACurveForEachFieldAndStatesItsError) {
  const Lens lens = double_gauss();
  const std::array fields{0.0, radians(5.0), radians(9.0)};
  const std::array fractions{0.2, 0.5, 0.8, 0.95, 1.0};
  const auto points = encircled_energy(spot_diagram(lens, far, fields, 512), fractions);
  const std::string svg = energy_figure(lens, far, points);
  EXPECT_EQ(testing::paths(svg, "stroke-width=\"1.6\"").size(), 3u);
  double error = 0;
  for (const EncircledEnergy& point : points.values) {
    if (point.fraction < 1) error = std::max(error, point.sampling_error_mm);
  }
  EXPECT_NE(svg.find("(from quarters of the rays): " + to_text(1e3 * error, 3) + " \u00b5m"), std::string::npos);
  EXPECT_EQ(count(svg, "Airy radius<"), 1u);
  expect_text_within_sheet(svg);
  testing::expect_error([&] { energy_figure(lens, far, {}); }, {"points"});
}

TEST(MtfFigures, StateTheirErrorAndLeaveOutDarkFields) {
  const Lens lens = double_gauss();
  const std::array fields{0.0, radians(5.0), radians(9.0)};
  const std::array frequencies{10.0, 20.0, 40.0};
  const auto mtf = [&](std::span<const double> fields_rad, std::uint32_t rays) {
    return geometric_mtf(spot_diagram(lens, far, fields_rad, rays), frequencies);
  };
  const auto points = mtf(fields, 512);
  const std::string svg = mtf_field_figure(lens, far, points);
  EXPECT_EQ(testing::paths(svg, "stroke-width=\"1.6\"").size(), 6u);
  EXPECT_NE(svg.find(">40 line pairs per mm<"), std::string::npos);
  double error = 0;
  for (const MtfPoint& point : points.values) error = std::max(error, point.sampling_error);
  const auto stated = testing::matches(svg, "Sampling error ([0-9.]+) ");
  ASSERT_EQ(stated.size(), 1u);
  EXPECT_GE(stated[0].number(1), 0.95 * error);
  EXPECT_LE(stated[0].number(1), 1.05 * error + 1e-4);
  expect_text_within_sheet(svg);
  expect_text_within_sheet(mtf_figure(lens, far, points));
  testing::expect_error([&] { mtf_field_figure(lens, far, mtf(std::array{0.0}, 64)); }, {1, "fields"});

  const std::array dark{0.0, radians(5.0), radians(80.0)};
  const auto last = testing::paths(mtf_field_figure(lens, far, mtf(dark, 64)), "stroke-width=\"1.6\"");
  for (const testing::Points& curve : last) EXPECT_EQ(curve.size(), 2u);
}

TEST(MtfFigures, ChartsHaveImageHeightsInMillimetres) {
  const Lens lens = double_gauss();
  const std::array fields{0.0, radians(5.0), radians(9.0)};
  const std::array frequencies{10.0, 30.0};
  const auto points = diffraction_mtf(lens, far, fields, frequencies);
  const std::array charts{MtfChart{2, points},
                          MtfChart{8, diffraction_mtf(with_f_number(lens, 8), far, fields, frequencies)}};
  const std::string svg = mtf_chart_figure(lens, far, charts);
  const auto curves = testing::paths(svg, "stroke-width=\"1.6\"");
  ASSERT_EQ(curves.size(), 8u);
  for (std::size_t i = 0; i < 3; ++i) {  // the tangential curve of 30 per mm: contrasts over heights
    const double part = points[i][0].image_height_mm / points[2][0].image_height_mm;
    EXPECT_NEAR(curves[2][i].first, 78 + part * (curves[2][2].first - 78), 0.02);
    EXPECT_NEAR(curves[2][i].second, 84 + 360 * (1 - points[i][1].tangential), 0.02);
  }
  EXPECT_NE(svg.find("image height at f/8 (mm)"), std::string::npos);
  expect_text_within_sheet(svg);
  const auto spots = spot_diagram(lens, far, fields, 64);
  const std::string both = mtf_figure(lens, far, geometric_mtf(spots, frequencies), points);
  EXPECT_EQ(testing::paths(both, "stroke-width=\"1.6\"").size(), 6u);
  EXPECT_EQ(testing::paths(both, "stroke-width=\"0.7\"").size(), 12u);
  expect_text_within_sheet(both);
  testing::expect_error([&] { mtf_chart_figure(lens, far, {}); }, {"charts"});
}

TEST(MtfFigures, ThroughFocusHasTheNumbersOfEachFilm) {
  const Lens lens = double_gauss();
  const std::array fields{0.0, radians(9.0)};
  const std::array frequencies{30.0};
  const std::array shifts{-0.2, -0.1, 0.0, 0.2};
  const auto points = diffraction_mtf(lens, far, fields, frequencies, {}, 1, shifts);
  const std::string svg = mtf_focus_figure(lens, far, shifts, points);
  const auto curves = testing::paths(svg, "stroke-width=\"1.6\"");
  ASSERT_EQ(curves.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {  // the sagittal curve of the second field
    EXPECT_NEAR(curves[3][k].first, 78 + (960 - 78 - 24) * (shifts[k] + 0.2) / 0.4, 0.02);
    EXPECT_NEAR(curves[3][k].second, 84 + 360 * (1 - points[1][k].sagittal), 0.02);
  }
  expect_text_within_sheet(svg);
  testing::expect_error([&] { mtf_focus_figure(lens, far, std::array{0.0, 1.0}, points); }, {2, "shifts", 4});
}

/// Transmittance of a point in a figure: its frame ends at 100 % on top.
double percent(double y, double lowest) { return 100 - (y - 84) / 330 * (100 - lowest); }

TEST(TransmittanceFigures, DrawTheNumbers) {
  const Lens lens = with_coating(double_gauss(), Coating::quarter_wave());
  const std::array fields{0.0, radians(5.0), radians(9.0), radians(80.0)};
  const auto points = transmittance(lens, far, fields);
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  ASSERT_EQ(points.size(), 4u);
  EXPECT_FALSE(points.values.back());
  const std::string over_field = transmittance_field_figure(lens, far, fields, points);
  const auto curves = testing::paths(over_field, "stroke-width=\"1.6\"");
  ASSERT_EQ(curves.size(), wavelengths);
  for (std::size_t w = 0; w < wavelengths; ++w) {
    ASSERT_EQ(curves[w].size(), 3u);  // no light at 80 degrees
    for (std::size_t f = 0; f < 3; ++f) {
      EXPECT_NEAR(percent(curves[w][f].second, 90), 100 * *points[f][w], 0.02);
    }
  }
  expect_text_within_sheet(over_field);
  const std::string over_wavelength = transmittance_figure(lens, far, fields, points);
  const auto lines = testing::paths(over_wavelength, "stroke-width=\"1.6\"");
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_LT(lines[0].front().first, lines[0].back().first);
  EXPECT_NE(over_wavelength.find("(no light)"), std::string::npos);
  expect_text_within_sheet(over_wavelength);
  testing::expect_error([&] { transmittance_figure(lens, far, fields, {{0.5}, 1}); }, {1, "values"});
  testing::expect_error([&] { transmittance_field_figure(lens, far, {{0.0}}, transmittance(lens, far, {{0.0}})); },
                        {"one field"});
}

// Many keys continue in a second row.
TEST(MtfFigures, KeysOfManyFieldsStayOnTheSheet) {
  const Lens lens = double_gauss();
  std::vector<double> fields;
  for (int k = 0; k < 20; ++k) fields.push_back(radians(0.413 * k));
  const auto spots = spot_diagram(lens, far, fields, 16);
  const std::string svg = mtf_figure(lens, far, geometric_mtf(spots, std::array{0.0, 10.0}));
  std::size_t keys = 0;
  for (const testing::Match& key : testing::matches(svg, "<path d=\"M([0-9.]+) [0-9.]+h18\"")) {
    ++keys;
    EXPECT_LT(key.number(1), 920);
  }
  EXPECT_EQ(keys, 21u);
}

TEST(ColourFigure, HasOnePanelForOneWavelengthOrTheAxis) {
  const std::string both = colour_figure(double_gauss(), far, radians(10.0));
  EXPECT_EQ(testing::paths(both, "stroke-width=\"1.6\"").size(), 6u);
  EXPECT_NE(both.find("lateral colour (\u00b5m)"), std::string::npos);
  const std::string one = colour_figure(testing::data_lens("double_gauss_100mm_f2.0"), far, radians(10.0));
  EXPECT_EQ(testing::paths(one, "stroke-width=\"1.6\"").size(), 1u);
  const std::string axis = colour_figure(double_gauss(), far, 0);
  for (const std::string& svg : {one, axis}) EXPECT_EQ(svg.find("lateral colour ("), std::string::npos);
  const std::string squeezed = colour_figure(testing::data_lens("anamorphic_60mm_2x"), far, 0);
  EXPECT_EQ(testing::paths(squeezed, "stroke-width=\"1.6\"").size(), 2u);
  EXPECT_NE(squeezed.find("dashed in x-z"), std::string::npos);
  for (const std::string& svg : {both, one, axis, squeezed}) expect_text_within_sheet(svg);
  testing::expect_error([] { colour_figure(double_gauss(), far, -0.1); }, {"field"});
}

}  // namespace image_figures_test
}  // namespace petzval
