// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/pupil/illumination.hpp"

namespace petzval {

std::string illumination_figure(const Lens& lens, double subject_z, double field_rad) {
  if (!(field_rad > 0)) {
    throw Error("illumination_figure: field = " + to_text(degrees(field_rad), 6) + " degrees; must be positive");
  }
  constexpr int steps = 30;
  constexpr double width = 960, left = 78, top = 70, height = 300;
  const std::size_t wavelength = lens.primary_wavelength();
  std::vector<std::pair<double, double>> real, reference;
  double highest = 1;
  for (int k = 0; k <= steps; ++k) {
    const double field = field_rad * k / steps;
    const double value = relative_illumination(lens, {field, subject_z}, wavelength).value_or(0);
    real.push_back({degrees(field), value});
    const double cosine = field < std::numbers::pi / 2 ? std::cos(field) : 0;
    reference.push_back({degrees(field), cosine * cosine * cosine * cosine});
    highest = std::max(highest, value);
  }

  figure_detail::Svg svg(width, top + height + 92);
  figure_detail::draw_head(svg, lens, "Relative illumination", subject_z, wavelength);
  figure_detail::Axes axes(svg, left, top, width - left - 24, height, {0, degrees(field_rad), "field angle (\u00b0)"},
                           {0, 1.05 * highest, "relative illumination"});
  axes.curve(reference, "fill=\"none\" stroke=\"#888\" stroke-width=\"1\"");
  axes.curve(real, "fill=\"none\" stroke=\"#1f5fc4\" stroke-width=\"2\" stroke-linejoin=\"round\"");
  const double y = top + height + 58;
  const double x = figure_detail::draw_key(svg, left, y, "#1f5fc4", "this lens, vignetting included");
  figure_detail::draw_key(svg, x + 30, y, "#888", "cos\u2074 of the field angle");
  svg.text(figure_detail::sheet_margin, y + 24,
           "Irradiance of the film for a uniform scene, relative to the axis: n'\u00b2 times the projected solid angle "
           "of the vignetted exit pupil.",
           figure_detail::small_text);
  return std::move(svg).finish();
}

}  // namespace petzval
