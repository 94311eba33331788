// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/points.hpp"
#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

using figure_detail::ray_marker;
using figure_detail::small_centred;
using figure_detail::small_text;
using figure_detail::Svg;
using figure_detail::svg_number;

constexpr double cell = 190, gap = 14,
                 caption_height = 22;  // side of a cell, space between cells, height of the line below
constexpr double left = 118, top = 112, bottom = 108;
constexpr std::size_t drawn_rays = 600;

class SpotFigure {
 public:
  SpotFigure(const Lens& lens, const Grid<Spot>& spots, std::vector<double> weights)
      : lens_(lens),
        spots_(spots),
        weights_(std::move(weights)),
        wavelengths_(lens.wavelengths_nm().size()),
        rows_(spots.size()),
        columns_(wavelengths_ == 1 ? 1 : 1 + wavelengths_),
        looks_(figure_detail::looks(lens.wavelengths_nm())),
        f_number_(film_side_f_number(lens)),
        svg_(std::max(960.0, left + static_cast<double>(columns_) * (cell + gap) + gap),
             top + static_cast<double>(rows_) * (cell + caption_height + gap) + bottom) {
    for (std::size_t row = 0; row < rows_; ++row) {
      std::vector<RayBundle> hits;
      for (const Spot& spot : of(row))
        hits.push_back(figure_detail::weighted({.x = spot.x, .y = spot.y}, weights_[spot.wavelength]));
      sizes_.push_back(spot_size(hits));
    }
    limit_ = 1.08 * std::max(extent(), airy(lens_.primary_wavelength()));
    if (!(limit_ > 0 && std::isfinite(limit_))) limit_ = 1e-3;
  }

  std::string draw() && {
    title();
    for (std::size_t row = 0; row < rows_; ++row) {
      label(row);
      for (std::size_t column = 0; column < columns_; ++column) draw_cell(row, column);
    }
    footer();
    return std::move(svg_).finish();
  }

 private:
  std::span<const Spot> of(std::size_t row) const { return spots_[row]; }
  double airy(std::size_t w) const { return airy_radius(lens_, w); }
  double cell_x(std::size_t column) const { return left + static_cast<double>(column) * (cell + gap); }
  double cell_y(std::size_t row) const { return top + static_cast<double>(row) * (cell + caption_height + gap); }

  /// Largest distance of a hit from the origin of its row, along x or y.
  double extent() const {
    double farthest = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      for (const Spot& spot : of(row)) {
        for (const double x : spot.x) farthest = std::max(farthest, std::abs(x - sizes_[row].centroid.x));
        for (const double y : spot.y) farthest = std::max(farthest, std::abs(y - sizes_[row].centroid.y));
      }
    }
    return farthest;
  }

  void title() {
    figure_detail::draw_head(svg_, lens_, "Spot diagram", spots_.values.front().point.z, lens_.primary_wavelength());
    double x = gap;
    for (std::size_t w = 0; w < wavelengths_; ++w) {
      svg_.path(ray_marker(looks_[w].marker, x + 4, 65), stroke(w));
      const std::string name = to_text(lens_.wavelengths_nm()[w], 6) + " nm";
      svg_.text(x + 12, 69, name);
      x += 90;
    }
    for (std::size_t column = 0; columns_ > 1 && column < columns_; ++column) {
      svg_.text(cell_x(column) + cell / 2, top - 10,
                column == 0 ? "all wavelengths" : to_text(lens_.wavelengths_nm()[column - 1], 6) + " nm",
                small_centred);
    }
  }

  std::string stroke(std::size_t w) const {
    return "fill=\"none\" stroke=\"" + std::string(looks_[w].colour) + "\" stroke-width=\"0.8\"";
  }

  void label(std::size_t row) {
    const double y = cell_y(row) + cell / 2;
    svg_.text(gap, y - 6, "field " + to_text(degrees(of(row).front().point.field_rad), 4) + "\u00b0",
              "font-weight=\"bold\"");
    const auto& chief = of(row)[lens_.primary_wavelength()].chief_ray_height;
    svg_.text(gap, y + 12, "chief ray at", small_text);
    svg_.text(gap, y + 27, chief ? "y = " + to_text(*chief, 4) + " mm" : "none", small_text);
  }

  void draw_cell(std::size_t row, std::size_t column) {
    const double x = cell_x(column), y = cell_y(row);
    const double cx = x + cell / 2, cy = y + cell / 2, scale = cell / 2 / limit_;
    const double origin_x = sizes_[row].centroid.x, origin_y = sizes_[row].centroid.y;
    svg_.rect(x, y, cell, cell, "fill=\"none\" stroke=\"#999\"");
    svg_.path("M" + svg_number(x) + " " + svg_number(cy) + "h" + svg_number(cell) + "M" + svg_number(cx) + " " +
                  svg_number(y) + "v" + svg_number(cell),
              "stroke=\"#e4e4e4\"");
    const std::size_t first = column == 0 ? 0 : column - 1, last = column == 0 ? wavelengths_ : column;
    for (std::size_t w = first; w < last; ++w) {
      const Spot& hits = of(row)[w];
      std::string d;
      for (std::size_t i = 0; i < std::min(drawn_rays, hits.x.size()); ++i) {
        d += ray_marker(looks_[w].marker, cx + (hits.x[i] - origin_x) * scale, cy - (hits.y[i] - origin_y) * scale);
      }
      if (!d.empty()) svg_.path(d, stroke(w));
    }
    const double circle = airy(column == 0 ? lens_.primary_wavelength() : first) * scale;
    if (circle < cell / 2) {
      svg_.circle(cx, cy, circle, "fill=\"none\" stroke=\"#000\" stroke-width=\"1\" stroke-dasharray=\"3 2\"");
    }
    const bool empty = std::all_of(of(row).begin() + static_cast<std::ptrdiff_t>(first),
                                   of(row).begin() + static_cast<std::ptrdiff_t>(last),
                                   [](const Spot& spot) { return spot.x.empty(); });
    const SpotSize& size = column == 0 ? sizes_[row] : of(row)[first].size;
    svg_.text(cx, y + cell + 15,
              empty ? "no rays"
                    : "RMS " + figure_detail::length_text(size.rms_radius) + ",  max " +
                          figure_detail::length_text(size.max_radius),
              small_centred);
  }

  void footer() {
    const double y = cell_y(rows_) + 11;
    figure_detail::draw_scale_bar(svg_, left, y, cell / 2 / limit_, cell / 2, ",  the same in all cells");
    svg_.text(
        gap, y + 24,
        "Origin: centroid of all rays of the field. RMS and max: radii about the centroid of the rays in the cell.",
        small_text);
    svg_.text(gap, y + 40,
              std::to_string(spots_.values.front().sent) + " rays sent per spot, at most " +
                  std::to_string(drawn_rays) + " drawn. Wavelengths have " + figure_detail::weights_text(weights_) +
                  ".",
              small_text);
    // A closed stop has no Airy circle.
    if (!std::isfinite(f_number_)) return;
    svg_.text(gap, y + 56,
              "Chief ray: through the centre of the stop. Dashed: Airy circle, 1.22 wavelength N / n, N = " +
                  to_text(f_number_, 3) + " on the film side; " +
                  figure_detail::length_text(airy(lens_.primary_wavelength())) + " at " +
                  to_text(lens_.wavelengths_nm()[lens_.primary_wavelength()], 6) + " nm.",
              small_text);
  }

  const Lens& lens_;
  const Grid<Spot>& spots_;
  std::vector<double> weights_;
  std::size_t wavelengths_, rows_, columns_;
  std::vector<figure_detail::Look> looks_;
  double f_number_;
  Svg svg_;
  std::vector<SpotSize> sizes_;  // one per row
  double limit_ = 0;             // half the side of a cell, mm
};

}  // namespace

std::string spot_figure(const Lens& lens, const Grid<Spot>& spots, std::span<const double> wavelength_weights) {
  const std::size_t wavelengths = lens.wavelengths_nm().size();
  if (spots.values.empty() || spots.columns != wavelengths) {
    throw Error("spot_figure: spots = " + std::to_string(spots.values.size()) + "; must be fields by " +
                std::to_string(wavelengths) + " wavelengths");
  }
  return SpotFigure(lens, spots, figure_detail::checked_weights("spot_figure", lens, wavelength_weights)).draw();
}

}  // namespace petzval
