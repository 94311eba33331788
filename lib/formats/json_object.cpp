// SPDX-License-Identifier: Apache-2.0
#include "json_object.hpp"

#include <algorithm>
#include <limits>

#include "core/text.hpp"

namespace petzval::formats_detail {

std::string words_of_path(std::string_view path) { return path.empty() ? "file" : "file." + std::string(path); }

std::string shown(const nlohmann::json& value) {
  const auto* word = value.get_ptr<const std::string*>();
  if (word) return io_detail::in_quotes(*word);
  const std::string text = value.dump();
  constexpr std::size_t max_quoted_size = 60;
  return text.size() <= max_quoted_size ? text : std::string(beginning(text, max_quoted_size)) + "...";
}

const nlohmann::json* JsonObject::find(const char* key) const {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

std::optional<double> JsonObject::number(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return {};
  if (value->is_number()) return value->get<double>();
  if (const auto* word = value->get_ptr<const std::string*>()) {
    if (*word == "Infinity") return std::numeric_limits<double>::infinity();
    if (*word == "-Infinity") return -std::numeric_limits<double>::infinity();
  }
  refuse(key, shown(*value), "a number");
}

double JsonObject::needed(const char* key) const {
  if (const auto value = number(key)) return *value;
  refuse(key, "missing", "a number");
}

std::string JsonObject::text(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return {};
  if (!value->is_string()) refuse(key, shown(*value), "a string");
  return value->get<std::string>();
}

bool JsonObject::flag(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return false;
  if (!value->is_boolean()) refuse(key, shown(*value), "true or false");
  return value->get<bool>();
}

void JsonObject::refuse(const char* key, const std::string& value, const std::string& rule) const {
  const std::string in_document = path + '.' + key;
  tree.refuse(in_document.starts_with("file.") ? in_document.substr(5) : in_document, value, rule);
}

JsonObject JsonObject::entry(const std::string& at, const nlohmann::json& value) const {
  if (!value.is_object()) refuse(at.c_str(), shown(value), "an object");
  return {value, path + '.' + at, in, tree};
}

JsonObject JsonObject::object(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value || !value->is_object()) refuse(key, value ? shown(*value) : "missing", "an object");
  return {*value, path + '.' + key, in, tree};
}

const nlohmann::json& JsonObject::list(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value || !value->is_array()) refuse(key, value ? "no list" : "missing", "a list");
  return *value;
}

JsonObject JsonObject::entry(const char* list, std::size_t i) const {
  return entry(std::string(list) + '[' + std::to_string(i) + ']', json.at(list).at(i));
}

std::vector<AsphereTerm> JsonObject::terms(const char* key, int first, int step) const {
  std::vector<AsphereTerm> result;
  if (!find(key)) return result;
  int order = first - step;
  for (const nlohmann::json& value : list(key)) {
    if (!value.is_number()) refuse(key, shown(value), "numbers");
    const double coefficient = value.get<double>();
    order += step;
    if (coefficient == 0) continue;
    if (order < 2 || order > 40) {
      refuse(key, to_text(coefficient) + " of order " + std::to_string(order), "of order 2 to 40");
    }
    result.push_back({order, coefficient});
  }
  return result;
}

void JsonObject::name_others(std::initializer_list<std::string_view> used) const {
  for (const auto& [key, value] : json.items()) {
    const bool says_nothing = value.is_null() || (value.is_structured() && value.empty()) || value == false;
    if (says_nothing || std::ranges::find(used, std::string_view(key)) != used.end()) continue;
    in.warn(0, path + '.' + key, "is not known and is left out");
  }
}

}  // namespace petzval::formats_detail
