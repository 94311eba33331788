// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using figure_detail::small_centred;
using figure_detail::small_text;
using figure_detail::Svg;
using figure_detail::svg_number;

constexpr double left = 118, top = 112, bottom = 76, gap = 14, caption_height = 22, width = 960;
constexpr std::size_t drawn_rays = 200;

/// Position of a ray on a moved film, from the centroid of its field (mm).
Vec2<double> offset(const Spot& spot, std::size_t ray, const ThroughFocusSpot& on_film) {
  return {spot.x[ray] + on_film.film_shift_mm * spot.slope_x[ray] - on_film.centroid.x,
          spot.y[ray] + on_film.film_shift_mm * spot.slope_y[ray] - on_film.centroid.y};
}

}  // namespace

std::string through_focus_figure(const Lens& lens, const Grid<Spot>& spots, std::span<const double> film_shifts_mm,
                                 std::span<const double> wavelength_weights) {
  const std::size_t wavelengths = lens.wavelengths_nm().size(), columns = film_shifts_mm.size();
  if (spots.values.empty() || columns == 0) {
    throw Error("through_focus_figure: " + std::to_string(spots.values.size()) + " spots and " +
                std::to_string(columns) + " films; must be at least 1 each");
  }
  const auto weights = figure_detail::checked_weights("through_focus_figure", lens, wavelength_weights);
  const auto cells = through_focus(spots, film_shifts_mm, weights);
  const std::size_t rows = spots.size(), primary = lens.primary_wavelength();
  const auto each_ray = [&](std::size_t row, std::size_t column, std::size_t w, const auto& see) {
    const Spot& spot = spots[row][w];
    if (weights[w] == 0) return;
    for (std::size_t i = 0; i < std::min(drawn_rays, spot.x.size()); ++i) {
      see(offset(spot, i, cells[row][column]));
    }
  };

  const double airy = airy_radius(lens, primary);
  double farthest = std::isfinite(airy) ? airy : 0, error = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      error = std::max(error, cells[row][column].sampling_error_mm);
      for (std::size_t w = 0; w < wavelengths; ++w) {
        each_ray(row, column, w, [&](const Vec2<double>& at) {
          farthest = std::max({farthest, std::abs(at.x), std::abs(at.y)});
        });
      }
    }
  }
  const double limit = farthest > 0 && std::isfinite(farthest) ? 1.08 * farthest : 1e-3;  // half the side of a cell, mm
  const double cell = std::min(190.0, (width - left) / static_cast<double>(columns) - gap), scale = cell / 2 / limit;
  const double step = cell + caption_height + gap, end = top + step * static_cast<double>(rows);

  Svg svg(width, end + bottom);
  figure_detail::draw_head(svg, lens, "Spots through focus", spots.values.front().point.z, primary);
  const auto looks = figure_detail::looks(lens.wavelengths_nm());
  const auto stroke = [&](std::size_t w) {
    return "fill=\"none\" stroke=\"" + std::string(looks[w].colour) + "\" stroke-width=\"0.8\"";
  };
  for (std::size_t w = 0; w < wavelengths; ++w) {
    const double x = gap + 90 * static_cast<double>(w);
    svg.path(figure_detail::ray_marker(looks[w].marker, x + 4, 65), stroke(w));
    svg.text(x + 12, 69, to_text(lens.wavelengths_nm()[w], 6) + " nm");
  }
  for (std::size_t column = 0; column < columns; ++column) {
    const double shift = film_shifts_mm[column], size = std::abs(shift);
    svg.text(left + (cell + gap) * static_cast<double>(column) + cell / 2, top - 10,
             shift == 0 ? std::string("film")
                        : std::string("film ") + (shift > 0 ? "+" : "\u2212") + figure_detail::length_text(size),
             small_centred);
  }
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = top + step * static_cast<double>(row), cy = y + cell / 2;
    svg.text(gap, cy + 4, "field " + figure_detail::field_text(spots[row].front().point.field_rad),
             "font-weight=\"bold\"");
    for (std::size_t column = 0; column < columns; ++column) {
      const double x = left + (cell + gap) * static_cast<double>(column), cx = x + cell / 2;
      svg.rect(x, y, cell, cell, "fill=\"none\" stroke=\"#999\"");
      for (std::size_t w = 0; w < wavelengths; ++w) {
        std::string d;
        each_ray(row, column, w, [&](const Vec2<double>& at) {
          d += figure_detail::ray_marker(looks[w].marker, cx + at.x * scale, cy - at.y * scale);
        });
        if (!d.empty()) svg.path(d, stroke(w));
      }
      if (airy * scale < cell / 2) {
        svg.circle(cx, cy, airy * scale, "fill=\"none\" stroke=\"#000\" stroke-width=\"1\" stroke-dasharray=\"3 2\"");
      }
      const auto& rms = cells[row][column].rms_radius_mm;
      svg.text(cx, y + cell + 15, rms ? "RMS " + figure_detail::length_text(*rms) : "no rays", small_centred);
    }
  }
  figure_detail::draw_scale_bar(svg, left, end + 11, scale, cell / 2, ",  the same in all cells");
  svg.text(gap, end + 35,
           "Shifts of the film towards +z. Origin: centroid of all rays of the field on this film, with " +
               figure_detail::weights_text(weights) + " of the wavelengths. RMS: radius about the centroid.",
           small_text);
  svg.text(gap, end + 51,
           (std::isfinite(airy) ? "Dashed: Airy circle, " + figure_detail::length_text(airy) + ". " : std::string()) +
               std::to_string(spots.values.front().sent) + " rays sent per field and wavelength, at most " +
               std::to_string(drawn_rays) +
               " drawn. Sampling error of RMS (from quarters of the rays): " + figure_detail::length_text(error) + ".",
           small_text);
  return std::move(svg).finish();
}

}  // namespace petzval
