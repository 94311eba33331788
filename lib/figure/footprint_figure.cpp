// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/illumination.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval {
namespace {

using figure_detail::Svg;
using figure_detail::svg_number;

constexpr double cell = 220, gap = 14, top = 70, caption_height = 68;
constexpr std::size_t most_columns = 4;

/// The surface and fate of rays just outside the boundary.
struct Limit {
  int surface = -1;
  RayFate fate = RayFate::vignetted;
  bool operator==(const Limit&) const = default;
};

Limit limit_of(const RimPoint& edge) { return {edge.surface, edge.next_fate}; }

std::string_view colour_of(std::size_t limit) {
  constexpr std::array<std::string_view, 8> palette{"#111111", "#d0331f", "#1f5fc4", "#1a8f3c",
                                                    "#b97a00", "#7b3fb5", "#00858f", "#8a4b2a"};
  return palette[limit % palette.size()];
}

/// A rectangle of the pupil plane.
struct Box {
  double x_min = 0, x_max = 0, y_min = 0, y_max = 0;

  double half() const { return std::max(x_max - x_min, y_max - y_min) / 2; }
  double x() const { return (x_min + x_max) / 2; }
  double y() const { return (y_min + y_max) / 2; }
  void take(double px, double py) {
    x_min = std::min(x_min, px), x_max = std::max(x_max, px);
    y_min = std::min(y_min, py), y_max = std::max(y_max, py);
  }
};

struct Cell {
  PupilBoundary outline;
  std::optional<double> illumination;
  Box shown;
  bool away = false;  ///< true: too far from the paraxial pupil to show both
};

class FootprintFigure {
 public:
  FootprintFigure(const Lens& lens, double subject_z, std::span<const double> fields_rad, int first_surface_number)
      : lens_(lens),
        subject_z_(subject_z),
        fields_(fields_rad),
        first_surface_number_(first_surface_number),
        wavelength_(lens.primary_wavelength()) {
    half_x_ = pupils(lens, wavelength_, Meridian::x).entrance.diameter / 2;
    half_y_ = pupils(lens, wavelength_, Meridian::y).entrance.diameter / 2;
    axial_area_ = pupil_boundary(lens, {0, subject_z}, wavelength_).area();
    for (const double field : fields_rad) {
      const PupilBoundary outline = pupil_boundary(lens, {field, subject_z}, wavelength_);
      cells_.push_back(framed({outline, relative_illumination(lens, {field, subject_z}, wavelength_), {}, false}));
      half_ = std::max(half_, cells_.back().shown.half());
      for (const PupilSpan& span : outline.spans) {
        for (const RimPoint& edge : {span.from, span.to}) {
          if (edge.surface >= 0 && std::ranges::find(limits_, limit_of(edge)) == limits_.end()) {
            limits_.push_back(limit_of(edge));
          }
        }
      }
    }
    // The stop is the first entry, so that it is black for every lens.
    const int stop = static_cast<int>(pupils(lens, wavelength_).stop);
    std::ranges::sort(limits_, {}, [&](const Limit& a) { return std::tuple(a.surface != stop, a.surface, a.fate); });
    half_ = half_ > 0 ? 1.1 * half_ : 1;  // 1 if the stop is closed
  }

  std::string draw() const {
    const std::size_t columns = std::min(most_columns, cells_.size());
    const std::size_t rows = (cells_.size() + columns - 1) / columns;
    const double width = std::max(960.0, gap + static_cast<double>(columns) * (cell + gap));
    const double keys = top + static_cast<double>(rows) * (cell + caption_height + gap) + 8;
    const std::vector<std::string> names = limit_names();
    const std::size_t key_rows = (names.size() + 3) / 4;
    Svg svg(width, keys + 20 * static_cast<double>(key_rows + 1) + 40);
    figure_detail::draw_head(svg, lens_, "Pupil footprints", subject_z_, wavelength_);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      draw_cell(svg, cells_[i], fields_[i], gap + static_cast<double>(i % columns) * (cell + gap),
                top + static_cast<double>(i / columns) * (cell + caption_height + gap));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      figure_detail::draw_key(svg, gap + 235 * static_cast<double>(i % 4), keys + 20 * static_cast<double>(i / 4),
                              colour_of(i), names[i]);
    }
    const double y = keys + 20 * static_cast<double>(key_rows) + 2;
    figure_detail::draw_scale_bar(svg, gap, y, cell / 2 / half_, cell, ",  the same in all cells");
    svg.text(figure_detail::sheet_margin, y + 24,
             "Rays of a point that pass the lens, in the plane of the entrance pupil, seen from the film side; +y up. "
             "The colour of an edge names the limiting surface.",
             figure_detail::small_text);
    svg.text(figure_detail::sheet_margin, y + 40,
             "Dashed: paraxial entrance pupil. Fields of 89\u00b0 and more: in the plane perpendicular to the field.",
             figure_detail::small_text);
    return std::move(svg).finish();
  }

 private:
  /// Sets the shown area: both pupils, or only the real pupil if it would be too small together with the paraxial
  /// pupil.
  Cell framed(Cell c) const {
    Box paraxial{-half_x_, half_x_, -half_y_, half_y_};
    c.shown = paraxial;
    if (c.outline.empty()) return c;
    const RimPoint& any = c.outline.spans.front().to;
    Box real{any.x, any.x, any.y, any.y};
    for (const PupilSpan& span : c.outline.spans) {
      for (const RimPoint& edge : {span.from, span.to}) {
        real.take(edge.x, edge.y);
        c.shown.take(edge.x, edge.y);
      }
    }
    c.away = c.shown.half() > 2.2 * std::max(real.half(), paraxial.half());
    if (c.away) c.shown = real;
    return c;
  }

  std::vector<std::string> limit_names() const {
    std::vector<std::string> result;
    for (const Limit& limit : limits_) {
      std::string words = "surface " + std::to_string(limit.surface + first_surface_number_);
      if (lens_.stop() && static_cast<int>(*lens_.stop()) == limit.surface) words += ", the stop";
      if (limit.fate == RayFate::totally_reflected) words += ", total reflection";
      if (limit.fate == RayFate::missed_surface || limit.fate == RayFate::no_convergence) words += ", missed";
      result.push_back(words);
    }
    return result;
  }

  void draw_cell(Svg& svg, const Cell& c, double field, double left, double upper) const {
    const double cx = left + cell / 2, cy = upper + cell / 2, scale = cell / 2 / half_;
    const auto x = [&](double px) { return cx + (px - c.shown.x()) * scale; };
    const auto y = [&](double py) { return cy - (py - c.shown.y()) * scale; };
    const auto at = [&](const RimPoint& e) { return svg_number(x(e.x)) + " " + svg_number(y(e.y)); };
    svg.rect(left, upper, cell, cell, "fill=\"none\" stroke=\"#bbb\"");

    // A span is joined to the span of the same rank in the next direction if both directions have equally many spans.
    const auto& spans = c.outline.spans;
    std::vector<std::pair<std::size_t, std::size_t>> of(c.outline.directions, {0, 0});  // first span, number of spans
    for (std::size_t i = 0; i < spans.size(); ++i) {
      auto& [first, number] = of[spans[i].direction];
      if (number++ == 0) first = i;
    }
    std::string area;
    std::vector<std::string> edges(limits_.size());
    for (std::size_t k = 0; k < of.size(); ++k) {
      const auto [first, number] = of[k];
      const auto [next, next_number] = of[(k + 1) % of.size()];
      if (number != next_number) continue;
      for (std::size_t i = 0; i < number; ++i) {
        const PupilSpan &a = spans[first + i], &b = spans[next + i];
        area += "M" + at(a.from) + "L" + at(a.to) + "L" + at(b.to) + "L" + at(b.from) + "z";
        for (const auto& [from, to] : {std::pair(a.from, b.from), std::pair(a.to, b.to)}) {
          if (from.surface < 0 || to.surface < 0) continue;
          const auto rank = static_cast<std::size_t>(std::ranges::find(limits_, limit_of(from)) - limits_.begin());
          edges[rank] += "M" + at(from) + "L" + at(to);
        }
      }
    }
    if (!area.empty()) svg.path(area, "fill=\"#dfe9f3\"");
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (edges[i].empty()) continue;
      svg.path(edges[i], "fill=\"none\" stroke-width=\"2\" stroke-linecap=\"round\" stroke=\"" +
                             std::string(colour_of(i)) + "\"");
    }
    if (!c.away) {
      svg.ellipse(x(0), y(0), half_x_ * scale, half_y_ * scale,
                  "fill=\"none\" stroke=\"#555\" stroke-width=\"1\" stroke-dasharray=\"4 3\"");
    }

    svg.text(left, upper + cell + 17, "field " + figure_detail::field_text(field), "font-weight=\"bold\"");
    if (c.outline.empty()) {
      svg.text(left, upper + cell + 33, "no ray passes", figure_detail::small_text);
      return;
    }
    if (axial_area_ > 0) {
      svg.text(left, upper + cell + 33, "area " + to_text(c.outline.area() / axial_area_, 3) + " of that on the axis",
               figure_detail::small_text);
    }
    if (c.illumination) {
      svg.text(left, upper + cell + 48, "relative illumination " + to_text(*c.illumination, 3),
               figure_detail::small_text);
    }
    if (c.away) {
      svg.text(left, upper + cell + 63,
               "paraxial pupil " + figure_detail::length_text(std::hypot(c.shown.x(), c.shown.y())) + " away",
               figure_detail::small_text);
    }
  }

  const Lens& lens_;
  double subject_z_;
  std::span<const double> fields_;
  int first_surface_number_;
  std::size_t wavelength_;
  double half_x_ = 0, half_y_ = 0;  // semi-axes of the paraxial entrance pupil
  double axial_area_ = 0;
  std::vector<Cell> cells_;
  std::vector<Limit> limits_;
  double half_ = 0;  // half the side of a cell, mm
};

}  // namespace

std::string footprint_figure(const Lens& lens, double subject_z, std::span<const double> fields_rad,
                             int first_surface_number) {
  if (fields_rad.empty()) throw Error("footprint_figure: fields = 0; must be at least 1");
  return FootprintFigure(lens, subject_z, fields_rad, first_surface_number).draw();
}

}  // namespace petzval
