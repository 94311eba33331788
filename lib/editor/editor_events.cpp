// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "editor_settings.hpp"
#include "focus/targets.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::editor_detail {
namespace {

using Json = nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largest_tilt_deg = 60;

/// A range of numbers, both ends included, and the words for messages.
struct Range {
  double least = -std::numeric_limits<double>::max(), most = std::numeric_limits<double>::max();
  const char* words = "a finite number";
};
constexpr Range any_number{};
constexpr Range positive{std::numeric_limits<double>::min(), std::numeric_limits<double>::max(), "a positive number"};
constexpr Range not_negative{0, std::numeric_limits<double>::max(), "a number of 0 or more"};

std::string shown(const Json& value) {
  return std::string(beginning(value.dump(-1, ' ', false, Json::error_handler_t::replace), 80));
}

/// An event, for reading its keys. Every key must have been read at the end.
class Event {
 public:
  explicit Event(const Json& json) : json_(json), type_(type_of(json)), read_{"type"} {}

  const std::string& type() const noexcept { return type_; }

  /// The value of a key; null if the event does not have the key.
  const Json* find(const char* key) {
    read_.emplace_back(key);
    const auto at = json_.find(key);
    return at == json_.end() ? nullptr : &*at;
  }
  const Json& at(const char* key, const char* rule) {
    if (const Json* const value = find(key)) return *value;
    throw Error(type_ + ": " + key + " is missing; must be " + rule);
  }
  [[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& rule) const {
    throw Error(type_ + ": " + key + " = " + shown(value) + "; must be " + rule);
  }

  double number(const char* key, const Json& value, const Range& range) const {
    if (!value.is_number()) refuse(key, value, range.words);
    const double number = value.get<double>();
    if (!(number >= range.least && number <= range.most)) refuse(key, value, range.words);
    return number;
  }
  void set(const char* key, double& target, const Range& range = any_number) {
    if (const Json* const value = find(key)) target = number(key, *value, range);
  }
  void set(const char* key, bool& target) {
    const Json* const value = find(key);
    if (!value) return;
    if (!value->is_boolean()) refuse(key, *value, "true or false");
    target = value->get<bool>();
  }
  std::string text(const char* key, const Json& value) const {
    if (!value.is_string()) refuse(key, value, "a text");
    return value.get<std::string>();
  }
  std::vector<double> numbers(const char* key, const Json& value, std::size_t count) const {
    const std::string rule = "a list of " + std::to_string(count) + " finite numbers";
    if (!value.is_array() || value.size() != count) refuse(key, value, rule);
    std::vector<double> result;
    for (const Json& entry : value) {
      if (!entry.is_number()) refuse(key, value, rule);
      result.push_back(entry.get<double>());
    }
    return result;
  }
  /// Rows of numbers, "[[1, 2], [3, 4]]".
  std::vector<std::vector<double>> rows(const char* key, const Json& value, std::size_t columns) const {
    if (!value.is_array()) refuse(key, value, "a list of lists of " + std::to_string(columns) + " numbers");
    std::vector<std::vector<double>> result;
    for (const Json& row : value) result.push_back(numbers(key, row, columns));
    return result;
  }

  /// Refuses keys that were not read.
  void finish() const {
    for (const auto& [key, value] : json_.items()) {
      if (std::ranges::find(read_, key) != read_.end()) continue;
      std::string known;
      for (const std::string& name : read_) known += (known.empty() ? "" : ", ") + name;
      throw Error(type_ + ": key \"" + std::string(beginning(key, 60)) +
                  "\" is unknown; must be a key of this event: " + known);
    }
  }

 private:
  const Json& json_;
  std::string type_;
  std::vector<std::string> read_;
};

/// Scene and state for the events, besides the settings.
struct Context {
  const FocusScene& scene;
  const FocusEditorState& state;
};

struct Id {
  std::string text;
  bool is_number = false;
};

Id id_of(const Event& event, const Json& value) {
  if (value.is_number_integer()) return {value.dump(), true};
  if (!value.is_string() || value.get<std::string>().empty()) event.refuse("id", value, "a text or a whole number");
  return {value.get<std::string>()};
}

EditorPoint& point_of(Event& event, EditorSettings& settings) {
  const Json& value = event.at("id", "the id of a point");
  const Id id = id_of(event, value);
  const auto found =
      std::ranges::find_if(settings.points, [&](const Shared<EditorPoint>& point) { return point->id == id.text; });
  if (found != settings.points.end()) return found->edit();
  std::string known;
  for (const auto& point : settings.points) known += (known.empty() ? "" : ", ") + point->id;
  event.refuse("id", value, known.empty() ? "the id of a point, but no point exists" : "the id of a point: " + known);
}

/// Reads the place of a point: a pixel, or a position in the scene.
std::optional<FocusPlace> place_of(Event& event, const Context& context, double time) {
  const FocusScene& scene = context.scene;
  const Json* const pixel = event.find("pixel");
  const Json* const position = event.find("position_mm");
  bool at_infinity = false;
  event.set("at_infinity", at_infinity);
  if ((pixel != nullptr) == (position != nullptr)) {
    throw Error(event.type() + ": has " + (pixel ? "both of" : "neither of") +
                " pixel and position_mm; must have either pixel or position_mm");
  }
  if (pixel && at_infinity) event.refuse("at_infinity", true, "left out with pixel");
  if (position) {
    const std::vector<double> at = event.numbers("position_mm", *position, 3);
    if (at_infinity && at[0] == 0 && at[1] == 0 && at[2] == 0) {
      event.refuse("position_mm", *position, "a direction, not 0, with at_infinity");
    }
    return FocusPlace{.point = {{at[0], at[1], at[2]}, at_infinity}};
  }
  const std::vector<double> at = event.numbers("pixel", *pixel, 2);
  if (!(at[0] >= 0 && at[0] <= scene.columns && at[1] >= 0 && at[1] <= scene.rows)) {
    event.refuse(
        "pixel", *pixel,
        "within the picture, [0, 0] to [" + std::to_string(scene.columns) + ", " + std::to_string(scene.rows) + "]");
  }
  if (!scene.place) event.refuse("pixel", *pixel, "left out: the scene has no depths");
  const FocusEditorState& state = context.state;
  // The chief ray: the middle of the pupil.
  const CameraRay chief = state.camera().sample({.film = state.film.point(at[0], at[1]), .pupil_u = 0, .pupil_v = 0});
  if (!chief) return {};
  const double entrance_z = pupils(state.lens).entrance.z;
  const Vec3<double> origin = to_scene(scene, entrance_z, chief.ray.origin);
  return scene.place({origin, to_scene(scene, entrance_z, chief.ray.origin + chief.ray.direction) - origin}, time);
}

void read_values(Event& event, PointValues& values) {
  event.set("weight", values.weight, not_negative);
  event.set("blur_px", values.blur_px);
  if (const Json* const extent = event.find("extent_stops")) {
    if (extent->is_null()) {
      values.extent_stops.reset();
    } else {
      constexpr Range stops{-focus_detail::largest_extent, focus_detail::largest_extent, "a number from -20 to 20"};
      values.extent_stops = event.number("extent_stops", *extent, stops);
    }
  }
}

void add_point(Event& event, const Context& context, EditorSettings& settings) {
  EditorPoint point;
  if (const Json* const id = event.find("id")) {
    const Id read = id_of(event, *id);
    point.id = read.text, point.id_is_number = read.is_number;
  }
  const auto taken = [&](const std::string& id) {
    return std::ranges::any_of(settings.points, [&](const Shared<EditorPoint>& other) { return other->id == id; });
  };
  if (!point.id.empty() && taken(point.id)) {
    event.refuse("id", point.id, "an unused id");
  }
  while (point.id.empty() || taken(point.id)) point.id = std::to_string(++settings.points_added);
  point.now.place = place_of(event, context, settings.time_s);
  read_values(event, point.now);
  point.fade = FadeFilter(settings.fade_s);
  settings.active = point.id;
  settings.points.emplace_back(std::move(point));
}

void move_point(Event& event, const Context& context, EditorSettings& settings) {
  EditorPoint& point = point_of(event, settings);
  point.now.place = place_of(event, context, settings.time_s);
  point.by_hand = true;
  point.fade = FadeFilter(settings.fade_s);
  settings.active = point.id;
}

void set_point(Event& event, const Context&, EditorSettings& settings) {
  EditorPoint& point = point_of(event, settings);
  read_values(event, point.now);
  point.by_hand = true;
}

void remove_point(Event& event, const Context&, EditorSettings& settings) {
  const std::string id = point_of(event, settings).id;
  std::erase_if(settings.points, [&](const Shared<EditorPoint>& point) { return point->id == id; });
  if (settings.active == id) settings.active.clear();
}

void serve(Event& event, const Context&, EditorSettings& settings) {
  const Json& by = event.at("by", "distance, film, tilt or surface");
  constexpr std::array all{FocusServe::distance, FocusServe::film, FocusServe::tilt, FocusServe::surface};
  const std::string word = event.text("by", by);
  const auto found = std::ranges::find_if(all, [&](FocusServe serve) { return name(serve) == word; });
  if (found == all.end()) event.refuse("by", by, "distance, film, tilt or surface");
  settings.serve = *found;
  if (*found == FocusServe::surface) {
    if (const Json* const kind = event.find("kind")) {
      const std::string kind_word = event.text("kind", *kind);
      if (kind_word != "affine" && kind_word != "shepard") event.refuse("kind", *kind, "affine or shepard");
      settings.surface.kind = kind_word == "affine" ? SurfaceKind::affine : SurfaceKind::shepard;
    }
    event.set("beta", settings.surface.beta, {1, 8, "a number from 1 to 8"});
  }
  if (*found != FocusServe::distance) settings.tilt_rad = settings.swing_rad = 0;
}

/// Focuses at a distance by hand.
void by_distance(EditorSettings& settings) {
  settings.serve = FocusServe::distance;
  settings.active.clear();
  settings.focus_by_hand = true;
}

void focus(Event& event, const Context&, EditorSettings& settings) {
  const Json& distance = event.at("distance_mm", "a positive number, or null for infinity");
  settings.focus_mm = distance.is_null() ? infinity : event.number("distance_mm", distance, positive);
  const Lens lens = shaped_lens(settings);
  try {
    with_focus(lens, settings.focus_mm, focus_options(settings.choice));
  } catch (const Error& error) {
    throw Error(std::string("focus: ") + error.what());
  }
  by_distance(settings);
}

void set_f_number(Event& event, const Context& context, EditorSettings& settings) {
  const Json& value = event.at("f_number", "a positive number, or null for wide open");
  settings.f_number.reset();
  if (!value.is_null()) settings.f_number = event.number("f_number", value, positive);
  if (settings.choice.name.empty()) load_lens(context.scene, settings);
}

void iris(Event& event, const Context&, EditorSettings& settings) {
  double blades = settings.iris.blades, rotation = degrees(settings.iris.rotation_rad);
  event.set("blades", blades, {0, 20, "0, or a whole number from 3 to 20"});
  event.set("roundness", settings.iris.roundness, {-1, 1, "a number from -1 to 1"});
  event.set("rotation_deg", rotation, {-1e6, 1e6, "a number from -1e6 to 1e6"});
  if (blades != std::floor(blades)) event.refuse("blades", blades, "0, or a whole number from 3 to 20");
  settings.iris.blades = static_cast<int>(blades);
  settings.iris.rotation_rad = radians(rotation);
}

void bokeh(Event& event, const Context&, EditorSettings& settings) {
  event.set("lens_ratio", settings.bokeh.lens_ratio, positive);
  event.set("rate_of_change", settings.bokeh.rate_of_change);
  event.set("keep_light", settings.bokeh.keep_light);
  event.set("weight_distribution", settings.bokeh.weight_distribution, {-1000, 1000, "a number from -1000 to 1000"});
  event.set("weight_strength", settings.bokeh.weight_strength, {-1e6, 1e6, "a number from -1e6 to 1e6"});
}

void expressive(Event& event, const Context&, EditorSettings& settings) {
  if (const Json* const power = event.find("power_spline")) {
    settings.expressive.power.clear();
    for (const auto& row : event.rows("power_spline", *power, 2)) {
      settings.expressive.power.push_back({row[0], row[1]});
    }
  }
  if (const Json* const offsets = event.find("curvature_points")) {
    settings.expressive.film_offsets.clear();
    for (const auto& row : event.rows("curvature_points", *offsets, 3)) {
      settings.expressive.film_offsets.push_back({{row[0], row[1]}, row[2]});
    }
  }
  constexpr Range factor{-1e6, 1e6, "a number from -1e6 to 1e6"};
  if (const Json* const dispersion = event.find("dispersion")) {
    const double value = event.number("dispersion", *dispersion, factor);
    settings.expressive.dispersion.clear();
    if (value != 1) settings.expressive.dispersion = {value};
  }
  event.set("from_lens", settings.from_lens, factor);
}

void lens(Event& event, const Context& context, EditorSettings& settings) {
  constexpr const char* rule = "a name, or an object with thin_mm and f_number";
  const Json& value = event.at("lens", rule);
  FocusLensChoice choice{.rgb = settings.choice.rgb};
  if (value.is_string()) {
    choice.name = value.get<std::string>();
    if (choice.name.empty()) event.refuse("lens", value, rule);
  } else if (value.is_object() && value.contains("thin_mm") && value.contains("f_number") && value.size() == 2) {
    choice.thin_mm = event.number("thin_mm", value["thin_mm"], positive);
    choice.f_number = event.number("f_number", value["f_number"], positive);
  } else {
    event.refuse("lens", value, rule);
  }
  settings.choice = choice;
  settings.f_number.reset();
  load_lens(context.scene, settings);
}

void colour(Event& event, const Context& context, EditorSettings& settings) {
  const bool before = settings.choice.rgb;
  event.set("rgb", settings.choice.rgb);
  if (settings.choice.rgb != before) load_lens(context.scene, settings);
}

void tilt(Event& event, const Context&, EditorSettings& settings) {
  constexpr Range angle{-largest_tilt_deg, largest_tilt_deg, "a number from -60 to 60"};
  double tilt = degrees(settings.tilt_rad), swing = degrees(settings.swing_rad);
  event.set("tilt_deg", tilt, angle);
  event.set("swing_deg", swing, angle);
  if (settings.serve != FocusServe::distance) by_distance(settings);
  settings.tilt_rad = radians(tilt), settings.swing_rad = radians(swing);
}

void weighting(Event& event, const Context&, EditorSettings& settings) {
  event.set("nearer", settings.nearer_weighs_more);
  event.set("fade", settings.points_fade);
  const double before = settings.fade_s;
  event.set("fade_s", settings.fade_s, not_negative);
  if (settings.fade_s == before) return;
  for (auto& point : settings.points) point.edit().fade = FadeFilter(settings.fade_s);
}

template <class T>
void put_key(Keys<T>& keys, double time, const T& value) {
  const auto at = std::ranges::lower_bound(keys, time, {}, &std::pair<double, T>::first);
  if (at != keys.end() && at->first == time) {
    at->second = value;
  } else {
    keys.insert(at, {time, value});
  }
}

constexpr Range times{-1e9, 1e9, "a number from -1e9 to 1e9"};

void set_time(EditorSettings& settings, double time) {
  settings.seconds_to_fade = std::abs(time - settings.time_s);
  settings.time_s = time;
}

void key(Event& event, const Context&, EditorSettings& settings) {
  double time = settings.time_s;
  event.set("time_s", time, times);
  for (auto& shared : settings.points) {
    EditorPoint& point = shared.edit();
    if (point.now.place) put_key(point.keys, time, point.now);
    point.by_hand = false;
  }
  put_key(settings.focus_keys, time, settings.focus_mm);
  settings.focus_by_hand = false;
  set_time(settings, time);
}

void time(Event& event, const Context&, EditorSettings& settings) {
  set_time(settings, event.number("time_s", event.at("time_s", times.words), times));
  for (auto& point : settings.points) {
    if (point->by_hand) point.edit().by_hand = false;
  }
  settings.focus_by_hand = false;
}

void still(Event&, const Context&, EditorSettings&) {}

struct Kind {
  const char* type;
  void (*apply)(Event&, const Context&, EditorSettings&);
};
constexpr Kind kinds[] = {{"add_point", add_point},
                          {"move_point", move_point},
                          {"set_point", set_point},
                          {"remove_point", remove_point},
                          {"serve", serve},
                          {"focus", focus},
                          {"f_number", set_f_number},
                          {"iris", iris},
                          {"bokeh", bokeh},
                          {"expressive", expressive},
                          {"lens", lens},
                          {"colour", colour},
                          {"tilt", tilt},
                          {"weighting", weighting},
                          {"key", key},
                          {"time", time},
                          {"still", still}};

}  // namespace

std::string type_of(const Json& event) {
  if (!event.is_object()) throw Error("event = " + shown(event) + "; must be a JSON object");
  const auto type = event.find("type");
  if (type == event.end() || !type->is_string()) {
    throw Error("event " + shown(event) + ": type is missing; must be a text");
  }
  return type->get<std::string>();
}

bool apply_event(const FocusScene& scene, const FocusEditorState& state, EditorSettings& settings, const Json& json) {
  Event event(json);
  const auto found = std::ranges::find_if(kinds, [&](const Kind& kind) { return event.type() == kind.type; });
  if (found == std::end(kinds)) {
    std::string known;
    for (const Kind& kind : kinds) known += std::string(kind.type) + ", ";
    event.refuse("type", event.type(), known + "undo or redo");
  }
  bool continues = false;
  event.set("continues", continues);
  found->apply(event, {scene, state}, settings);
  event.finish();
  return continues;
}

}  // namespace petzval::editor_detail
