// SPDX-License-Identifier: Apache-2.0
#include "focus_json.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>

#include "cli.hpp"
#include "files.hpp"
#include "petzval/core/error.hpp"

namespace examples {
namespace {

constexpr Range weight_range{0, std::numeric_limits<double>::max(), "a finite number, 0 or more"};

[[noreturn]] void refuse(const std::string& where, const Json& found, const std::string& wanted) {
  std::string text = found.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  throw petzval::Error(where + ": found " + text + ", wanted " + wanted);
}

/// The document. Refuses a repeated key, which would hide a value, and more levels than any format here has: printing
/// and comparing values takes a call for each.
Json parse(const std::filesystem::path& file) {
  constexpr int deepest = 8;
  const std::string text = read_text(file);
  std::vector<std::set<std::string>> open;
  const auto look = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > deepest) {
      throw petzval::Error(file.string() + ": found lists or objects nested more than " + std::to_string(deepest) +
                           " deep, wanted a list of points");
    }
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second) {
      throw petzval::Error(file.string() + ": found the key " + value.dump() + " twice in one object, wanted once");
    }
    return true;
  };
  try {
    return Json::parse(text, look);
  } catch (const Json::exception& error) {
    const std::string reason = error.what();
    const auto end = reason.find("] ");
    throw petzval::Error(file.string() + ": not JSON: " + (end == std::string::npos ? reason : reason.substr(end + 2)));
  }
}

/// An object of the file and its name in messages.
struct Entry {
  std::string where;
  const Json& json;

  void keys(std::initializer_list<std::string_view> known, const std::string& words) const {
    if (!json.is_object()) refuse(where, json, "an object with " + words);
    for (const auto& [key, value] : json.items()) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      throw petzval::Error(where + ": found the key " + Json(key).dump() + ", wanted " + words);
    }
  }

  const Json& at(const char* key, const std::string& wanted) const {
    if (!json.contains(key)) throw petzval::Error(where + ": " + key + ": found none, wanted " + wanted);
    return json.at(key);
  }

  double number(const char* key, double unless, const Range& range) const {
    if (!json.contains(key)) return unless;
    const Json& value = json.at(key);
    if (!value.is_number()) refuse(where + ": " + key, value, range.words);
    const auto x = value.get<double>();
    if (!(x >= range.least && x <= range.most)) refuse(where + ": " + key, value, range.words);
    return x;
  }

  petzval::ScenePoint place() const {
    const std::string wanted = "three finite numbers, [x, y, z]";
    const Json& value = at("position_mm", wanted);
    const auto finite = [](const Json& c) { return c.is_number() && std::isfinite(c.get<double>()); };
    if (!value.is_array() || value.size() != 3 || !std::all_of(value.begin(), value.end(), finite)) {
      refuse(where + ": position_mm", value, wanted);
    }
    petzval::ScenePoint result{{value[0], value[1], value[2]}, false};
    if (json.contains("at_infinity")) {
      if (!json["at_infinity"].is_boolean()) refuse(where + ": at_infinity", json["at_infinity"], "true or false");
      result.at_infinity = json["at_infinity"];
    }
    return result;
  }
};

/// Calls read(entry) for the elements of a list, named `name` and counted from 1.
template <class Read>
void for_entries(const std::string& where, const Json& list, const std::string& name, Read read) {
  if (!list.is_array() || list.empty()) refuse(where, list, "a list of one " + name + " or more");
  for (std::size_t i = 0; i < list.size(); ++i) read(Entry{where + ": " + name + " " + std::to_string(i + 1), list[i]});
}

}  // namespace

std::vector<petzval::FocusTarget> read_targets(const std::filesystem::path& file) {
  std::vector<petzval::FocusTarget> result;
  const Json document = parse(file);
  if (document == Json::array()) return result;
  for_entries(file.string(), document, "point", [&](const Entry& entry) {
    entry.keys({"position_mm", "weight", "blur_mm", "at_infinity"}, "position_mm, weight, blur_mm and at_infinity");
    result.push_back(
        {entry.place(), entry.number("blur_mm", 0, finite_number), entry.number("weight", 1, weight_range)});
  });
  return result;
}

std::vector<petzval::FocusPoint> read_focus_points(const std::filesystem::path& file) {
  std::vector<petzval::FocusPoint> result;
  const Json document = parse(file);
  for_entries(file.string(), document, "point", [&](const Entry& entry) {
    entry.keys({"from_s", "until_s", "keys"}, "from_s, until_s and keys");
    petzval::FocusPoint point;
    point.from = entry.number("from_s", point.from, finite_number);
    point.until = entry.number("until_s", point.until, finite_number);
    if (!(point.until >= point.from)) {
      refuse(entry.where + ": until_s", entry.json["until_s"], "a time not before from_s");
    }
    for_entries(entry.where + ": keys", entry.at("keys", "a list of keys"), "key", [&](const Entry& key) {
      key.keys({"time_s", "position_mm", "weight", "blur_mm", "at_infinity"},
               "time_s, position_mm, weight, blur_mm and at_infinity");
      key.at("time_s", finite_number.words);
      point.keys.push_back({key.number("time_s", 0, finite_number), key.place(),
                            key.number("blur_mm", 0, finite_number), key.number("weight", 1, weight_range)});
      if (point.keys.size() > 1 && !(point.keys.end()[-2].time < point.keys.back().time)) {
        refuse(key.where + ": time_s", key.json["time_s"], "a time after the previous key");
      }
    });
    result.push_back(std::move(point));
  });
  return result;
}

}  // namespace examples
