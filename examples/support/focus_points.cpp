// SPDX-License-Identifier: Apache-2.0
#include "focus_points.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "json_input.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "text.hpp"

namespace examples {
namespace {

using petzval::Error;
using petzval::Vec3;

// The keys of each kind of point. A point over time has the keys of a target, or `keys` and the keys of all times.
const std::initializer_list<std::string_view> target_keys{"id",      "position_mm", "world_mm",     "at_infinity",
                                                          "blur_mm", "weight",      "extent_stops", "fixes_distance"};
const std::initializer_list<std::string_view> still_keys{"id",      "position_mm", "world_mm",     "at_infinity",
                                                         "blur_mm", "weight",      "extent_stops", "fixes_distance",
                                                         "from_s",  "until_s"};
const std::initializer_list<std::string_view> moving_keys{"id", "fixes_distance", "from_s", "until_s", "keys"};
const std::initializer_list<std::string_view> moment_keys{"time_s",  "position_mm", "world_mm",    "at_infinity",
                                                          "blur_mm", "weight",      "extent_stops"};
const std::initializer_list<std::string_view> focal_keys{
    "id",      "pixel",   "position_mm", "world_mm",     "at_infinity", "distance_mm",
    "blur_mm", "blur_px", "weight",      "extent_stops", "fade",        "fixes_distance"};

constexpr std::array kinds{petzval::SurfaceKind::affine, petzval::SurfaceKind::shepard};
constexpr Range extent_range{-20, 20, "a number of stops from -20 to 20"};
constexpr Range weight_range{0, std::numeric_limits<double>::max(), "a finite number, 0 or more"};
constexpr Range fraction_range{0, 1, "a number from 0 to 1"};

/// A point, or a key of a point.
struct Entry : JsonEntry {
  std::optional<petzval::ScenePoint> place() const {
    if (has("world_mm") && has("position_mm")) {
      throw Error(where + ": has both of world_mm and position_mm; must have one of them");
    }
    const bool at_infinity = flag("at_infinity", false);
    const std::vector<double> at = numbers(place_key(), 3, "three finite numbers, [x, y, z]");
    if (at.empty()) {
      if (has("at_infinity")) throw Error(where + ": has at_infinity; must be left out without position_mm");
      return {};
    }
    if (at_infinity && at == std::vector<double>(3)) refuse(place_key(), "a direction that is not 0");
    return petzval::ScenePoint{{at[0], at[1], at[2]}, at_infinity};
  }
  const char* place_key() const { return has("world_mm") ? "world_mm" : "position_mm"; }
  /// Infinite for null.
  std::optional<double> distance() const {
    const bool far = has("distance_mm") && json["distance_mm"].is_null();
    return far ? std::numeric_limits<double>::infinity() : number("distance_mm", positive_number);
  }
  double weight() const { return number("weight", weight_range).value_or(1); }
  std::optional<double> extent() const { return number("extent_stops", extent_range); }
  bool fixes_distance() const { return flag("fixes_distance", true); }
  /// Refuses a point without a distance that has no extent, or that has a blur.
  void need_distance(bool has_distance) const {
    if (has_distance) return;
    if (!has("extent_stops")) {
      throw Error(where + ": has neither a distance in focus nor extent_stops; must have one of them");
    }
    for (const char* blur : {"blur_mm", "blur_px"}) {
      if (has(blur)) throw Error(where + ": has " + blur + "; must be left out without a distance in focus");
    }
  }
  /// The time, which must be later than the time before.
  double time(std::optional<double> before) const {
    const std::optional<double> time = number("time_s", finite_number);
    if (!time) refuse("time_s", finite_number.words);
    if (before && !(*before < *time)) refuse("time_s", "a time after the previous key");
    return *time;
  }
  /// A point of the lens frame, without a picture.
  petzval::FocusKey in_lens_frame(const WorldToLens& to_lens, bool has_distance) const {
    std::optional<petzval::ScenePoint> point = place();
    if (!point) refuse("position_mm", "three finite numbers, [x, y, z]");
    need_distance(has_distance);
    point->position = to_lens(point->position) - (point->at_infinity ? to_lens({0, 0, 0}) : Vec3<double>{});
    return {.anchor = *point,
            .blur_mm = number("blur_mm", finite_number).value_or(0),
            .weight = weight(),
            .extent_stops = extent()};
  }
};

/// The points of a file: a list, or an object with the list "points".
Json points_of(const std::string& file) {
  Json document = read_json(file);
  if (document.is_array()) return document;
  if (document.is_object() && document.contains("keys")) {
    throw Error(file + ": has distances over time; must be given as --focus " + file);
  }
  const JsonEntry entry{file, document};
  entry.keys({"points"}, "points, or a list");
  if (!entry.has("points") || !document["points"].is_array()) entry.refuse("points", "a list of points");
  return document["points"];
}

/// Calls use(entry) for the elements of a list, named `name` and counted from 1.
template <class Use>
void for_entries(const std::string& where, const Json& list, const std::string& name, const Use& use) {
  if (!list.is_array() || list.empty()) refuse(where, list, "a list of one or more " + name + "s");
  for (std::size_t i = 0; i < list.size(); ++i) {
    use(Entry{{where + ": " + name + " " + std::to_string(i + 1), list[i]}});
  }
}

bool in_front(const petzval::FocusKey& key) { return std::get<petzval::ScenePoint>(key.anchor).position.z < 0; }

petzval::FocalPoint focal_point(const Entry& entry, const petzval::Camera& camera, double counted_from,
                                const WorldToLens& to_lens) {
  const std::string& where = entry.where;
  const double entrance_z = petzval::pupils(camera.lens()).entrance.z;
  entry.keys(focal_keys);
  const std::vector<double> pixel = entry.numbers("pixel", 2, "two finite numbers, [x, y]");
  const auto world = entry.place();
  if (pixel.empty() != world.has_value()) {
    throw Error(where + ": has " + (world ? "both of" : "neither of") +
                " pixel and position_mm (or world_mm); must have one of them");
  }
  petzval::FocalPoint point{.extent_stops = entry.extent(),
                            .weight = entry.weight(),
                            .fade = entry.number("fade", fraction_range).value_or(1)};
  if (!world) {
    point.film_point = camera.film().point(pixel[0], pixel[1]);
  } else {
    constexpr double far_mm = 1e12;
    Vec3<double> position = to_lens(world->position);
    if (world->at_infinity) position = far_mm * (position - to_lens({0, 0, 0}));
    const petzval::Projection seen = camera.project(position);
    if (seen.status == petzval::AimStatus::no_ray) {
      entry.refuse(entry.place_key(), "a point that the camera images on or outside its film");
    }
    point.film_point = seen.film;
    point.inverse_distance = world->at_infinity ? 0 : 1 / (entrance_z - position.z);
  }
  if (const auto distance = entry.distance()) {
    if (world && world->at_infinity) throw Error(where + ": has distance_mm; must be left out with at_infinity");
    const double from_pupil = *distance + entrance_z - counted_from;
    if (!(from_pupil > 0)) {
      entry.refuse("distance_mm",
                   "more than " + number(counted_from - entrance_z) + ", the distance of the entrance pupil");
    }
    point.inverse_distance = 1 / from_pupil;
  }
  if (!entry.fixes_distance()) point.inverse_distance.reset();
  entry.need_distance(point.inverse_distance.has_value());
  const auto px = entry.number("blur_px", finite_number), mm = entry.number("blur_mm", finite_number);
  if (px && mm) throw Error(where + ": has both of blur_px and blur_mm; must have one of them");
  point.blur_mm = px ? *px * camera.film().pixel_mm() : mm.value_or(0);
  return point;
}

}  // namespace

std::vector<petzval::FocusTarget> read_targets(const std::string& file) {
  std::vector<petzval::FocusTarget> result;
  const Json points = points_of(file);
  if (points.empty()) return result;
  for_entries(file, points, "point", [&](const Entry& entry) {
    entry.keys(target_keys);
    const bool fixes = entry.fixes_distance();
    const petzval::FocusKey key = entry.in_lens_frame(std::identity(), fixes);
    result.push_back({std::get<petzval::ScenePoint>(key.anchor), key.blur_mm, key.weight, key.extent_stops, fixes});
  });
  return result;
}

std::vector<petzval::FocusPoint> read_focus_points(const std::string& file, const WorldToLens& to_lens) {
  std::vector<petzval::FocusPoint> result;
  for_entries(file, points_of(file), "point", [&](const Entry& entry) {
    const bool moves = entry.has("keys");
    entry.keys(moves ? moving_keys : still_keys);
    petzval::FocusPoint point{.keys = {}, .fixes_distance = entry.fixes_distance()};
    point.from = entry.number("from_s", finite_number).value_or(point.from);
    point.until = entry.number("until_s", finite_number).value_or(point.until);
    if (!(point.until >= point.from)) entry.refuse("until_s", "a time not before from_s");
    if (!moves) point.keys = {entry.in_lens_frame(to_lens, point.fixes_distance)};
    const auto add = [&](const Entry& key) {
      key.keys(moment_keys);
      const double time = key.time(point.keys.empty() ? std::nullopt : std::optional(point.keys.back().time));
      point.keys.push_back(key.in_lens_frame(to_lens, point.fixes_distance));
      point.keys.back().time = time;
      if (point.keys.back().extent_stops.has_value() == point.keys.front().extent_stops.has_value()) return;
      throw Error(key.where + ": extent_stops must be given in all keys of the point or in no key");
    };
    if (moves) for_entries(entry.where + ": keys", entry.json["keys"], "key", add);
    if (std::ranges::none_of(point.keys, in_front)) throw Error(entry.where + ": is never in front of the lens");
    result.push_back(std::move(point));
  });
  return result;
}

std::vector<FocusPull::Key> read_distances(const std::string& file, std::string& from) {
  const Json document = read_json(file);
  const JsonEntry all{file, document};
  all.keys({"distance_from", "keys"});
  from.clear();
  if (all.has("distance_from")) {
    const Json& given = document["distance_from"];
    const auto is = [&](petzval::DistanceOrigin origin) { return given == std::string(name(origin)); };
    if (std::ranges::none_of(distance_origins, is)) all.refuse("distance_from", "a value of --from");
    from = given.get<std::string>();
  }
  std::vector<FocusPull::Key> keys;
  for_entries(file + ": keys", document.value("keys", Json()), "key", [&](const Entry& key) {
    key.keys({"time_s", "distance_mm"}, "time_s and distance_mm; infinity is null");
    const double time = key.time(keys.empty() ? std::nullopt : std::optional(keys.back().time_s));
    const auto distance = key.distance();
    if (!distance) key.refuse("an object with time_s and distance_mm");
    keys.push_back({time, 1 / *distance});
  });
  return keys;
}

petzval::FocalSurface read_focal_surface(const std::string& file, petzval::CameraSetup& setup,
                                         const petzval::Camera& camera, const WorldToLens& to_lens) {
  const petzval::Lens& lens = camera.lens();
  const double from_z = petzval::origin_z(lens, setup.focus.origin);
  setup.focal_points.clear();
  for_entries(file, points_of(file), "point",
              [&](const Entry& entry) { setup.focal_points.push_back(focal_point(entry, camera, from_z, to_lens)); });
  setup.focal_surface.default_inverse_distance = 1 / (*setup.focus_mm + petzval::pupils(lens).entrance.z - from_z);
  return focal_surface(file, petzval::thick_lens(lens), camera.film(), setup);
}

petzval::FocalSurface focal_surface(const std::string& file, const petzval::IdealLens& lens, const petzval::Film& film,
                                    const petzval::CameraSetup& setup) {
  try {
    return {lens, film, setup.focal_points, setup.focal_surface};
  } catch (const Error& error) {
    throw Error(file + ": " + error.what());
  }
}

Option* add_focal_surface(App& app, CameraFlags& flags, const std::string& help) {
  Option* const points =
      app.add_option("--points", flags.points_file, help + " (petzval help files: format)")->type_name("POINTS.json");
  petzval::FocalSurfaceOptions& options = flags.focal_surface;
  add_choice(app, "--kind", options.kind, kinds,
             "interpolation of distances between points: affine (by planes, which are reproduced) or shepard "
             "(weighted means, flat at the points)",
             names(kinds));
  add_number(app, "--beta", options.beta, {1, 8, "a number from 1 to 8"},
             "exponent of the weights: a point's weight is its distance in the picture to the power -beta");
  app.add_check([&app, &flags, points] {
    if (points->given() || !flags.focal_points.empty()) return;
    for (const char* flag : {"--kind", "--beta"}) {
      if (app.given(flag)) throw Error(std::string(flag) + " needs --points");
    }
  });
  return points;
}

}  // namespace examples
