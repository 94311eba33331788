// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "editor_settings.hpp"
#include "focus/targets.hpp"
#include "petzval/core/error.hpp"
#include "petzval/fit/tilt_fit.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace editor_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Points that have faded to less are hidden.
constexpr double least_fade = 1e-3;

/// A lens at a distance, with the upright film that shows the angle of the scene.
struct Focused {
  Lens lens;
  IdealLens ideal;
  Film film;
  double focus_mm;
  bool by_distance = true;  ///< false: as its prescription, at the distance that is then in focus
  double entrance_z() const noexcept { return ideal.pupils.entrance.z; }
};

Focused with_scene_film(const FocusScene& scene, Lens lens, double focus_mm) {
  const double height =
      scene.vertical_angle_rad > 0 ? film_height_for_angle(lens, scene.vertical_angle_rad) : Film().height_mm;
  const Film film{.width_mm = height * scene.columns / scene.rows,
                  .height_mm = height,
                  .columns = scene.columns,
                  .rows = scene.rows,
                  .z_mm = lens.film_z()};
  IdealLens ideal = thick_lens(lens);
  return {std::move(lens), ideal, film, focus_mm};
}

/// Focuses the lens at a distance. Returns nullopt if the lens cannot be focused at this distance.
std::optional<Focused> try_focus(const FocusScene& scene, const EditorSettings& settings, const Lens& lens,
                                 double focus_mm) {
  if (!(focus_mm > 0)) return {};
  try {
    return with_scene_film(scene, with_focus(lens, focus_mm, focus_options(settings.setup)), focus_mm);
  } catch (const Error&) {
    return {};  // with_focus() has no status: the lens may have groups that collide
  }
}

/// The lens at the distance of the settings, else at infinity, else where its prescription has its film.
Focused focused_nearby(const FocusScene& scene, const EditorSettings& settings, const Lens& lens) {
  if (auto focused = try_focus(scene, settings, lens, settings.focus_mm())) return *focused;
  if (auto focused = try_focus(scene, settings, lens, infinity)) return *focused;
  const FocusSolution own = solve_subject(lens, lens.film_z(), focus_options(settings.setup));
  Focused result = with_scene_film(scene, lens, own.distance);
  result.by_distance = false;
  return result;
}

/// A point in the scene at a time. A point of a triangle follows its vertices.
ScenePoint scene_point(const FocusScene& scene, const FocusPlace& place, double time) {
  if (!place.triangle || !scene.vertex) return place.point;
  Vec3<double> sum{0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    sum += scene.vertex(place.triangle->vertices[i], time) * place.triangle->barycentric[i];
  }
  return {sum};
}

ScenePoint in_lens(const FocusScene& scene, double entrance_z, const ScenePoint& point) {
  if (!point.at_infinity) return {to_lens(scene, entrance_z, point.position)};
  return {to_lens(scene, entrance_z, point.position + scene.position) - Vec3<double>(0, 0, entrance_z), true};
}

/// A point of the editor as a focus point of the lens frame. by_hand: its values of now replace its keys.
FocusPoint focus_point(const FocusScene& scene, double entrance_z, const EditorPoint& point, bool by_hand,
                       double pixel_mm, double time) {
  FocusPoint result;
  const auto add = [&](double at, const PointValues& values) {
    if (!values.place) return;
    result.keys.push_back({at, in_lens(scene, entrance_z, scene_point(scene, *values.place, time)),
                           values.blur_px * pixel_mm, values.weight, values.extent_stops});
  };
  if (point.keys.empty() || by_hand) {
    add(0, point.now);
  } else {
    for (const auto& [at, values] : point.keys) add(at, values);
    // A focus point requires that all keys have an extent if a key has an extent. An extent of 0 changes nothing.
    if (std::ranges::any_of(result.keys, [](const FocusKey& key) { return key.extent_stops.has_value(); })) {
      for (FocusKey& key : result.keys) key.extent_stops = key.extent_stops.value_or(0);
    }
  }
  return result;
}

/// Sets the values of keyed points to their values at the time.
void follow_keys(const FocusScene& scene, EditorSettings& settings, const Focused& base) {
  for (auto& shared : settings.points) {
    if (shared->keys.empty() || shared->by_hand) continue;
    EditorPoint& point = shared.edit();
    const FocusPoint track = focus_point(scene, base.entrance_z(), point, false, base.film.pixel_mm(), settings.time_s);
    if (track.keys.empty()) continue;
    const auto found = focus_targets(base.ideal, std::span(&track, 1), {.time = settings.time_s});
    if (found.empty()) continue;  // without an image: the last values stay
    const FocusTarget& target = found.front();
    const double blur_px = target.blur_mm / base.film.pixel_mm();
    // A point with a single key keeps its triangle and follows the vertices.
    const auto& first = point.keys.front().second;
    const bool one_place = point.keys.size() == 1;
    FocusPlace place;
    if (one_place) {
      place = *first.place;
    } else if (target.point.at_infinity) {
      place.point = {to_scene(scene, base.entrance_z(), target.point.position + Vec3<double>(0, 0, base.entrance_z())) -
                         scene.position,
                     true};
    } else {
      place.point = {to_scene(scene, base.entrance_z(), target.point.position)};
    }
    point.now = {place, blur_px, target.weight, target.extent_stops};
  }
  if (!settings.focus_keys.empty() && !settings.focus_by_hand) {
    FocusPoint track;
    for (const auto& [at, distance] : settings.focus_keys) {
      track.keys.push_back({at, std::isinf(distance) ? ScenePoint{{0, 0, -1}, true} : ScenePoint{{0, 0, -distance}}});
    }
    const auto found = focus_targets(base.ideal, std::span(&track, 1), {.time = settings.time_s});
    if (!found.empty()) {
      settings.setup.focus_mm = found.front().point.at_infinity ? infinity : -found.front().point.position.z;
    }
  }
}

/// The points of the settings in front of a focused lens.
struct Scenery {
  std::vector<FocusPoint> tracks;    ///< each with one key, or without keys if the depth is unknown
  std::vector<FocusTarget> targets;  ///< one per point; points without depth have the weight 0
};

Scenery scenery(const FocusScene& scene, const EditorSettings& settings, const Focused& base) {
  Scenery result;
  for (const auto& shared : settings.points) {
    const EditorPoint& point = *shared;
    result.tracks.push_back(focus_point(scene, base.entrance_z(), point, true, base.film.pixel_mm(), settings.time_s));
    FocusTarget target;
    target.weight = 0;
    if (!result.tracks.back().keys.empty()) {
      const FocusKey& key = result.tracks.back().keys.front();
      const double fade = point.fade.value_or(1);
      target = {std::get<ScenePoint>(key.anchor), key.blur_mm, fade < least_fade ? 0 : key.weight * fade,
                key.extent_stops};
    }
    result.targets.push_back(target);
  }
  if (settings.nearer_weighs_more) focus_detail::weigh_nearer_more(base.ideal, result.targets);
  return result;
}

std::optional<FilmPoint> film_point(const Focused& base, const Film& film, const FocusTarget& target) {
  const auto image = base.ideal.image(target.point);
  return image ? chief_point(*image, film) : std::nullopt;
}

/// Fades points that leave the picture, and back: exponential in time, so that every frame rate gives the same fades.
void advance_fades(EditorSettings& settings, const Focused& base, const Scenery& points) {
  const double left = settings.fade_s > 0 ? std::exp(-settings.seconds_to_fade / settings.fade_s) : 0;
  for (std::size_t i = 0; i < settings.points.size(); ++i) {
    const auto at = points.tracks[i].keys.empty() ? std::nullopt : film_point(base, base.film, points.targets[i]);
    const bool seen = at && base.film.contains(*at);
    const double end = seen || !settings.points_fade ? 1 : 0;
    const std::optional<double> fade = settings.points[i]->fade;
    if (fade == end) continue;
    settings.points[i].edit().fade = fade ? end + (*fade - end) * left : end;
  }
  settings.seconds_to_fade = 0;
}

/// The distance and the tilt that serve the points.
struct Solution {
  std::string_view status = "solved";
  double focus_mm = infinity, tilt_rad = 0, swing_rad = 0;
};

/// The distance in focus of a film position. Beyond infinity: infinity.
double distance_of(const EditorSettings& settings, const Lens& lens, double film_z) {
  return solve_subject(lens, film_z, focus_options(settings.setup)).distance;
}

/// True if the points are served by first-order optics.
bool first_order(const EditorSettings& settings) {
  return settings.setup.lens.thin_mm > 0 || settings.serve == FocusServe::surface ||
         !settings.setup.camera.expressive.empty() || settings.from_lens != 0;
}

Solution solve(const EditorSettings& settings, const Focused& base, const Scenery& points) {
  const bool ideal = first_order(settings);
  switch (settings.serve) {
    case FocusServe::distance: {
      const Film& by_hand = settings.setup.film;
      Solution result{"solved", settings.focus_mm(), by_hand.tilt_rad, by_hand.swing_rad};
      for (std::size_t i = 0; i < settings.points.size(); ++i) {
        if (settings.points[i]->id != settings.active) continue;
        const ScenePoint& at = points.targets[i].point;
        const bool ahead = !points.tracks[i].keys.empty() && at.position.z < 0;
        if (!ahead) {
          result.status = name(FocusStatus::no_targets);
          return result;
        }
        result.focus_mm = at.at_infinity ? infinity : -at.position.z;
      }
      return result;
    }
    case FocusServe::tilt: {
      const TiltOptions options{.film = base.film};
      const TiltFit fit =
          ideal ? fit_tilt(base.ideal, points.targets, options) : fit_tilt(base.lens, points.targets, options);
      if (!fit) return {name(fit.status), settings.focus_mm()};
      return {name(fit.status), distance_of(settings, base.lens, fit.film.z()), fit.film.tilt_rad, fit.film.swing_rad};
    }
    case FocusServe::film:
    case FocusServe::surface: break;
  }
  const Autofocus focus =
      ideal ? autofocus(base.ideal, points.targets, base.film) : autofocus(base.lens, points.targets, base.film);
  if (!focus) return {name(focus.status), settings.focus_mm()};
  return {"solved", distance_of(settings, base.lens, focus.film.z())};
}

/// Fills in status, blur and raster position of the marks on the final film.
void measure(const EditorSettings& settings, const Focused& base, const Scenery& points, FocusEditorState& state) {
  std::vector<ScenePoint> all;
  for (const FocusTarget& target : points.targets) all.push_back(target.point);
  const bool traced = !first_order(settings);
  std::vector<std::optional<ExactBlur>> exact(all.size());
  std::vector<double> blurs(all.size(), std::numeric_limits<double>::quiet_NaN());
  if (traced && !all.empty()) {
    exact = exact_blurs(state.lens, state.setup.film, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (exact[i]) blurs[i] = exact[i]->signed_diameter / state.setup.film.pixel_mm();
    }
  } else if (!all.empty()) {
    blurs = state.first_order_blurs_px(all);
  }
  for (std::size_t i = 0; i < points.targets.size(); ++i) {
    const EditorPoint& point = *settings.points[i];
    FocusMark& mark = state.targets[i];
    const FocusTarget& target = points.targets[i];
    const auto image = points.tracks[i].keys.empty() ? std::nullopt : base.ideal.image(target.point);
    if (!point.now.place) {
      mark.status = "no_depth";
    } else if (!image) {
      mark.status = name(TargetStatus::no_image);
    } else if (mark.fade < least_fade) {
      mark.status = "hidden";
    } else if (!(target.weight > 0) || (settings.serve == FocusServe::distance && point.id != settings.active)) {
      mark.status = name(TargetStatus::no_weight);
    } else if (traced && !exact[i]) {
      mark.status = name(TargetStatus::no_rays);
    }
    if (!image) continue;
    const auto at = chief_point(*image, state.setup.film);
    if (at) mark.raster = state.setup.film.raster(*at);
    if (std::isfinite(blurs[i])) mark.blur_px = blurs[i];
  }
}

/// True if another pass would change the distance: the blur of a pixel or the place of the entrance pupil moved, or the
/// lens focuses by moving groups, for which the film was solved with the groups of another distance.
bool moved(const EditorSettings& settings, const Focused& before, const Focused& after) {
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-12 * std::abs(a); };
  const bool blurred =
      std::ranges::any_of(settings.points, [](const Shared<EditorPoint>& point) { return point->now.blur_px != 0; });
  return (blurred && differ(before.film.pixel_mm(), after.film.pixel_mm())) ||
         std::abs(before.entrance_z() - after.entrance_z()) > 1e-9 ||
         (!after.lens.focus_positions().empty() && differ(before.focus_mm, after.focus_mm));
}

/// A camera that is made when it is needed first.
struct LazyCamera {
  std::once_flag flag;
  std::optional<Camera> camera;
};

}  // namespace

Vec3<double> to_lens(const FocusScene& scene, double entrance_z, const Vec3<double>& point) noexcept {
  const Vec3<double> from = point - scene.position;
  const auto along = [&](const Vec3<double>& axis) { return from.x * axis.x + from.y * axis.y + from.z * axis.z; };
  return {along(scene.right), along(scene.up), along(scene.back) + entrance_z};
}

Vec3<double> to_scene(const FocusScene& scene, double entrance_z, const Vec3<double>& point) noexcept {
  return scene.position + scene.right * point.x + scene.up * point.y + scene.back * (point.z - entrance_z);
}

FocusOptions focus_options(const CameraSetup& setup) {
  return {.criterion = setup.lens.thin_mm > 0 ? FocusCriterion::paraxial : FocusCriterion::min_rms};
}

Lens shaped_lens(const EditorSettings& settings) {
  CameraSetup setup = settings.setup;
  setup.focus_mm.reset();
  return prepared(setup, *settings.wide_open);
}

FocusEditorState state_of(const FocusScene& scene, EditorSettings& settings) {
  const Lens lens = shaped_lens(settings);
  Focused base = focused_nearby(scene, settings, lens);
  bool reached = base.focus_mm == settings.focus_mm();
  follow_keys(scene, settings, base);
  Scenery points = scenery(scene, settings, base);
  advance_fades(settings, base, points);
  Solution solution;
  constexpr int most_passes = 8;
  for (int pass = 0; pass < most_passes; ++pass) {
    points = scenery(scene, settings, base);
    solution = solve(settings, base, points);
    std::optional<Focused> next = try_focus(scene, settings, lens, solution.focus_mm);
    reached = next.has_value();
    if (!next) break;
    const bool again = moved(settings, base, *next);
    base = *std::move(next);
    if (!again) break;
  }
  settings.setup.focus_mm = base.focus_mm;
  points = scenery(scene, settings, base);

  FocusEditorState state{.setup = settings.setup, .lens = base.lens};
  CameraSetup& setup = state.setup;
  setup.focus = focus_options(setup);
  if (!base.by_distance) setup.focus_mm.reset();
  setup.film = base.film;
  // Rounded to an angle that is a double in degrees. A command line can state this angle.
  setup.film.tilt_rad = radians(degrees(solution.tilt_rad));
  setup.film.swing_rad = radians(degrees(solution.swing_rad));
  ExpressiveLens& expressive = setup.camera.expressive;
  if (settings.from_lens != 0) {
    const ExpressiveLens own = fit_expressive_lens(base.lens, base.film);
    if (expressive.power.empty()) {
      for (const PowerKnot& knot : own.power) {
        expressive.power.push_back({knot.radius, 1 + settings.from_lens * (knot.power - 1)});
      }
    }
    if (expressive.film_offsets.empty()) {
      for (FilmOffset offset : own.film_offsets) {
        offset.offset_mm *= settings.from_lens;
        expressive.film_offsets.push_back(offset);
      }
    }
  }
  state.serve = settings.serve;
  state.f_number = setup.f_number ? *setup.f_number : real_f_number(*settings.wide_open);
  state.focus_mm = base.focus_mm;
  state.status = reached ? solution.status : name(FocusStatus::unreachable);
  state.time_s = settings.time_s;
  if (settings.serve == FocusServe::surface) {
    std::vector<double> fades;
    std::vector<FocusPoint> tracks;
    for (std::size_t i = 0; i < points.tracks.size(); ++i) {
      if (points.tracks[i].keys.empty()) continue;
      tracks.push_back(points.tracks[i]);
      fades.push_back(*settings.points[i]->fade);
    }
    std::vector<FocalPoint> seen =
        focal_points(base.ideal, base.film, tracks,
                     {.time = settings.time_s, .nearer_weighs_more = settings.nearer_weighs_more}, fades);
    const bool weighs = std::ranges::any_of(seen, [](const FocalPoint& point) { return point.weight > 0; });
    if (weighs) {
      setup.focal_surface.default_inverse_distance = 1 / (base.focus_mm + base.entrance_z());
      state.surface.emplace(base.ideal, base.film, seen, setup.focal_surface);
      setup.focal_points = std::move(seen);
    } else {
      state.status = name(FocusStatus::no_targets);
    }
  }
  for (const auto& shared : settings.points) {
    const EditorPoint& point = *shared;
    FocusMark mark{.id = point.id, .id_is_number = point.id_is_number};
    if (point.now.place) {
      const ScenePoint at = scene_point(scene, *point.now.place, settings.time_s);
      mark.place_mm = at.position, mark.at_infinity = at.at_infinity;
    }
    mark.requested_px = point.now.blur_px, mark.weight = point.now.weight;
    mark.fade = *point.fade;
    mark.extent_stops = point.now.extent_stops;
    state.targets.push_back(std::move(mark));
  }
  measure(settings, base, points, state);
  const bool first_order = state.surface || !expressive.empty();
  setup.camera.model = state.thin() ? ModelKind::thin : first_order ? ModelKind::thick : ModelKind::exact_float;
  setup.camera.normalisation = Normalisation::unity_on_axis;
  setup.camera.paraxial_focus = state.thin();
  state.camera = [setup, lens = state.lens, made = std::make_shared<LazyCamera>()]() -> const Camera& {
    std::call_once(made->flag, [&] { made->camera.emplace(petzval::camera(setup, lens)); });
    return *made->camera;
  };
  return state;
}

}  // namespace editor_detail

std::vector<double> FocusEditorState::first_order_blurs_px(std::span<const ScenePoint> points) const {
  const IdealLens ideal = thick_lens(lens);
  const Film& film = setup.film;
  const double exit_z = ideal.pupils.exit.z;
  Film sharp = film;
  std::vector<double> result;
  for (const ScenePoint& point : points) {
    double& blur = result.emplace_back(std::numeric_limits<double>::quiet_NaN());
    const auto image = ideal.image(point);
    const auto at = image ? chief_point(*image, film) : std::nullopt;
    if (!at) continue;
    double scale = 1 / film.pixel_mm();
    if (surface) {
      // The pupil has the size of the extent, and the beam meets the film that images the distance of the surface.
      const FocalSurface::Values values = surface->at(*at);
      const auto in_focus = ideal.image(values.inverse_distance == 0
                                            ? ScenePoint{{0, 0, -1}, true}
                                            : ScenePoint{{0, 0, surface->origin_z() - 1 / values.inverse_distance}});
      if (!in_focus) continue;
      sharp.z_mm = in_focus->position.z;
      scale *= focus_detail::pupil_scale(values.extent_stops);
      if (std::isfinite(exit_z)) scale *= (film.z() - exit_z) / (sharp.z() - exit_z);
    }
    blur = signed_blur(*image, sharp) * scale;
  }
  return result;
}

}  // namespace petzval
