// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/figure/figures.hpp"
#include "scene_panel.hpp"

namespace petzval {
namespace {

using figure_detail::axis_style;
using figure_detail::film_style;
using figure_detail::focus_style;
using figure_detail::SceneFrame;
using figure_detail::ScenePanel;
using figure_detail::SectionBox;
using figure_detail::SectionPoint;
using figure_detail::Svg;

constexpr std::string_view side_style = "fill=\"none\" stroke=\"#9bd3ab\" stroke-width=\"1\"";
constexpr std::string_view lens_style = "fill=\"none\" stroke=\"#1f5fc4\" stroke-width=\"2\"";
constexpr std::string_view cone_style = "fill=\"none\" stroke=\"#888\" stroke-width=\"0.8\"";

/// The parameters of focal_surface_figure().
struct View {
  std::string_view title, remark;
  const IdealLens& lens;
  const Film& film;
  const FocalSurface& surface;
  std::span<const FocalPoint> points;
};

class FocalSurfaceFigure {
 public:
  explicit FocalSurfaceFigure(const View& view) : view_(view) {
    double farthest = 0;
    for (const FocalPoint& point : view.points) {
      const bool sharp = point.inverse_distance.value_or(0) > 0 && point.blur_mm == 0;
      if (sharp) farthest = std::max(farthest, 1 / *point.inverse_distance);
    }
    constexpr double reach_factor = 1.25, focal_lengths = 40;
    reach_ = farthest > 0 ? reach_factor * farthest : focal_lengths * std::abs(view.lens.front_focal_length);
  }

  std::string draw() const {
    constexpr double top = 96, gap = 74;
    const SceneFrame side(box(false), 160, 360), above(box(true), 160, 360);
    const double second = top + side.height + gap, foot = second + above.height + 58;
    Svg svg(960, foot + 40);
    svg.text(figure_detail::sheet_margin, 26, view_.title, "font-size=\"17\" font-weight=\"bold\"");
    svg.text(figure_detail::sheet_margin, 46, std::string("Focal surface.  ") + std::string(view_.remark));
    svg.text(
        figure_detail::sheet_margin, 64,
        "Green: focal surface in the section through the film centre; pale: in parallel sections at 0.4 and 0.8 of "
        "the half size. Grey: chief rays of the film edges.");
    svg.text(SceneFrame::left, top - 8, "From the side", figure_detail::small_text);
    svg.text(SceneFrame::left, second - 8, "From above", figure_detail::small_text);
    draw_section(svg, top, side, false);
    draw_section(svg, second, above, true);
    svg.text(figure_detail::sheet_margin, foot,
             "Points of the image are projected into both sections at their true distances; the surface does not pass "
             "through points with a blur.",
             figure_detail::small_text);
    return std::move(svg).finish();
  }

 private:
  double entrance_z() const { return view_.lens.pupils.entrance.z; }
  double half(bool across_x) const { return (across_x ? view_.film.width_mm : view_.film.height_mm) / 2; }
  double middle(bool across_x) const { return across_x ? view_.film.shift_x_mm : view_.film.shift_y_mm; }

  /// Slope of the chief ray of a film point in the scene, away from the lens.
  double chief_slope(const FilmPoint& film_point, bool across_x) const {
    const ScenePoint seen = view_.lens.scene_of(view_.film.position(film_point));
    const double z = seen.at_infinity ? seen.position.z : seen.position.z - entrance_z();
    return -(across_x ? seen.position.x : seen.position.y) / z;
  }
  SectionPoint at(const FilmPoint& film_point, double distance, bool across_x) const {
    return {entrance_z() - distance, chief_slope(film_point, across_x) * distance};
  }
  /// A film point in a section, by its position along the section and the offset of the section from the film centre,
  /// both -1 to 1.
  FilmPoint film_point(double t, bool across_x, double lateral = 0) const {
    const double along = middle(across_x) + t * half(across_x), other = middle(!across_x) + lateral * half(!across_x);
    return across_x ? FilmPoint{along, other} : FilmPoint{other, along};
  }

  void draw_surface(ScenePanel& panel, bool across_x, double lateral, std::string_view style) const {
    std::optional<SectionPoint> before;
    constexpr int steps = 400;
    for (int i = 0; i <= steps; ++i) {
      const FilmPoint film = film_point(2.0 * i / steps - 1, across_x, lateral);
      const double inverse = view_.surface.at(film).inverse_distance;
      const bool shown = inverse * 4 * reach_ > 1;  // the panel ends at reach_
      const auto now = shown ? std::optional(at(film, 1 / inverse, across_x)) : std::nullopt;
      if (before && now) panel.stroke(*before, *now, style);
      before = now;
    }
  }

  SectionBox box(bool across_x) const {
    SectionBox result({view_.film.z(), 0});
    for (const double t : {-1.0, 1.0}) result.take(at(film_point(t, across_x), reach_, across_x));
    return result;
  }

  void draw_section(Svg& svg, double y, const SceneFrame& frame, bool across_x) const {
    ScenePanel panel(svg, y, frame, across_x ? "x" : "y");
    panel.stroke({frame.box.z_min, 0}, {frame.box.z_max, 0}, axis_style);
    for (const double t : {-1.0, 1.0}) {
      panel.stroke({entrance_z(), 0}, at(film_point(t, across_x), reach_, across_x), cone_style);
    }
    for (const double lateral : {-0.8, -0.4, 0.4, 0.8}) draw_surface(panel, across_x, lateral, side_style);
    draw_surface(panel, across_x, 0, focus_style);
    // At least 10 px: lens and film could be too small to see at the true scale.
    const double least = 10 / frame.px_per_mm;
    const double pupil = std::max(view_.lens.pupils.entrance.diameter / 2, least);
    panel.stroke({entrance_z(), -pupil}, {entrance_z(), pupil}, lens_style);
    const double film = std::max(half(across_x), least);
    panel.stroke({view_.film.z(), -film}, {view_.film.z(), film}, film_style);
    for (std::size_t i = 0; i < view_.points.size(); ++i) {
      const FocalPoint& point = view_.points[i];
      if (!(point.inverse_distance.value_or(0) > 0)) continue;
      panel.mark(at(point.film_point, 1 / *point.inverse_distance, across_x), i + 1, point.blur_mm == 0, 4);
    }
  }

  const View& view_;
  double reach_ = 0;
};

}  // namespace

std::string focal_surface_figure(std::string_view title, std::string_view remark, const IdealLens& lens,
                                 const Film& film, const FocalSurface& surface, std::span<const FocalPoint> points) {
  if (!(film.width_mm > 0 && film.height_mm > 0 && std::isfinite(film.z()))) {
    throw Error("focal_surface_figure: film size = " + to_text(film.width_mm) + " x " + to_text(film.height_mm) +
                " mm at a finite z; both sides must be positive");
  }
  return FocalSurfaceFigure({title, remark, lens, film, surface, points}).draw();
}

}  // namespace petzval
