// SPDX-License-Identifier: Apache-2.0
#include "json_input.hpp"

#include <algorithm>
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

void JsonEntry::keys(std::initializer_list<std::string_view> known, const std::string& given) const {
  std::string words = given;
  for (const std::string_view* key = known.begin(); given.empty() && key != known.end(); ++key) {
    words.append(key == known.begin() ? "" : key + 1 == known.end() ? " and " : ", ").append(*key);
  }
  if (!json.is_object()) refuse("an object with " + words);
  for (const auto& [key, value] : json.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw petzval::Error(where + ": unknown key " + Json(key).dump() + "; must be " + words);
  }
}

double JsonEntry::number(const Range& range) const {
  const bool within = json.is_number() && json.get<double>() >= range.least && json.get<double>() <= range.most;
  if (!within) refuse(range.words);
  return json.get<double>();
}

std::optional<double> JsonEntry::number(const char* key, const Range& range) const {
  if (!has(key)) return {};
  return JsonEntry{where + ": " + key, json.at(key)}.number(range);
}

std::vector<double> JsonEntry::list(std::size_t count, const Range& range, const std::string& rule) const {
  const auto within = [&](const Json& value) {
    return value.is_number() && value.get<double>() >= range.least && value.get<double>() <= range.most;
  };
  if (!json.is_array() || json.size() != count || !std::all_of(json.begin(), json.end(), within)) refuse(rule);
  return json.get<std::vector<double>>();
}

bool JsonEntry::flag(const char* key, bool unless) const {
  if (!has(key)) return unless;
  if (!json.at(key).is_boolean()) refuse(key, "true or false");
  return json.at(key);
}

}  // namespace examples
