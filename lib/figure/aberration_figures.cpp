// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "axes.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/analysis/aberrations.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using figure_detail::Axes;
using figure_detail::curve_style;
using figure_detail::round_range;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// The errors that a figure of fans draws.
struct FanErrors {
  std::string_view function, title;
  std::optional<double> RayFan::Point::*tangential;
  std::optional<double> RayFan::Point::*sagittal;
  double scale;
  std::string_view tangential_axis, sagittal_axis;
  std::string note;
};

std::string draw_fans(const Lens& lens, double subject_z, const Grid<RayFan>& fans, const FanErrors& errors) {
  const std::size_t wavelengths = lens.wavelengths_nm().size(), fields = fans.size();
  if (fans.values.empty() || fans.columns != wavelengths) {
    throw Error(std::string(errors.function) + ": " + std::to_string(fans.values.size()) +
                " fans; must be one or more for each of the " + std::to_string(wavelengths) + " wavelengths");
  }
  constexpr double width = 960, left = 78, top = 84, height = 150, step = 214, cell = 380, second = left + cell + 92;
  double largest = 0;
  for (const RayFan& fan : fans.values) {
    for (const RayFan::Point& point : fan.points) {
      for (const auto& error : {point.*errors.tangential, point.*errors.sagittal}) {
        largest = std::max(largest, std::abs(error.value_or(0)));
      }
    }
  }
  const std::vector<figure_detail::Look> looks = figure_detail::looks(lens.wavelengths_nm());
  const double range = round_range(errors.scale * largest, 1e-3);
  figure_detail::Svg svg(width, top + step * static_cast<double>(fields) + 40);
  figure_detail::draw_head(svg, lens, errors.title, subject_z, lens.primary_wavelength());
  for (std::size_t f = 0; f < fields; ++f) {
    const double y = top + step * static_cast<double>(f);
    const std::string name = figure_detail::field_text(fans[f].front().field_rad) + ", ";
    for (const bool tangential : {true, false}) {
      Axes axes(svg, tangential ? left : second, y, cell, height,
                {-1, 1, name + (tangential ? "y on the stop" : "x on the stop")},
                {-range, range, std::string(tangential ? errors.tangential_axis : errors.sagittal_axis)});
      for (std::size_t w = 0; w < wavelengths; ++w) {
        std::vector<Axes::Point> curve;
        for (const RayFan::Point& point : fans[f][w].points) {
          const auto& error = point.*(tangential ? errors.tangential : errors.sagittal);
          curve.push_back({point.pupil, errors.scale * error.value_or(nothing)});
        }
        axes.curve(curve, curve_style(looks[w].colour));
      }
    }
  }
  double x = left;
  for (std::size_t w = 0; w < wavelengths; ++w) {
    x = 24 + figure_detail::draw_key(svg, x, top + step * static_cast<double>(fields) + 8, looks[w].colour,
                                     to_text(lens.wavelengths_nm()[w], 6) + " nm");
  }
  svg.text(figure_detail::sheet_margin, top + step * static_cast<double>(fields) + 30, errors.note,
           figure_detail::small_text);
  return std::move(svg).finish();
}

}  // namespace

std::string fan_figure(const Lens& lens, double subject_z, const Grid<RayFan>& fans) {
  return draw_fans(lens, subject_z, fans,
                   {"fan_figure", "Ray fans", &RayFan::Point::tangential_mm, &RayFan::Point::sagittal_mm, 1000,
                    "error of y (\u00b5m)", "error of x (\u00b5m)",
                    "Positions on the film relative to the chief ray of " +
                        to_text(lens.wavelengths_nm()[lens.primary_wavelength()], 6) +
                        " nm. Curves end where the lens clips the rays. Exact rays."});
}

std::string wavefront_figure(const Lens& lens, double subject_z, const Grid<RayFan>& fans) {
  return draw_fans(lens, subject_z, fans,
                   {"wavefront_figure", "Wavefront", &RayFan::Point::tangential_waves, &RayFan::Point::sagittal_waves,
                    1, "error (waves)", "error (waves)",
                    "Relative to a sphere about the chief ray of the same wavelength; positive if the wavefront is "
                    "ahead. Exact rays."});
}

std::string field_figure(const Lens& lens, double subject_z, double field_rad) {
  if (!(field_rad > 0)) {
    throw Error("field_figure: field = " + to_text(degrees(field_rad), 6) + " degrees; must be positive");
  }
  constexpr int steps = 40;
  constexpr double width = 960, left = 78, top = 84, height = 330, cell = 380, second = left + cell + 92;
  std::vector<double> fields;
  for (int k = 0; k <= steps; ++k) fields.push_back(field_rad * k / steps);
  const std::vector<FieldFocus> foci = field_curvature(lens, subject_z, fields);
  const std::vector<FieldDistortion> distortion = distortion_percent(lens, subject_z, fields);
  const bool wide = field_rad > radians(60.0);  // f tan(theta) means little for fisheyes
  std::vector<Axes::Point> tangential, sagittal, projection;
  double shift = 0, percent = 0;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const double field = degrees(fields[k]);
    const auto value = wide ? distortion[k].f_theta_percent : distortion[k].f_tan_theta_percent;
    tangential.push_back({foci[k].tangential_mm.value_or(nothing), field});
    sagittal.push_back({foci[k].sagittal_mm.value_or(nothing), field});
    projection.push_back({value.value_or(nothing), field});
    shift = std::max({shift, std::abs(foci[k].tangential_mm.value_or(0)), std::abs(foci[k].sagittal_mm.value_or(0))});
    percent = std::max(percent, std::abs(value.value_or(0)));
  }
  const double range = round_range(shift, 1e-3), percents = round_range(percent, 0.1), end = degrees(field_rad);
  figure_detail::Svg svg(width, top + height + 96);
  figure_detail::draw_head(svg, lens, "Field curvature and distortion", subject_z, lens.primary_wavelength());
  Axes focus(svg, left, top, cell, height, {-range, range, "focus from the film (mm)"},
             {0, end, "field angle (\u00b0)"});
  focus.curve(tangential, curve_style("#1f5fc4"));
  focus.curve(sagittal, curve_style("#c4451f", "stroke-dasharray=\"5 3\""));
  Axes shown(svg, second, top, cell, height,
             {-percents, percents, wide ? "distortion of f \u03b8 (%)" : "distortion of f tan \u03b8 (%)"},
             {0, end, "field angle (\u00b0)"});
  shown.curve(projection, curve_style("#1f5fc4"));
  const double y = top + height + 58;
  const double x = figure_detail::draw_key(svg, left, y, "#1f5fc4", "tangential");
  figure_detail::draw_key(svg, x + 30, y, "#c4451f", "sagittal (dashed)");
  svg.text(figure_detail::sheet_margin, y + 24,
           "Foci of narrow beams about the chief ray, positive away from the lens; height of the chief ray on the film "
           "compared with the projection.",
           figure_detail::small_text);
  return std::move(svg).finish();
}

std::string mtf_figure(const Lens& lens, double subject_z, const Grid<MtfPoint>& points,
                       const Grid<MtfPoint>& diffraction) {
  if (points.values.empty()) throw Error("mtf_figure: there are no points; must be at least one");
  constexpr double width = 960, left = 78, top = 84, height = 360;
  const bool diffracted = !diffraction.values.empty();
  double highest = 0;
  for (const MtfPoint& point : points.values) highest = std::max(highest, point.frequency_per_mm);
  std::vector<figure_detail::Key> keys;
  for (std::size_t field = 0; field < points.size(); ++field) {
    const std::string name = figure_detail::field_text(points[field].front().field_rad);
    keys.push_back({figure_detail::field_colour(field), name});
  }
  keys.push_back({"#888", diffracted ? "diffraction limits" : "diffraction limit on the axis"});
  const double y = top + height + 58, last_y = y + figure_detail::key_rows(left, width, keys);
  figure_detail::Svg svg(width, last_y + 58);
  figure_detail::draw_head(svg, lens, diffracted ? "MTF" : "Geometric MTF", subject_z, lens.primary_wavelength());
  Axes axes(svg, left, top, width - left - 24, height, {0, highest > 0 ? highest : 1, "frequency (line pairs per mm)"},
            {0, 1, "contrast"});
  figure_detail::draw_keys(svg, left, y, width, keys);
  const auto draw = [&](const Grid<MtfPoint>& grid, double MtfPoint::*tangential, double MtfPoint::*sagittal,
                        const auto& style) {
    for (std::size_t field = 0; field < grid.size(); ++field) {
      for (const auto& [contrast, dashes] :
           {std::pair(tangential, ""), std::pair(sagittal, "stroke-dasharray=\"5 3\"")}) {
        std::vector<Axes::Point> curve;
        for (const MtfPoint& point : grid[field]) curve.push_back({point.frequency_per_mm, point.*contrast});
        axes.curve(curve, style(field) + dashes);
      }
    }
  };
  const auto thin = [](std::string_view colour) {
    return "fill=\"none\" stroke-width=\"0.7\" stroke=\"" + std::string(colour) + "\" ";
  };
  const auto bold = [](std::size_t field) { return curve_style(figure_detail::field_colour(field), " "); };
  if (diffracted) {
    draw(diffraction, &MtfPoint::tangential_limit, &MtfPoint::sagittal_limit,
         [&](std::size_t) { return thin("#888"); });
    draw(points, &MtfPoint::tangential, &MtfPoint::sagittal,
         [&](std::size_t field) { return thin(figure_detail::field_colour(field)); });
  } else {
    const double f_number = film_side_f_number(lens);
    const double nm = lens.wavelengths_nm()[lens.primary_wavelength()] / lens.index(lens.surface_count());
    std::vector<Axes::Point> limit;
    for (int k = 0; k <= 100; ++k) {
      const double frequency = highest * k / 100;
      limit.push_back({frequency, diffraction_limited_mtf(frequency, nm, f_number)});
    }
    axes.curve(limit, thin("#888"));
  }
  draw(diffracted ? diffraction : points, &MtfPoint::tangential, &MtfPoint::sagittal, bold);
  svg.text(figure_detail::sheet_margin, last_y + 24,
           diffracted ? std::string("Solid: tangential, dashed: sagittal; thin: by rays, without diffraction. Error of "
                                    "the others at most ") +
                            figure_detail::error_text(diffraction.values) + "."
                      : "Solid: tangential, dashed: sagittal. Rays only: where a curve is near or above the limit, "
                        "diffraction decides. " +
                            figure_detail::sampling_error_text(points.values) + ".",
           figure_detail::small_text);
  return std::move(svg).finish();
}

std::string seidel_figure(const Lens& lens, double subject_z, const SeidelSums& sums, int first_surface_number) {
  if (sums.surfaces.size() != lens.surface_count()) {
    throw Error("seidel_figure: sums of " + std::to_string(sums.surfaces.size()) + " surfaces; must be " +
                std::to_string(lens.surface_count()) + ", as the lens has");
  }
  constexpr double width = 960, left = 78, top = 84, height = 230, step = 330;
  struct Term {
    double SeidelTerms::*value;
    std::string_view name, colour;
  };
  constexpr std::array aberrations{
      Term{&SeidelTerms::s1, "S1 spherical", "#1f5fc4"}, Term{&SeidelTerms::s2, "S2 coma", "#1a8f3c"},
      Term{&SeidelTerms::s3, "S3 astigmatism", "#d0331f"}, Term{&SeidelTerms::s4, "S4 Petzval", "#b97a00"},
      Term{&SeidelTerms::s5, "S5 distortion", "#7b3fb5"}};
  constexpr std::array colours{Term{&SeidelTerms::c1, "C1 axial colour", "#00858f"},
                               Term{&SeidelTerms::c2, "C2 lateral colour", "#8a4b2a"}};
  figure_detail::Svg svg(width, top + 2 * step);
  figure_detail::draw_head(svg, lens, "Seidel and chromatic sums", subject_z, lens.primary_wavelength());
  const double first = first_surface_number;
  const double end = first + static_cast<double>(sums.surfaces.size() + 2);  // a gap, then the sums
  const auto draw = [&](double y, std::span<const Term> terms) {
    double largest = 0;
    const auto each = [&](const auto& body) {
      for (std::size_t i = 0; i < sums.surfaces.size(); ++i) body(first + static_cast<double>(i), sums.surfaces[i]);
      body(end - 1, sums.sums);
    };
    each([&](double, const SeidelTerms& at) {
      for (const Term& term : terms) largest = std::max(largest, std::abs(at.*term.value));
    });
    const double range = round_range(1000 * largest, 1e-6);
    Axes axes(svg, left, y, width - left - 24, height,
              {.from = first - 0.5,
               .to = end - 0.5,
               .title = "surface, from " + std::to_string(first_surface_number) + "; the last bars are the sums",
               .ticks_to = end - 3},
              {-range, range, "\u00b5m"});
    svg.text(axes.x(end - 1), y + height + 16, "sum", figure_detail::small_centred);
    each([&](double place, const SeidelTerms& at) {
      const double bar = 0.8 / static_cast<double>(terms.size());
      for (std::size_t k = 0; k < terms.size(); ++k) {
        const double begin = place - 0.4 + bar * static_cast<double>(k), value = 1000 * (at.*terms[k].value);
        const double low = axes.y(std::min(value, 0.0)), high = axes.y(std::max(value, 0.0));
        svg.rect(axes.x(begin), high, axes.x(begin + bar) - axes.x(begin), low - high,
                 "fill=\"" + std::string(terms[k].colour) + "\"");
      }
    });
    axes.curve(std::array{Axes::Point{first - 0.5, 0}, Axes::Point{end - 0.5, 0}}, curve_style("#444"));
    double x = left;
    for (const Term& term : terms) x = 24 + figure_detail::draw_key(svg, x, y + height + 58, term.colour, term.name);
  };
  draw(top, aberrations);
  draw(top + step, colours);
  return std::move(svg).finish();
}

}  // namespace petzval
