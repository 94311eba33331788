// SPDX-License-Identifier: Apache-2.0
#include "focus_json.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "cli.hpp"
#include "json_input.hpp"
#include "petzval/core/error.hpp"

namespace examples {
namespace {

constexpr Range extent_range{-20, 20, "a number of stops from -20 to 20"};
constexpr Range weight_range{0, std::numeric_limits<double>::max(), "a finite number, 0 or more"};

/// The JSON of a target, a point or a key.
struct Entry : JsonEntry {
  const Json& at(const char* key, const std::string& rule) const {
    if (!has(key)) throw petzval::Error(where + ": " + key + " is missing; must be " + rule);
    return json.at(key);
  }
  bool flag(const char* key, bool unless) const {
    if (!has(key)) return unless;
    if (!json.at(key).is_boolean()) refuse(key, "true or false");
    return json.at(key);
  }
  std::optional<double> extent() const { return number("extent_stops", extent_range); }
  petzval::ScenePoint scene_point() const {
    constexpr const char* rule = "three finite numbers, [x, y, z]";
    const char* key = has("world_mm") ? "world_mm" : "position_mm";
    if (has("world_mm") && has("position_mm")) {
      throw petzval::Error(where + ": has both of world_mm and position_mm; must have one of them");
    }
    at(key, rule);
    const auto [x, y, z] = *numbers<3>(key, rule);
    return {{x, y, z}, flag("at_infinity", false)};
  }
};

/// Calls read(entry) for the elements of a list, named `name` and counted from 1.
template <class Read>
void for_entries(const std::string& where, const Json& list, const std::string& name, Read read) {
  if (!list.is_array() || list.empty()) refuse(where, list, "a list of one or more " + name + "s");
  for (std::size_t i = 0; i < list.size(); ++i)
    read(Entry{{where + ": " + name + " " + std::to_string(i + 1), list[i]}});
}

}  // namespace

std::vector<petzval::FocusTarget> read_targets(const std::filesystem::path& file) {
  std::vector<petzval::FocusTarget> result;
  const Json document = points_of(file.string(), read_json(file));
  if (document == Json::array()) return result;
  for_entries(file.string(), document, "point", [&](const Entry& entry) {
    entry.keys({"position_mm", "world_mm", "weight", "blur_mm", "at_infinity", "extent_stops", "fixes_distance"});
    result.push_back({entry.scene_point(), entry.number("blur_mm", finite_number).value_or(0),
                      entry.number("weight", weight_range).value_or(1), entry.extent(),
                      entry.flag("fixes_distance", true)});
  });
  return result;
}

std::vector<petzval::FocusPoint> read_focus_points(const std::filesystem::path& file) {
  std::vector<petzval::FocusPoint> result;
  const Json document = points_of(file.string(), read_json(file));
  for_entries(file.string(), document, "point", [&](const Entry& entry) {
    entry.keys({"from_s", "until_s", "keys", "fixes_distance"});
    petzval::FocusPoint point;
    point.fixes_distance = entry.flag("fixes_distance", true);
    point.from = entry.number("from_s", finite_number).value_or(point.from);
    point.until = entry.number("until_s", finite_number).value_or(point.until);
    if (!(point.until >= point.from)) entry.refuse("until_s", "a time not before from_s");
    for_entries(entry.where + ": keys", entry.at("keys", "a list of keys"), "key", [&](const Entry& key) {
      key.keys({"time_s", "position_mm", "world_mm", "weight", "blur_mm", "at_infinity", "extent_stops"});
      key.at("time_s", finite_number.words);
      point.keys.push_back({*key.number("time_s", finite_number), key.scene_point(),
                            key.number("blur_mm", finite_number).value_or(0),
                            key.number("weight", weight_range).value_or(1), key.extent()});
      if (point.keys.back().extent_stops.has_value() != point.keys.front().extent_stops.has_value()) {
        throw petzval::Error(key.where + ": extent_stops must be given in all keys of the point or in no key");
      }
      if (point.keys.size() > 1 && !(point.keys.end()[-2].time < point.keys.back().time)) {
        key.refuse("time_s", "a time after the previous key");
      }
    });
    result.push_back(std::move(point));
  });
  return result;
}

}  // namespace examples
