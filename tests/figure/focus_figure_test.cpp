// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../data_lenses.hpp"
#include "petzval/analysis/spot.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "svg_parts.hpp"

namespace petzval {
namespace focus_figure_test {

using testing::data_lens;
using testing::paths;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The number in a line below the diagram, mm.
struct Line {
  double least = 0, shift = 0, on_film = 0;
};

Line line_of(const std::string& svg, const std::string& name) {
  const auto found = testing::matches(
      svg,
      ">" + name +
          ":  least RMS ([0-9.]+) (\u00b5m|mm) at (\\+|\u2212)([0-9.e-]+) mm,  ([0-9.]+) (\u00b5m|mm) on the film<");
  if (found.empty()) {
    ADD_FAILURE() << name << " not found";
    return {};
  }
  const testing::Match& m = found[0];
  const auto unit = [](const std::string& s) { return s == "mm" ? 1 : 1e-3; };
  return {m.number(1) * unit(m[2]), m.number(4) * (m[3] == "+" ? 1 : -1), m.number(5) * unit(m[6])};
}

double rms(const Lens& lens, double field, double film_z) {
  return spot_diagram(with_film(lens, film_z), -infinity, std::array{field})[0][0].size.rms_radius;
}

TEST(FocusFigure, TheParabolaIsTheSpotAtEveryFilmPosition) {
  const Lens lens = data_lens("tessar_100mm_f2.8");
  const std::array fields{0.0, radians(17.5), radians(25.0)};
  const std::string svg = focus_figure(lens, -infinity, fields);
  const double paraxial = paraxial_image_z(lens, -infinity);
  const std::array names{"field 0\u00b0", "field 17.5\u00b0", "field 25\u00b0"};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Line line = line_of(svg, names[i]);
    // Three digits are printed.
    EXPECT_NEAR(line.on_film / rms(lens, fields[i], lens.film_z()), 1, 6e-3) << names[i];
    EXPECT_NEAR(line.least / rms(lens, fields[i], paraxial + line.shift), 1, 6e-3) << names[i];
    EXPECT_GT(rms(lens, fields[i], paraxial + line.shift + 0.3), line.least);
    EXPECT_GT(rms(lens, fields[i], paraxial + line.shift - 0.3), line.least);
  }
}

TEST(FocusFigure, AxisIsSharpestAtTheSolvedFilm) {
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const double paraxial = paraxial_image_z(lens, -infinity);
  const double best = solve_focus(lens, infinity, {FocusCriterion::min_rms}).film_z - paraxial;
  EXPECT_NEAR(line_of(focus_figure(lens, -infinity, std::array{0.0}), "field 0\u00b0").shift, best, 0.01 * best);
}

TEST(FocusFigure, TheMeanIsTheRootOfTheMeanSquare) {
  const Lens lens = data_lens("cooke_triplet_50mm_f5");
  const std::array fields{0.0, radians(20.0)};
  const Line mean = line_of(focus_figure(lens, -infinity, fields), "mean of the fields \\(dashed\\)");
  const double a = rms(lens, fields[0], lens.film_z()), b = rms(lens, fields[1], lens.film_z());
  EXPECT_NEAR(mean.on_film / std::sqrt((a * a + b * b) / 2), 1, 6e-3);
}

TEST(FocusFigure, WeighsWavelengths) {
  const Prescription p = testing::data_prescription("cooke_triplet_50mm_f5");
  const CompileOptions abbe{.missing_glass = MissingGlass::abbe};
  const Lens three = compile(p, std::array{486.1327, d_line_nm, 656.2725}, abbe);
  const auto on_film = [](const Lens& lens, std::span<const double> weights) {
    return line_of(focus_figure(lens, -infinity, std::array{0.0}, weights), "field 0\u00b0").on_film;
  };
  const double equal = on_film(three, {});
  EXPECT_EQ(on_film(three, std::array{2.0, 2.0, 2.0}), equal);
  const double blue = on_film(compile(p, std::array{486.1327}, abbe), {});
  EXPECT_EQ(on_film(three, std::array{1.0, 0.0, 0.0}), blue);
  EXPECT_NE(blue, equal);
  for (const std::vector<double>& wrong : {std::vector{1.0}, {1.0, -1.0, 1.0}, {0.0, 0.0, 0.0}}) {
    EXPECT_THROW(focus_figure(three, -infinity, std::array{0.0}, wrong), Error);
  }
}

TEST(FocusFigure, CurvesStayWithinTheFrame) {
  const Lens lens = data_lens("tessar_100mm_f2.8");  // its curves leave the frame at the top
  const std::string svg = focus_figure(lens, -infinity, std::array{0.0, radians(25.0)});
  std::size_t curves = 0;
  double highest = 480;
  for (const auto& curve : paths(svg, "stroke-linejoin=\"round\"")) {
    ++curves;
    for (const auto& [x, y] : curve) {
      EXPECT_TRUE(x >= 78 && x <= 936 && y >= 140 && y <= 480) << x << ' ' << y;
      highest = std::min(highest, y);
    }
  }
  EXPECT_EQ(highest, 140);
  EXPECT_EQ(curves, 3u);
}

TEST(FocusFigure, ReportsMissingFocus) {
  // No ray passes beyond the field; a window has no focus.
  const Lens lens = data_lens("double_gauss_100mm_f1.35");
  const std::string svg = focus_figure(lens, -infinity, std::array{0.0, radians(60.0)});
  EXPECT_NE(svg.find("field 60\u00b0:  no focus"), std::string::npos);
  Prescription window;
  window.surfaces = {{.radius = 0, .thickness = 5, .medium = {.nd = 1.5}, .semi_diameter = 10, .stop = true},
                     {.radius = 0, .thickness = 50, .semi_diameter = 12}};
  const std::string flat = focus_figure(compile(window), -infinity, std::array{0.0});
  EXPECT_NE(flat.find("no focus"), std::string::npos);
  EXPECT_EQ(flat.find("nan"), std::string::npos);
}

TEST(FocusFigure, DrawsEveryLensAndTheSameTwice) {
  for (const Prescription& p : testing::data_prescriptions()) {
    const Lens lens = compile(p);
    const std::array fields{0.0, radians(p.half_field_deg.value_or(10))};
    const std::string svg = focus_figure(lens, -infinity, fields);
    EXPECT_EQ(svg.find("nan"), std::string::npos) << p.id;
    EXPECT_EQ(svg.find("inf "), std::string::npos) << p.id;
    if (p.id == "cooke_triplet_50mm_f5") {
      EXPECT_EQ(svg, focus_figure(lens, -infinity, fields));
    }
  }
  EXPECT_THROW(focus_figure(data_lens("cooke_triplet_50mm_f5"), -infinity, {}), Error);
}

}  // namespace focus_figure_test
}  // namespace petzval
