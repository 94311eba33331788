// SPDX-License-Identifier: Apache-2.0
// Tilts the film so that the plane of focus passes through points of the scene, and shows the effect: film, planes and
// lines from the side, and the blur over the picture before and after.
//
//   petzval tilt data/lenses/double_gauss_100mm_f2_28deg.json --f-number 4 --points examples/scenes/table.json --out
//   out petzval tilt --thin-lens 50 --f-number 2 --points points.json --json --out out
#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/figure/figures.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/focus/autofocus.hpp"
#include "support/blur_map.hpp"
#include "support/bokeh.hpp"
#include "support/cli.hpp"
#include "support/files.hpp"
#include "support/focus_points.hpp"
#include "support/map_sheet.hpp"
#include "support/movement_setup.hpp"
#include "support/text.hpp"

namespace {

using examples::finite_or_null;
using examples::Json;
using examples::number;
using petzval::FocusStatus;
using petzval::TargetStatus;
using petzval::TiltFit;
using Vector = petzval::Vec3<double>;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t rays_to_fit = 1024, rays_to_check = 4096;

struct Options : examples::MovementOptions {
  std::string points_file, out_folder;
  double max_tilt_deg = 20;
  bool robust = false, json = false;
};

/// A point of the file and its results.
struct Point {
  petzval::FocusTarget target;
  bool in_picture = true;
  TargetStatus status = TargetStatus::used;
  double before_mm = none, predicted_mm = none, traced_mm = none;

  bool serves() const { return in_picture && status == TargetStatus::used; }
  /// True if the point is on the scene surface. Outliers are not used for the surface.
  bool shows() const { return in_picture && (status == TargetStatus::used || status == TargetStatus::no_weight); }
  std::string use_name() const { return in_picture ? std::string(petzval::name(status)) : "outside_picture"; }
  std::string use_in_words() const {
    if (!in_picture) return "left out: outside the picture";
    const bool extent_alone = status == TargetStatus::no_weight && !target.fixes_distance;
    return extent_alone ? "shown only: it fixes no distance" : examples::in_words(status);
  }
};

struct Result {
  examples::MovingLens lens;
  std::vector<Point> points = {};
  petzval::Autofocus before = {};
  TiltFit after = {};
};

std::vector<petzval::ScenePoint> scene_points(const std::vector<Point>& points,
                                              bool (Point::*which)() const = nullptr) {
  std::vector<petzval::ScenePoint> result;
  for (const Point& p : points) {
    if (!which || (p.*which)()) result.push_back(p.target.point);
  }
  return result;
}

std::vector<petzval::FocusTarget> targets(const std::vector<Point>& points) {
  std::vector<petzval::FocusTarget> result;
  for (const Point& p : points) {
    if (p.in_picture) result.push_back(p.target);
  }
  return result;
}

/// Keeps the blurs of targets().
void keep(const std::vector<petzval::TargetBlur>& blurs, Result& result, double Point::*blur_mm) {
  auto next = blurs.begin();
  for (Point& p : result.points) {
    if (p.in_picture) p.status = next->status, p.*blur_mm = next->blur_mm, ++next;
  }
}

/// Throws with the reason why the first unusable point cannot be used.
[[noreturn]] void give_up(const Options& options, const std::vector<Point>& points) {
  const auto first = std::ranges::find_if_not(points, &Point::serves);
  const auto which = std::to_string(first - points.begin() + 1);
  throw petzval::Error(options.points_file + ": no point to focus on (point " + which + " is " + first->use_in_words() +
                       "); at least one must be in front of the lens and have a weight");
}

/// The upright film for the points in the picture. Without points: the film of the lens, or the focus for infinity.
petzval::Autofocus focused(const Options& options, Result& result) {
  if (result.points.empty()) {
    petzval::Film film = result.lens.film;
    film.z_mm = result.lens.lens ? result.lens.lens->film_z() : result.lens.ideal.rear_focal_z;
    return {.film = film, .blurs = {}};
  }
  const auto served = targets(result.points);
  const petzval::Autofocus focus = result.lens.exact ? petzval::autofocus(*result.lens.lens, served, result.lens.film,
                                                                          petzval::FocusCriterion::min_rms, rays_to_fit)
                                                     : petzval::autofocus(result.lens.ideal, served, result.lens.film);
  keep(focus.blurs, result, &Point::before_mm);
  if (focus.status == petzval::FocusStatus::no_targets) give_up(options, result.points);
  if (!focus) throw petzval::Error(options.points_file + ": no film behind the lens can focus on these points");
  return focus;
}

/// Excludes points outside the picture, if the size of the film is given.
void leave_out_targets_off_film(const petzval::Film& film, Result& result) {
  for (Point& p : result.points) {
    if (p.status != TargetStatus::used && p.status != TargetStatus::no_weight) continue;
    petzval::FocusPoint point;
    point.keys.push_back({.anchor = p.target.point});
    p.in_picture = !petzval::focus_targets(result.lens.ideal, {&point, 1}, {.film = film}).empty();
  }
}

Result solve(const Options& options) {
  Result result{.lens = examples::moving_lens(options)};
  for (const auto& target : examples::read_targets(options.points_file)) result.points.push_back({target});

  result.before = focused(options, result);
  if (options.setup.film_given) {
    leave_out_targets_off_film(petzval::Film(result.before.film), result);
    result.before = focused(options, result);
  }
  petzval::TiltOptions tilt{.max_tilt_rad = petzval::radians(options.max_tilt_deg),
                            .robust = options.robust,
                            .film = result.before.film,
                            .rays = rays_to_fit};
  if (!options.setup.film_given)
    tilt.film.width_mm = tilt.film.height_mm = 0;  // only its centre must stay behind the lens
  const auto served = targets(result.points);
  result.after = result.lens.exact ? petzval::fit_tilt(*result.lens.lens, served, tilt)
                                   : petzval::fit_tilt(result.lens.ideal, served, tilt);
  result.after.film.width_mm = result.before.film.width_mm;
  result.after.film.height_mm = result.before.film.height_mm;
  keep(result.after.blurs, result, &Point::predicted_mm);
  switch (result.after.status) {
    case petzval::FocusStatus::no_targets:
      if (result.points.empty()) break;
      give_up(options, result.points);
    case petzval::FocusStatus::unreachable:
      throw petzval::Error(options.points_file + ": the film, " + number(result.lens.film.width_mm) + " x " +
                           number(result.lens.film.height_mm) +
                           " mm, would touch the lens; points must be farther away or the film smaller");
    case petzval::FocusStatus::not_converged:
      throw petzval::Error(options.points_file + ": the fit of the film to these points did not converge");
    default: break;
  }
  if (result.lens.lens) {
    const auto traced =
        petzval::exact_blurs(*result.lens.lens, result.after.film, scene_points(result.points), rays_to_check);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      Point& p = result.points[i];
      if (!std::isnan(p.predicted_mm) && traced[i]) p.traced_mm = traced[i]->signed_diameter;
    }
  }
  return result;
}

std::string status_in_words(const Result& result, const Options& options) {
  const std::string limit = number(options.max_tilt_deg) + " degrees";
  if (result.after.status == petzval::FocusStatus::limited) {
    return "limited: the tilt is limited to " + limit +
           ", or less across points that are nearly on a line; this is the best film within the limit";
  }
  if (result.after.status == petzval::FocusStatus::solved) return "solved: the points determine the plane of focus";
  if (result.after.status == petzval::FocusStatus::no_targets)
    return "no targets: without points the film stays upright";
  if (result.after.rank == petzval::PlaneRank::point) {
    return "least tilt: one point of the picture determines a distance but no slope, so the film stays upright";
  }
  return "least tilt: points on one line of the picture determine no slope across the line; this plane of focus tilts "
         "the film least";
}

/// Replaces rounding errors of 0 by 0.
double tidy(double value) { return std::abs(value) < 1e-9 ? 0.0 : value; }

std::string film_in_words(const petzval::Film& film) {
  if (!film.tilted()) return "upright";
  const auto degrees = [](double rad) {
    return number(tidy(std::round(1e5 * petzval::degrees(rad)) / 1e5), 4) + "\u00b0";
  };
  return "tilted by " + degrees(film.tilt_rad) + ", swung by " + degrees(film.swing_rad);
}

Json vector(const Vector& v) { return {v.x, v.y, v.z}; }

Json line(const std::optional<petzval::FocusPlane>& focus, std::optional<petzval::Line3> petzval::FocusPlane::*which) {
  if (!focus || !((*focus).*which)) return nullptr;
  const petzval::Line3& l = *((*focus).*which);
  return {{"point_mm", vector(l.point)}, {"direction", vector(l.direction)}};
}

Json micrometres(double mm) { return finite_or_null(1e3 * mm); }

Json to_json(const Result& result, const Options& options, const std::vector<std::string>& files) {
  const TiltFit& fit = result.after;
  Json blurs = Json::array(), before = Json::array(), uses = Json::array();
  for (const Point& p : result.points) {
    blurs.push_back({{"predicted", micrometres(p.predicted_mm)}, {"traced", micrometres(p.traced_mm)}});
    before.push_back(micrometres(p.before_mm));
    uses.push_back(p.use_name());
  }
  return {
      {"lens", result.lens.title},
      {"model", options.model_name()},
      {"status", petzval::name(fit.status)},
      {"rank", petzval::name(fit.rank)},
      {"message", status_in_words(result, options)},
      {"plane_normal", result.after.focus ? vector(result.after.focus->plane.normal) : Json()},
      {"plane_offset_mm", result.after.focus ? Json(result.after.focus->plane.offset) : Json()},
      {"film_tilt_deg", petzval::degrees(fit.film.tilt_rad)},
      {"film_swing_deg", petzval::degrees(fit.film.swing_rad)},
      {"film_z_mm", fit.film.z()},
      {"film_centre_mm", {fit.film.shift_x_mm, fit.film.shift_y_mm}},
      {"rms_um", 1e3 * fit.rms_mm},
      {"blur_um", std::move(blurs)},
      {"use", std::move(uses)},
      {"hinge_line", line(result.after.focus, &petzval::FocusPlane::hinge)},
      {"scheimpflug_line", line(result.after.focus, &petzval::FocusPlane::scheimpflug)},
      {"before", {{"film_z_mm", result.before.film.z()}, {"rms_um", 1e3 * result.before.rms_mm}, {"blur_um", before}}},
      {"files", files}};
}

std::string padded(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string to_text(const Result& result, const Options& options) {
  const TiltFit& fit = result.after;
  const auto triple = [](const Vector& v) {
    return "(" + number(tidy(v.x), 6) + ", " + number(tidy(v.y), 6) + ", " + number(tidy(v.z), 6) + ")";
  };
  const auto cell = [](double mm) { return padded(std::isnan(mm) ? "-" : number(tidy(1e3 * mm), 4), 14); };
  std::string text = result.lens.title + ", " + result.lens.conditions + "\n" + status_in_words(result, options) +
                     "\n\nfilm at z = " + number(fit.film.z(), 9) + " mm, " + film_in_words(fit.film) +
                     " (upright before, at " + number(result.before.film.z(), 9) + " mm)\n";
  if (tidy(fit.film.shift_x_mm) != 0 || tidy(fit.film.shift_y_mm) != 0) {
    text += "centre of the picture on the film: " + number(tidy(fit.film.shift_x_mm), 6) + ", " +
            number(tidy(fit.film.shift_y_mm), 6) + " mm\n";
  }
  text += result.after.focus ? "plane of focus: normal " + triple(result.after.focus->plane.normal) + ", " +
                                   number(result.after.focus->plane.offset, 8) + " mm from the origin along it\n"
                             : "in focus: infinity\n";
  const auto add_line = [&](const char* name, const std::optional<petzval::Line3>& l) {
    if (l) text += std::string(name) + " through " + triple(l->point) + " mm along " + triple(l->direction) + "\n";
  };
  if (result.after.focus) {
    add_line("hinge line", result.after.focus->hinge);
    add_line("Scheimpflug line", result.after.focus->scheimpflug);
  }
  text += "RMS blur: " + number(tidy(1e3 * result.before.rms_mm), 4) + " um upright, " +
          number(tidy(1e3 * fit.rms_mm), 4) + " um tilted\n\npoint     before, um  predicted, um     traced, um\n";
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Point& p = result.points[i];
    const std::string words = p.use_in_words();
    text += padded(std::to_string(i + 1), 5) + cell(p.before_mm) + " " + cell(p.predicted_mm) + " " +
            cell(p.traced_mm) + (words.empty() ? "" : "  " + words) + "\n";
  }
  return text;
}

/// Limit of sharpness: the film's diagonal / 1442, which is 0.03 mm for 24 x 36 mm.
double sharp_mm(const petzval::Film& film) { return std::hypot(film.width_mm, film.height_mm) / 1442.2; }

std::string side_view(const Result& result) {
  std::vector<petzval::FocusTarget> points;
  for (const Point& p : result.points) points.push_back({.point = p.target.point, .weight = p.serves() ? 1.0 : 0.0});
  const std::string remark = result.lens.conditions + ", " + std::to_string(points.size()) +
                             (points.size() == 1 ? " focus point" : " focus points");
  return petzval::tilt_figure({.title = result.lens.title,
                               .remark = remark,
                               .lens = result.lens.ideal,
                               .glass = result.lens.lens ? &*result.lens.lens : nullptr,
                               .before = result.before.film,
                               .after = result.after.film,
                               .focus = result.lens.exact ? result.after.focus : std::nullopt,
                               .blur_mm = sharp_mm(result.lens.film),
                               .points = points});
}

/// A blur with its sign, for example "+12 µm".
std::string blur_in_words(double mm) {
  const double um = std::round(1e4 * mm) / 10 + 0.0;
  const double shown = std::abs(um) >= 10 ? std::round(um) : um;
  return (shown < 0 ? "\u2212" : shown > 0 ? "+" : "") + number(std::abs(shown)) + " \u00b5m";
}

/// The blur at each pixel of a film. Blue: nearer than the plane of focus; red: beyond it; white: sharp; grey: no
/// light.
examples::Map map_of(const examples::BlurMap& blurs, const petzval::Film& film, double scale_mm, const Result& result,
                     double Point::*blur) {
  examples::Map map{.values = blurs,
                    .low = -scale_mm,
                    .high = scale_mm,
                    .colours = {{8, 32, 84},
                                {17, 58, 127},
                                {26, 84, 170},
                                {102, 141, 198},
                                {179, 198, 227},
                                {255, 255, 255},
                                {233, 183, 181},
                                {212, 110, 107},
                                {190, 38, 32},
                                {141, 23, 26},
                                {92, 8, 20}},
                    .contours = {{sharp_mm(result.lens.film)}},
                    .scale_words = {"nearer than the plane of focus", "sharp", "beyond the plane of focus"},
                    .both_signs = true};
  for (int k = -2; k <= 2; ++k) map.ticks.push_back({scale_mm * k / 2, blur_in_words(scale_mm * k / 2)});
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Point& p = result.points[i];
    const auto where = examples::on_film(result.lens.ideal, film, p.target.point);
    if (!where) continue;
    const petzval::Vec2<double> at = film.raster(*where);
    map.points.push_back({at.x, at.y, i + 1, std::isnan(p.*blur) ? "" : blur_in_words(p.*blur), p.serves()});
  }
  return map;
}

/// The pictures before and after at one scale; empty if no point is on the scene surface.
std::vector<std::string> blur_pictures(const Result& result) {
  if (std::ranges::none_of(result.points, &Point::shows)) return {};
  const petzval::IdealLens& ideal = result.lens.ideal;
  const examples::PointScene scene(ideal, scene_points(result.points, &Point::shows));
  constexpr int map_pixels = 135;
  const petzval::Film films[]{examples::with_pixels(result.before.film, map_pixels),
                              examples::with_pixels(result.after.film, map_pixels)};
  const petzval::Lens* const exact = result.lens.exact ? &*result.lens.lens : nullptr;
  std::vector<examples::BlurMap> maps;
  for (const petzval::Film& film : films) {
    maps.push_back(examples::blur_map(film, scene, ideal, exact, examples::threads()));
  }

  const double scale_mm = examples::scale_of(maps);
  examples::MapSheet sheet{.scale = 8};
  sheet.subtitle = result.lens.title + ", " + result.lens.conditions + ", film " + number(result.lens.film.width_mm) +
                   " x " + number(result.lens.film.height_mm) + " mm; picture upright";
  sheet.notes = {"Signed diameter of the blur on the film" +
                     std::string(exact ? ": the uniform disc with the RMS radius of the traced rays." : ".") +
                     " Thin lines: " + number(1e3 * sharp_mm(result.lens.film), 3) +
                     " \u00b5m. Both pictures have the same scale.",
                 "Circles: the focus points and their blurs (grey: not used). Between them 1/distance is "
                 "interpolated."};
  const bool upright = !result.after.film.tilted();
  const std::string titles[]{"Before: upright film, focused on the points",
                             "After: film " + film_in_words(result.after.film)};
  std::vector<std::string> sheets;
  for (std::size_t k = 0; k < 2; ++k) {
    sheet.title = titles[k] + (k == 1 && upright ? ", as before" : "");
    sheet.width = films[k].columns, sheet.height = films[k].rows;
    sheet.maps = {map_of(maps[k], films[k], scale_mm, result, k == 0 ? &Point::before_mm : &Point::predicted_mm)};
    sheets.push_back(examples::draw_map_sheet(sheet));
  }
  return sheets;
}

}  // namespace

int commands::tilt(int argc, char** argv) {
  Options options;
  examples::App app(
      "Tilts and swings the film so that scene points are sharp or have a given blur, by least squares of their "
      "blurs.\n"
      "Points are in the lens frame, the scene at negative z; at infinity the position is a direction. Blurs are "
      "signed "
      "diameters on the film: negative nearer than the plane of focus, positive beyond it.\n"
      "predicted: by the fitted model; traced: by 4096 exact rays per point (fewer for more than 1024 points), for "
      "every model if LENS is given. Plane and lines of the real model follow from its cardinal points. If the points "
      "do not determine a plane, the result has the smallest tilt, and status is least_tilt.\n"
      "Writes NAME_side.svg, NAME_before.svg and NAME_after.svg into DIR.",
      "petzval tilt");
  examples::add_movement_options(app, options);
  app.add_option("--points", options.points_file, "JSON file of points to focus on (petzval help files: format)")
      ->type_name("FILE")
      ->required();
  examples::add_out_folder(app, options.out_folder, "folder for the pictures")->required();
  constexpr examples::Range angle{0, 89, "a number of degrees from 0 to 89"};
  examples::add_number(app, "--max-tilt", options.max_tilt_deg, angle, "largest tilt of the film (degrees)");
  app.add_flag("--robust", options.robust, "ignore outliers: points far from the plane of most points get no weight");
  app.add_flag("--json", options.json, "print one JSON object instead of text");

  examples::add_threads(app);
  return examples::run(app, argc, argv, [&] {
    const Result result = solve(options);
    const std::filesystem::path folder = options.out_folder;
    const std::string svg = side_view(result);
    const auto pictures = blur_pictures(result);
    examples::make_folder(folder);
    std::vector<std::string> files;
    const auto named = [&](const char* ending) {
      files.push_back((folder / (result.lens.id + ending)).string());
      return files.back();
    };
    examples::write_text(named("_side.svg"), svg);
    if (!pictures.empty()) {
      examples::write_svg(pictures[0], named("_before.svg"));
      examples::write_svg(pictures[1], named("_after.svg"));
    }
    if (options.json) {
      std::cout << to_json(result, options, files).dump(1) << '\n';
      return;
    }
    std::cout << to_text(result, options) << '\n';
    for (const std::string& file : files) std::cout << file << '\n';
  });
}
