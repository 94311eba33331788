// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "editor_settings.hpp"
#include "focus/targets.hpp"
#include "io/json_members.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::editor_detail {

using namespace io_detail;
using nlohmann::json;

template <Is<PointValues> S, class Of>
void members(S& values, const Of& of) {
  constexpr Range stops{-focus_detail::largest_extent, focus_detail::largest_extent, "a number from -20 to 20"};
  of("weight", values.weight, not_negative), of("blur_px", values.blur_px);
  of("extent_stops", values.extent_stops, stops);
}

namespace {

constexpr Range times{-1e9, 1e9, "a number from -1e9 to 1e9"};

/// An event, and the settings that it changes.
struct Event {
  const JsonPart& part;
  const FocusScene& scene;
  const FocusEditorState& state;  ///< before the event
  EditorSettings& settings;
  bool continues = false;

  /// Reads the keys of the event. Refuses all others.
  void read(std::vector<JsonField> fields) {
    fields.emplace_back("type", [](const JsonPart&) {});
    fields.emplace_back("continues", continues);
    part.read(fields);
  }
};

JsonField number(std::string_view key, double& to, const Range& range, bool needed = false) {
  return {key, [&to, range](const JsonPart& part) { read_value(part, to, range); }, needed};
}

/// Reads a list of as many numbers as there are ranges.
void read_numbers(const JsonPart& part, std::vector<double>& to, std::initializer_list<Range> ranges) {
  if (part.json().size() != ranges.size()) part.refuse("a list of " + std::to_string(ranges.size()) + " numbers");
  const Range* range = ranges.begin();
  part.each([&](const JsonPart& entry) { read_value(entry, to.emplace_back(), *range++); });
}

void read_id(const JsonPart& part, EditorPoint& point) {
  point.id_is_number = part.json().is_number_integer();
  point.id = point.id_is_number ? part.json().dump() : part.json().is_string() ? part.text() : "";
  if (point.id.empty()) part.refuse("a text or a whole number");
}

auto find_point(EditorSettings& settings, const std::string& id) {
  return std::ranges::find_if(settings.points, [&](const Shared<EditorPoint>& point) { return point->id == id; });
}

/// The key "id" of a point that exists.
JsonField id_of_point(EditorSettings& settings, EditorPoint*& found) {
  const auto read = [&](const JsonPart& part) {
    EditorPoint given;
    read_id(part, given);
    const auto at = find_point(settings, given.id);
    if (at != settings.points.end()) return void(found = &at->edit());
    std::string known;
    for (const auto& point : settings.points) known += (known.empty() ? ": " : ", ") + point->id;
    part.refuse("the id of a point" + (known.empty() ? ", but no point exists" : known));
  };
  return {"id", read, required};
}

/// The keys of the place of a point: a pixel, or a position in the scene.
struct PlaceKeys {
  std::vector<double> pixel, position;
  bool at_infinity = false;

  void add_to(std::vector<JsonField>& fields, const FocusScene& scene) {
    fields.emplace_back("pixel", [this, &scene](const JsonPart& part) {
      const auto upto = [](int most) { return "a number from 0 to " + std::to_string(most); };
      const std::string columns = upto(scene.columns), rows = upto(scene.rows);
      read_numbers(part, pixel, {{0, 1. * scene.columns, columns.c_str()}, {0, 1. * scene.rows, rows.c_str()}});
      if (!scene.place) part.fail("must be left out: the scene has no depths");
    });
    fields.emplace_back("position_mm", [this](const JsonPart& part) {
      read_numbers(part, position, {any_number, any_number, any_number});
    });
    fields.emplace_back("at_infinity", at_infinity);
  }
};

std::optional<FocusPlace> place_of(const Event& event, const PlaceKeys& keys) {
  const std::vector<double>&pixel = keys.pixel, &at = keys.position;
  if (pixel.empty() == at.empty()) {
    event.part.fail(std::string("has ") + (pixel.empty() ? "neither of" : "both of") +
                    " pixel and position_mm; must have either pixel or position_mm");
  }
  if (!at.empty()) {
    if (keys.at_infinity && at == std::vector<double>(3, 0)) {
      event.part.fail_at("position_mm", "position_mm = 0, 0, 0; must be a direction, not 0, with at_infinity");
    }
    return FocusPlace{.point = {{at[0], at[1], at[2]}, keys.at_infinity}};
  }
  if (keys.at_infinity) event.part.fail_at("at_infinity", "at_infinity = true; must be left out with pixel");
  const FocusEditorState& state = event.state;
  // The chief ray: the middle of the pupil.
  const CameraRay chief =
      state.camera().sample({.film = state.setup.film.point(pixel[0], pixel[1]), .pupil_u = 0, .pupil_v = 0});
  if (!chief) return {};
  const double entrance_z = pupils(state.lens).entrance.z;
  const Vec3<double> origin = to_scene(event.scene, entrance_z, chief.ray.origin);
  const Vec3<double> along = to_scene(event.scene, entrance_z, chief.ray.origin + chief.ray.direction) - origin;
  return event.scene.place({origin, along}, event.settings.time_s);
}

void add_point(Event& event) {
  EditorSettings& settings = event.settings;
  EditorPoint point;
  PlaceKeys keys;
  const auto taken = [&] { return find_point(settings, point.id) != settings.points.end(); };
  std::vector<JsonField> fields{{"id", [&](const JsonPart& part) {
                                   read_id(part, point);
                                   if (taken()) part.refuse("an unused id");
                                 }}};
  keys.add_to(fields, event.scene), members(point.now, MemberReader{fields});
  event.read(fields);
  while (point.id.empty() || taken()) point.id = std::to_string(++settings.points_added);
  point.now.place = place_of(event, keys);
  settings.active = point.id;
  settings.points.emplace_back(std::move(point));
}

void move_point(Event& event) {
  EditorPoint* point = nullptr;
  PlaceKeys keys;
  std::vector<JsonField> fields{id_of_point(event.settings, point)};
  keys.add_to(fields, event.scene);
  event.read(fields);
  point->now.place = place_of(event, keys);
  point->by_hand = true;
  point->fade.reset();
  event.settings.active = point->id;
}

void set_point(Event& event) {
  EditorPoint* point = nullptr;
  PointValues values;
  const JsonField id = id_of_point(event.settings, point);
  std::vector<JsonField> fields{{"id", [&](const JsonPart& part) { id.set(part), values = point->now; }, required}};
  members(values, MemberReader{fields});
  event.read(fields);
  point->now = values;
  point->by_hand = true;
}

void remove_point(Event& event) {
  EditorSettings& settings = event.settings;
  EditorPoint* point = nullptr;
  event.read({id_of_point(settings, point)});
  if (settings.active == point->id) settings.active.clear();
  settings.points.erase(find_point(settings, std::string(point->id)));
}

void serve(Event& event) {
  constexpr std::array all{FocusServe::distance, FocusServe::film, FocusServe::tilt, FocusServe::surface};
  EditorSettings& settings = event.settings;
  event.read({{"by", [&](const JsonPart& part) { read_value(part, settings.serve, all); }, required}});
  if (settings.serve != FocusServe::distance) settings.setup.film = {};
}

/// Reads a merge patch of the set-up. Returns the patch.
json read_patch(const JsonPart& part, CameraSetup& setup) {
  const auto json_of = [](const CameraSetup& of) { return json::parse(to_json(of)); };
  json merged = json_of(setup);
  merged.merge_patch(part.json());
  CameraSetup read;
  try {
    read = camera_setup(merged.dump(), "");
  } catch (const Error& error) {
    const std::string message = error.what();  // begins with a position in `merged`
    part.fail(message.substr(message.find(": ") + 2));
  }
  setup = settable(read);
  const json unused = json::diff(json_of(setup), json_of(read));
  if (!unused.empty()) {
    std::string key = unused[0].at("path").get<std::string>().substr(1);
    std::ranges::replace(key, '/', '.');
    part.fail(key + " = " + unused[0].value("value", json()).dump() + "; must be left out: the editor sets it");
  }
  for (const double angle : {setup.film.tilt_rad, setup.film.swing_rad}) {
    if (std::abs(angle) <= radians(60)) continue;
    part.fail("film: tilt_rad, swing_rad = " + json(angle).dump() + "; must be from -pi/3 to pi/3");
  }
  return part.json();
}

void set_up(Event& event) {
  EditorSettings& settings = event.settings;
  json patch;
  event.read({{"setup", [&](const JsonPart& part) { patch = read_patch(part, settings.setup); }, required}});
  const bool thin = settings.setup.lens.thin_mm > 0;
  if (patch.contains("lens") || (thin && patch.contains("f_number"))) {
    settings.wide_open = event.scene.lens(settings.setup);
  }
  if (patch.contains("focus_mm")) with_focus(shaped_lens(settings), settings.focus_mm(), focus_options(settings.setup));
  if (patch.contains("focus_mm") || (patch.contains("film") && settings.serve != FocusServe::distance)) {
    settings.serve = FocusServe::distance;
    settings.active.clear();
    settings.focus_by_hand = true;
  }
}

void expressive(Event& event) {
  event.read({number("from_lens", event.settings.from_lens, {-1e6, 1e6, "a number from -1e6 to 1e6"}, required)});
}

void weighting(Event& event) {
  EditorSettings& settings = event.settings;
  const double before = settings.fade_s;
  event.read({{"nearer", settings.nearer_weighs_more},
              {"fade", settings.points_fade},
              number("fade_s", settings.fade_s, not_negative)});
  if (settings.fade_s == before) return;
  for (auto& point : settings.points) point.edit().fade.reset();
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

void set_time(EditorSettings& settings, double time) {
  settings.seconds_to_fade = std::abs(time - settings.time_s);
  settings.time_s = time;
  settings.focus_by_hand = false;
}

void key(Event& event) {
  EditorSettings& settings = event.settings;
  double time = settings.time_s;
  event.read({number("time_s", time, times)});
  for (auto& shared : settings.points) {
    EditorPoint& point = shared.edit();
    if (point.now.place) put_key(point.keys, time, point.now);
    point.by_hand = false;
  }
  put_key(settings.focus_keys, time, settings.focus_mm());
  set_time(settings, time);
}

void time(Event& event) {
  double time = 0;
  event.read({number("time_s", time, times, required)});
  set_time(event.settings, time);
  for (auto& point : event.settings.points) {
    if (point->by_hand) point.edit().by_hand = false;
  }
}

void no_keys(Event& event) { event.read({}); }

struct Kind {
  std::string_view type;
  void (*apply)(Event&);
};
constexpr Kind kinds[] = {{"add_point", add_point},
                          {"move_point", move_point},
                          {"set_point", set_point},
                          {"remove_point", remove_point},
                          {"serve", serve},
                          {"setup", set_up},
                          {"expressive", expressive},
                          {"weighting", weighting},
                          {"key", key},
                          {"time", time},
                          {"still", no_keys},
                          {"undo", no_keys},
                          {"redo", no_keys}};

/// @throws Error unless the event is an object with the type of a kind
const Kind& kind_of(std::string_view event) {
  const JsonTree tree(event, "event", words_of);
  const Kind* found = nullptr;
  const JsonPart whole(tree);
  whole.each_member([&](const std::string& name, const JsonPart& part) {
    if (name != "type") return;
    found = std::ranges::find(kinds, part.text(), &Kind::type);
    if (found != std::end(kinds)) return;
    std::string known;
    for (const Kind& kind : kinds) known += (known.empty() ? "" : ", ") + std::string(kind.type);
    part.refuse("one of " + known);
  });
  if (!found) whole.fail("key \"type\" is missing");
  return *found;
}

}  // namespace

CameraSetup settable(const CameraSetup& setup) {
  CameraSetup result{.lens = setup.lens,
                     .f_number = setup.f_number,
                     .iris = setup.iris,
                     .focus_mm = setup.focus_mm,
                     .film = {.tilt_rad = setup.film.tilt_rad, .swing_rad = setup.film.swing_rad},
                     .camera = {.bokeh = setup.camera.bokeh, .expressive = setup.camera.expressive},
                     .focal_surface = {.kind = setup.focal_surface.kind, .beta = setup.focal_surface.beta}};
  result.camera.bokeh.blades = 0;
  return result;
}

std::pair<std::string_view, bool> apply_event(const FocusScene& scene, const FocusEditorState& state,
                                              EditorSettings& settings, std::string_view text) {
  const Kind& kind = kind_of(text);
  const JsonTree tree(text, std::string(kind.type), words_of);
  const JsonPart part(tree);
  Event event{part, scene, state, settings};
  kind.apply(event);
  return {kind.type, event.continues};
}

}  // namespace petzval::editor_detail
