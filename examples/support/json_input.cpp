// SPDX-License-Identifier: Apache-2.0
#include "json_input.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "petzval/core/error.hpp"

namespace examples {

void refuse(const std::string& where, const Json& found, const std::string& rule) {
  std::string text = found.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  throw petzval::Error(where + " = " + text + "; must be " + rule);
}

Json read_json(const std::filesystem::path& file) {
  constexpr int max_depth = 8;
  const std::string text = read_text(file, largest_json);
  std::vector<std::set<std::string>> open;
  const auto look = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > max_depth) {
      throw petzval::Error(file.string() + ": lists and objects must not be nested more than " +
                           std::to_string(max_depth) + " levels deep");
    }
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second) {
      throw petzval::Error(file.string() + ": key " + value.dump() + " occurs twice in one object");
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

void check_keys(const std::string& where, const Json& json, std::initializer_list<std::string_view> known,
                const std::string& words) {
  if (!json.is_object()) refuse(where, json, "an object with " + words);
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw petzval::Error(where + ": unknown key " + Json(key).dump() + "; must be " + words);
  }
}

std::optional<double> JsonEntry::number(const char* key, const Range& range) const {
  if (!json.contains(key)) return {};
  const Json& value = json.at(key);
  const bool within = value.is_number() && value.get<double>() >= range.least && value.get<double>() <= range.most;
  if (!within) refuse(where + ": " + key, value, range.words);
  return value.get<double>();
}

std::vector<double> JsonEntry::list(const char* key, std::size_t count, const char* rule) const {
  if (!json.contains(key)) return {};
  const Json& value = json.at(key);
  const auto finite = [](const Json& c) { return c.is_number() && std::isfinite(c.get<double>()); };
  if (!value.is_array() || value.size() != count || !std::all_of(value.begin(), value.end(), finite)) {
    refuse(where + ": " + key, value, rule);
  }
  return value.get<std::vector<double>>();
}

Json points_of(const std::string& where, const Json& document) {
  if (document.is_array()) return document;
  if (document.is_object() && document.contains("keys")) {
    throw petzval::Error(where + ": has distances over time; must be given as --focus " + where);
  }
  check_keys(where, document, {"points"}, "points, or a list");
  if (!document.contains("points") || !document["points"].is_array()) {
    refuse(where + ": points", document.contains("points") ? document["points"] : Json(), "a list of points");
  }
  return document["points"];
}

}  // namespace examples
