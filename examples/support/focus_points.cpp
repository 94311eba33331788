// SPDX-License-Identifier: Apache-2.0
#include "focus_points.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "json_input.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "text.hpp"

namespace examples {
namespace {

using petzval::Error;
using petzval::Vec3;

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
    if (at.empty()) return {};
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
  /// The time, which must be later than the time before.
  double time(std::optional<double> before) const {
    const std::optional<double> time = number("time_s", finite_number);
    if (!time || (before && !(*before < *time))) {
      refuse("time_s", "a time after the previous key");
    }
    return *time;
  }
  /// A point of the lens frame, without a picture.
  petzval::FocusKey in_lens_frame() const {
    for (const char* key : {"pixel", "distance_mm", "blur_px", "fade"}) {
      if (has(key)) throw Error(where + ": " + key + " is for focal surfaces; must be left out");
    }
    const auto point = place();
    if (!point) throw Error(where + ": has neither position_mm (or world_mm) nor keys; must have one of them");
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

template <class Use>
void for_points(const std::string& file, const Use& use) {
  for_entries(file, points_of(file), "point", [&](const Entry& entry) {
    entry.keys({"id", "pixel", "position_mm", "world_mm", "at_infinity", "distance_mm", "blur_mm", "blur_px", "weight",
                "extent_stops", "fade", "fixes_distance", "from_s", "until_s", "keys"});
    use(entry);
  });
}

petzval::FocalPoint focal_point(const Entry& entry, const petzval::Camera& camera, double counted_from,
                                const WorldToLens& to_lens) {
  const std::string& where = entry.where;
  const double entrance_z = petzval::pupils(camera.lens()).entrance.z;
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
    const double from_pupil = *distance + entrance_z - counted_from;
    if (!(from_pupil > 0)) {
      entry.refuse("distance_mm",
                   "more than " + number(counted_from - entrance_z) + ", the distance of the entrance pupil");
    }
    point.inverse_distance = 1 / from_pupil;
  }
  if (!entry.fixes_distance()) point.inverse_distance.reset();
  if (!point.inverse_distance && !point.extent_stops) {
    throw Error(where + ": has neither distance_mm nor extent_stops; must have one of them");
  }
  const auto px = entry.number("blur_px", finite_number), mm = entry.number("blur_mm", finite_number);
  if ((px || mm) && !point.inverse_distance) throw Error(where + ": has a blur; must be left out without distance_mm");
  point.blur_mm = px ? *px * camera.film().pixel_mm() : mm.value_or(0);
  return point;
}

}  // namespace

std::vector<petzval::FocusTarget> read_targets(const std::string& file) {
  std::vector<petzval::FocusTarget> result;
  if (points_of(file).empty()) return result;
  for_points(file, [&](const Entry& entry) {
    const petzval::FocusKey key = entry.in_lens_frame();
    result.push_back({*entry.place(), key.blur_mm, key.weight, key.extent_stops, entry.fixes_distance()});
  });
  return result;
}

std::vector<petzval::FocusPoint> read_focus_points(const std::string& file) {
  std::vector<petzval::FocusPoint> result;
  for_points(file, [&](const Entry& entry) {
    petzval::FocusPoint point{.keys = {}, .fixes_distance = entry.fixes_distance()};
    point.from = entry.number("from_s", finite_number).value_or(point.from);
    point.until = entry.number("until_s", finite_number).value_or(point.until);
    if (!(point.until >= point.from)) entry.refuse("until_s", "a time not before from_s");
    if (!entry.has("keys")) point.keys = {entry.in_lens_frame()};
    const auto add = [&](const Entry& key) {
      key.keys({"time_s", "position_mm", "world_mm", "at_infinity", "blur_mm", "weight", "extent_stops"});
      const double time = key.time(point.keys.empty() ? std::nullopt : std::optional(point.keys.back().time));
      point.keys.push_back(key.in_lens_frame());
      point.keys.back().time = time;
      if (point.keys.back().extent_stops.has_value() == point.keys.front().extent_stops.has_value()) return;
      throw Error(key.where + ": extent_stops must be given in all keys of the point or in no key");
    };
    if (entry.has("keys")) for_entries(entry.where + ": keys", entry.json["keys"], "key", add);
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
  for_points(file,
             [&](const Entry& entry) { setup.focal_points.push_back(focal_point(entry, camera, from_z, to_lens)); });
  setup.focal_surface.default_inverse_distance = 1 / (*setup.focus_mm + petzval::pupils(lens).entrance.z - from_z);
  try {
    return {petzval::thick_lens(lens), camera.film(), setup.focal_points, setup.focal_surface};
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
