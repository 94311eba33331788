// SPDX-License-Identifier: Apache-2.0
#include "petzval/figure/figures.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "figure_elements.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "scene_panel.hpp"

namespace petzval {
namespace {

using figure_detail::axis_style;
using figure_detail::film_style;
using figure_detail::focus_style;
using figure_detail::SceneFrame;
using figure_detail::ScenePanel;
using figure_detail::SectionBox;
using figure_detail::SectionLine;
using figure_detail::SectionPoint;
using figure_detail::SectionTrace;
using figure_detail::Svg;
using figure_detail::svg_number;

constexpr std::string_view film_plane = "fill=\"none\" stroke=\"#111\" stroke-width=\"0.8\"";
constexpr std::string_view film_before = "fill=\"none\" stroke=\"#111\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\"";
constexpr std::string_view focus_before =
    "fill=\"none\" stroke=\"#1a8f3c\" stroke-width=\"1.2\" stroke-dasharray=\"5 3\"";
constexpr std::string_view principal_plane = "fill=\"none\" stroke=\"#1f5fc4\" stroke-width=\"1\"";
constexpr std::string_view focal_plane = "fill=\"none\" stroke=\"#b97a00\" stroke-width=\"1\" stroke-dasharray=\"2 3\"";
constexpr std::string_view chief_style = "fill=\"none\" stroke=\"#d0331f\" stroke-width=\"0.6\"";
constexpr std::string_view meeting_style = "fill=\"none\" stroke=\"#7b3fb5\" stroke-width=\"1.4\"";
constexpr std::string_view wedge_style = "fill=\"#dff2e3\"";

void check(const TiltView& view) {
  for (const Film* film : {&view.before, &view.after}) {
    if (!(film->width_mm > 0 && film->height_mm > 0)) {
      throw Error("tilt_figure: film size = " + to_text(film->width_mm) + " x " + to_text(film->height_mm) +
                  " mm; must be positive");
    }
    if (std::isfinite(film->z() + film->tilt_rad + film->swing_rad)) continue;
    throw Error("tilt_figure: film z = " + to_text(film->z()) + " mm, tilt = " + to_text(film->tilt_rad) +
                ", swing = " + to_text(film->swing_rad) + "; must be finite");
  }
  if (!(view.blur_mm > 0)) throw Error("tilt_figure: blur = " + to_text(view.blur_mm) + " mm; must be positive");
}

/// An angle as text, rounded to 1e-5 degrees because the error of fits is smaller; never "-0".
std::string degrees_text(double angle_rad) {
  return to_text(std::round(1e5 * degrees(angle_rad)) / 1e5 + 0.0, 4) + "\u00b0";
}

class TiltFigure {
 public:
  explicit TiltFigure(const TiltView& view) : view_(view), film_(view.after), ideal_(view.after) {
    if (view.focus) {
      if (const auto image = view.lens.image_of(view.focus->plane)) ideal_ = film_in(*image, view.after);
    }
    focus_ = view.focus ? view.focus : focus_plane(view.lens, film_);
    focus_before_ = focus_plane(view.lens, {.z_mm = view.before.z() + ideal_.z() - film_.z()});
    const Vec3<double> n = ideal_.normal();
    if (const double lean = std::hypot(n.x, n.y); lean > 1e-12) {
      up_ = {n.x / lean, n.y / lean, 0};
      if (std::abs(up_.y) >= std::abs(up_.x) ? up_.y < 0 : up_.x < 0) up_ = -up_;
    }
    for (const FocusTarget& p : view.points) images_.push_back(view.lens.image(p.point));
    // Half the rectangle's extent along the section.
    film_half_ = (std::abs(up_.x) * view.after.width_mm + std::abs(up_.y) * view.after.height_mm) / 2;
    lens_half_ = std::isfinite(view.lens.pupils.entrance.diameter) ? view.lens.pupils.entrance.diameter / 2 : 0;
    if (view.glass) cut_glass(*view.glass);
    if (!(lens_half_ > 0)) lens_half_ = film_half_;
  }

  std::string draw() {
    const SceneFrame scene(scene_box(), 240, 440), close(close_box(), 240, 420);
    constexpr double top = 96, gap = 74;
    const double second = top + scene.height + gap, foot = second + close.height + 58;
    Svg svg(960, foot + 92);
    svg.text(figure_detail::sheet_margin, 26, view_.title, "font-size=\"17\" font-weight=\"bold\"");
    svg.text(figure_detail::sheet_margin, 46, std::string("Side view.  ") + std::string(view_.remark));
    svg.text(figure_detail::sheet_margin, 64, film_in_words());
    svg.text(SceneFrame::left, top - 8,
             film_.tilted() ? "The scene, and the planes that meet in one line" : "The scene",
             figure_detail::small_text);
    svg.text(SceneFrame::left, second - 8, "The lens and its film; small dots: images of the points",
             figure_detail::small_text);
    draw_scene(svg, top, scene);
    draw_close(svg, second, close);
    draw_legend(svg, foot);
    return std::move(svg).finish();
  }

 private:
  SectionPoint section(const Vec3<double>& p) const { return {p.z, glm::dot(p, up_)}; }
  SectionTrace trace(const Plane& plane) const { return {plane.normal.z, glm::dot(plane.normal, up_), plane.offset}; }
  static SectionTrace across_axis(double z) { return {1, 0, z}; }

  /// Name of the vertical axis: "y", "x" or, for example, "y turned by 30 degrees towards +x".
  std::string across_name() const {
    const double turn = std::atan2(up_.x, up_.y);
    constexpr double angle_tolerance = 0.01;
    if (std::abs(turn) < angle_tolerance) return "y";
    if (std::abs(turn - radians(90)) < angle_tolerance) return "x";
    return "y turned by " + to_text(degrees(turn), 3) + "\u00b0 towards +x";
  }

  std::string film_in_words() const {
    const Film& film = view_.after;
    std::string words = "Film at z = " + to_text(film.z(), 7) + " mm (before: " + to_text(view_.before.z(), 7) + " mm)";
    if (!film.tilted()) return words + ", upright.";
    return words + ", tilted by " + degrees_text(film.angle()) + " (tilt " + degrees_text(film.tilt_rad) + ", swing " +
           degrees_text(film.swing_rad) + ").";
  }

  void cut_glass(const Lens& lens) {
    const std::vector<double> needed(lens.surface_count(), lens_half_);
    const Meridian meridian = std::abs(up_.y) >= std::abs(up_.x) ? Meridian::y : Meridian::x;
    const std::size_t wavelength = lens.primary_wavelength();
    const figure_detail::LensSection cut(lens, meridian, needed, wavelength);
    bodies_ = cut.bodies();
    mirrors_ = cut.mirrors();
    for (const auto& body : bodies_) {
      for (const auto& outline : body.outlines) {
        for (const SectionPoint& p : outline) lens_half_ = std::max(lens_half_, std::abs(p.height));
      }
    }
  }

  bool thin() const {
    const IdealLens& l = view_.lens;
    return std::abs(l.front_principal_z() - l.rear_principal_z()) <= 1e-9 * std::abs(l.front_focal_length);
  }

  /// The ends of the exposed part of a film in the section.
  std::pair<SectionPoint, SectionPoint> film_ends(const Film& film) const {
    const Vec3<double> n = film.normal();
    Vec3<double> along = up_ - glm::dot(up_, n) * n;
    along /= std::sqrt(glm::dot(along, along));
    const Vec3<double> middle = film.position({film.shift_x_mm, film.shift_y_mm});
    return {section(middle - film_half_ * along), section(middle + film_half_ * along)};
  }

  /// Intersection of the film with the rear principal plane. For an ideal lens it has the same height as the
  /// intersection of the plane of focus with the front principal plane.
  std::optional<SectionPoint> rear_meeting() const {
    const SectionTrace film = trace(film_.plane());
    const double z = view_.lens.rear_principal_z(), height = (film.offset - film.along * z) / film.across;
    if (!std::isfinite(height)) return {};
    return SectionPoint{z, height};
  }

  SectionBox scene_box() const {
    const IdealLens& lens = view_.lens;
    SectionBox box({film_.z(), 0});
    box.take({lens.front_focal_z, 0});
    for (const FocusTarget& p : view_.points) {
      if (p.weight > 0 && !p.point.at_infinity) box.take(section(p.point.position));
    }
    const double reach = std::max(box.length(), 5 * std::abs(lens.front_focal_length));
    if (focus_) {
      const SectionTrace plane = trace(focus_->plane);
      const double crossing = plane.offset / plane.along;
      if (crossing < lens.front_focal_z && lens.front_focal_z - crossing < 1.3 * reach) box.take({crossing, 0});
      for (const auto& line : {focus_->hinge, focus_->scheimpflug}) {
        if (line && std::abs(section(line->point).height) < 0.6 * reach) box.take(section(line->point));
      }
    }
    // Unused points are included only if they are near.
    for (const FocusTarget& p : view_.points) {
      if (p.weight > 0 || p.point.at_infinity) continue;
      const SectionPoint at = section(p.point.position);
      if (std::abs(at.z - lens.front_focal_z) < 1.5 * reach && std::abs(at.height) < reach) box.take(at);
    }
    if (box.length() < reach) box.take({box.z_max - reach, 0});
    for (const double side : {-0.1, 0.1}) box.take({lens.front_focal_z, side * reach});
    return box;
  }

  SectionBox close_box() const {
    const IdealLens& lens = view_.lens;
    SectionBox box({lens.rear_z, 0});
    for (const double z : {lens.front_z, lens.front_principal_z(), lens.rear_principal_z()}) {
      if (std::abs(z - lens.rear_z) < 3 * std::abs(lens.rear_focal_length)) box.take({z, 0});
    }
    for (const auto& body : bodies_) {
      for (const auto& outline : body.outlines) {
        for (const SectionPoint& p : outline) box.take(p);
      }
    }
    for (const double side : {-1.0, 1.0}) box.take({lens.rear_z, side * lens_half_});
    for (const auto& [low, high] : {film_ends(view_.before), film_ends(film_)}) {
      box.take(low), box.take(high);
    }
    return box;
  }

  /// A limit of the sharp region: the plane of focus of a film parallel to the actual film, for which a sharp point has
  /// a disc of diameter `blur` on the actual film. It contains the hinge line.
  ///
  /// The chief ray runs from the centre E of the exit pupil to the image I. On a film through F with the normal n, the
  /// disc has the diameter D n.(F - I) / n.(I - E). All images I with equal discs therefore lie in a plane with the
  /// normal n.
  std::optional<FocusPlane> limit(double blur) const {
    const Pupil& exit = view_.lens.pupils.exit;
    Film film = ideal_;
    if (std::isfinite(exit.z)) {
      const double film_distance = film.z() - exit.z;
      film.z_mm = exit.z + film_distance / (1 + std::copysign(1.0, film_distance) * blur / exit.diameter);
    } else {
      const auto axial = view_.lens.image({{0, 0, -1}, true});
      if (axial) film.z_mm = film.z() - blur / axial->diameter_per_mm;
    }
    return focus_plane(view_.lens, film);
  }

  SectionLine wedge(const SectionBox& b) const {
    const Pupil& exit = view_.lens.pupils.exit;
    if (!focus_ || !(view_.blur_mm < 0.5 * exit.diameter)) return {};
    SectionLine region{{b.z_min, b.low}, {b.z_max, b.low}, {b.z_max, b.high}, {b.z_min, b.high}};
    region = cut_off(region, {-1, 0, -view_.lens.front_focal_z});
    // A point of the plane of focus in front of the front focal plane defines the side of the limits on which points
    // are sharp.
    const SectionTrace plane = trace(focus_->plane);
    const double squared = plane.along * plane.along + plane.across * plane.across;
    SectionPoint inside{plane.offset * plane.along / squared, plane.offset * plane.across / squared};
    const double far = 10 * std::abs(view_.lens.front_focal_length) + std::abs(inside.z);
    if (plane.across != 0) inside = {inside.z - far, inside.height + far * plane.along / plane.across};
    for (const double blur : {-view_.blur_mm, view_.blur_mm}) {
      const auto limiting = limit(blur);
      if (!limiting) continue;
      SectionTrace line = trace(limiting->plane);
      if (line.side(inside) < 0) line = {-line.along, -line.across, -line.offset};
      region = cut_off(region, line);
    }
    return region;
  }

  void draw_lens(Svg& svg, ScenePanel& panel, double least_half) const {
    if (bodies_.empty() && mirrors_.empty()) {
      const double z = view_.lens.rear_principal_z(), half = std::max(lens_half_, least_half);
      const double x = panel.x({z, 0}), high = panel.y({z, half}), low = panel.y({z, -half});
      const bool gathers = view_.lens.rear_focal_length > 0;
      const std::string tip = gathers ? "l-5 8m5 -8l5 8" : "l-5 -8m5 8l5 -8",
                        end = gathers ? "l-5 -8m5 8l5 -8" : "l-5 8m5 -8l5 8";
      svg.path("M" + svg_number(x) + " " + svg_number(low) + "V" + svg_number(high) + tip + "M" + svg_number(x) + " " +
                   svg_number(low) + end,
               "fill=\"none\" stroke=\"#1f5fc4\" stroke-width=\"2\"");
      return;
    }
    for (const auto& body : bodies_) {
      for (const auto& outline : body.outlines) {
        panel.fill(outline,
                   "fill=\"" + figure_detail::glass_colour(body.index) + "\" stroke=\"#3d5a73\" stroke-width=\"0.8\"");
      }
    }
    for (const auto& mirror : mirrors_) {
      for (std::size_t i = 0; i + 1 < mirror.size(); ++i) {
        panel.stroke(mirror[i], mirror[i + 1], "fill=\"none\" stroke=\"#333\" stroke-width=\"2.5\"");
      }
    }
  }

  void draw_principal_planes(ScenePanel& panel) const {
    panel.line(across_axis(view_.lens.front_principal_z()), principal_plane);
    if (!thin()) panel.line(across_axis(view_.lens.rear_principal_z()), principal_plane);
  }

  void draw_scene(Svg& svg, double y, const SceneFrame& frame) const {
    ScenePanel panel(svg, y, frame, across_name());
    const SectionBox& box = frame.box;
    panel.fill(wedge(box), wedge_style);
    panel.stroke({box.z_min, 0}, {box.z_max, 0}, axis_style);
    panel.line(across_axis(view_.lens.front_focal_z), focal_plane);
    draw_principal_planes(panel);
    panel.line(trace(film_.plane()), film_plane);
    if (focus_before_) panel.line(trace(focus_before_->plane), focus_before);
    if (focus_) panel.line(trace(focus_->plane), focus_style);
    draw_lens(svg, panel, 12 / frame.px_per_mm);
    const auto [low, high] = film_ends(film_);
    panel.stroke(low, high, film_style);
    for (std::size_t i = 0; i < view_.points.size(); ++i) {
      const FocusTarget& p = view_.points[i];
      if (!p.point.at_infinity)
        panel.mark(section(p.point.position), i + 1, p.weight > 0, 4);
      else
        draw_direction(panel, box, i);
    }
    if (!focus_ || !focus_->hinge || !focus_->scheimpflug) return;
    panel.dot(section(focus_->hinge->point), "hinge line", -8);
    const SectionPoint meeting = section(focus_->scheimpflug->point);
    if (const auto rear = rear_meeting(); rear && !thin()) {
      panel.stroke(*rear, meeting, meeting_style);
      panel.dot(*rear, "", 0);
    }
    panel.dot(meeting, "Scheimpflug line", 16);
  }

  /// Draws a point at infinity as a stroke at the frame, in the direction of the point.
  void draw_direction(ScenePanel& panel, const SectionBox& box, std::size_t i) const {
    const SectionPoint d = section(view_.points[i].point.position);
    if (!(d.z < 0)) return;
    const double film_distance = box.z_min - view_.lens.front_principal_z();
    const SectionPoint end{box.z_min, film_distance * d.height / d.z}, start{0.94 * end.z, 0.94 * end.height};
    panel.stroke(start, end, chief_style);
    panel.mark(start, i + 1, view_.points[i].weight > 0, 4);
  }

  void draw_close(Svg& svg, double y, const SceneFrame& frame) const {
    ScenePanel panel(svg, y, frame, across_name());
    const IdealLens& lens = view_.lens;
    const SectionBox& box = frame.box;
    panel.stroke({box.z_min, 0}, {box.z_max, 0}, axis_style);
    draw_lens(svg, panel, 0);
    draw_principal_planes(panel);
    if (!thin()) {
      panel.words({lens.front_principal_z(), box.high}, "H", 14);
      panel.words({lens.rear_principal_z(), box.high}, "H'", 14);
    }
    panel.line(across_axis(lens.front_focal_z), focal_plane);
    panel.line(across_axis(lens.rear_focal_z), focal_plane);
    for (std::size_t i = 0; i < images_.size(); ++i) {
      if (!images_[i]) continue;
      const ImagePoint& image = *images_[i];
      const double back = image.position.z - lens.rear_z;
      const Vec3<double> start = image.position - back * Vec3<double>(image.slope_x, image.slope_y, 1);
      panel.stroke(section(start), section(image.position), chief_style);
    }
    const auto [before_low, before_high] = film_ends(view_.before);
    panel.stroke(before_low, before_high, film_before);
    panel.line(trace(film_.plane()), film_plane);
    const auto [low, high] = film_ends(film_);
    panel.stroke(low, high, film_style);
    for (std::size_t i = 0; i < images_.size(); ++i) {
      if (images_[i]) panel.mark(section(images_[i]->position), i + 1, view_.points[i].weight > 0, 2.5);
    }
    svg.text(panel.x(low) - 6, panel.y(low) + 14, "film, " + degrees_text(view_.after.angle()),
             "font-size=\"11\" fill=\"#333\" text-anchor=\"end\"");
  }

  void draw_legend(Svg& svg, double y) const {
    const auto key = [&](double x, std::string_view style, std::string_view words) {
      svg.path("M" + svg_number(x) + " " + svg_number(y) + "h24", style);
      svg.text(x + 29, y + 4, words);
      return x + 29 + 6.4 * static_cast<double>(words.size()) + 16;
    };
    double x = key(figure_detail::sheet_margin, film_style, "film");
    x = key(x, film_before, "before, upright");
    x = key(x, focus_style, "plane of focus");
    x = key(x, focus_before, "before");
    x = key(x, principal_plane, thin() ? "plane of the lens" : "principal planes");
    key(x, focal_plane, "focal planes");
    std::string wedge = "Pale green: blurred by at most " + figure_detail::length_text(view_.blur_mm) + ".";
    svg.text(figure_detail::sheet_margin, y + 26, wedge + " " + lines_in_words(), figure_detail::small_text);
    svg.text(figure_detail::sheet_margin, y + 42,
             "The section contains the axis and the normal of the plane of focus; points are projected into the "
             "section. Hollow: unused." +
                 std::string(view_.focus ? " Based on cardinal points, except for the film." : ""),
             figure_detail::small_text);
    if (!thin() && film_.tilted()) {
      svg.text(figure_detail::sheet_margin, y + 58,
               "The film plane meets the rear principal plane (H') at the same height as the plane of focus meets the "
               "front one (H)" +
                   std::string(view_.focus ? ", except for aberrations" : "") + ": the violet line joins the two.",
               figure_detail::small_text);
    }
  }

  std::string lines_in_words() const {
    if (!focus_) return "The plane of focus is at infinity.";
    if (!focus_->hinge || !focus_->scheimpflug) return "An upright film: no hinge line.";
    const auto height = [&](const Line3& line) { return figure_detail::length_text(section(line.point).height); };
    return "Hinge line (in the front focal plane) at " + height(*focus_->hinge) + ", Scheimpflug line at " +
           height(*focus_->scheimpflug) + " from the axis.";
  }

  const TiltView& view_;
  Film film_;   ///< the actual film
  Film ideal_;  ///< the film of the ideal lens for the plane of focus
  std::optional<FocusPlane> focus_, focus_before_;
  Vec3<double> up_{0, 1, 0};  ///< the vertical direction of the section, perpendicular to the axis
  std::vector<std::optional<ImagePoint>> images_;
  double film_half_ = 0, lens_half_ = 0;
  std::vector<figure_detail::GlassBody> bodies_;
  std::vector<SectionLine> mirrors_;
};

}  // namespace

std::string tilt_figure(const TiltView& view) {
  check(view);
  return TiltFigure(view).draw();
}

}  // namespace petzval
