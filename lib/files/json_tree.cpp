// SPDX-License-Identifier: Apache-2.0
#include "json_tree.hpp"

#include <algorithm>
#include <limits>

#include "io/json.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0::files_detail {
namespace {

constexpr std::size_t largest_text = std::size_t{16} << 20;
constexpr int deepest = 64;

/// Bare words that are no JSON, in quotes.
std::string with_quoted_numbers(std::string_view text) {
  std::string result;
  result.reserve(text.size() + text.size() / 16);
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_string) {
      if (text[i] == '\\' && i + 1 < text.size()) result.push_back(text[i++]);
      in_string = text[i] != '"';
    } else if (text[i] == '"') {
      in_string = true;
    } else {
      bool found = false;
      for (const std::string_view word : {"-Infinity", "Infinity", "NaN"}) {
        if (!text.substr(i).starts_with(word)) continue;
        result += '"' + std::string(word) + '"';
        i += word.size() - 1;
        found = true;
        break;
      }
      if (found) continue;
    }
    result.push_back(text[i]);
  }
  return result;
}

}  // namespace

nlohmann::json json_tree(std::string_view text, const std::string& where) {
  if (text.size() > largest_text) {
    throw Error(where + ": " + std::to_string(text.size()) + " bytes, wanted at most " + std::to_string(largest_text));
  }
  const auto shallow = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > deepest) throw Error(where + ": more than " + std::to_string(deepest) + " levels, wanted fewer");
    return true;
  };
  try {
    return nlohmann::json::parse(with_quoted_numbers(text), shallow);
  } catch (const nlohmann::json::parse_error& error) {
    throw Error(where + ": byte " + std::to_string(error.byte) + " is no JSON, wanted a lens");
  } catch (const nlohmann::json::exception&) {
    throw Error(where + ": a number is out of range, wanted finite numbers");
  }
}

const nlohmann::json* JsonObject::find(const char* key) const {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

void JsonObject::refuse(const char* key, const std::string& found, const std::string& wanted) const {
  in.refuse(0, path + '.' + key, found, wanted);
}

std::optional<double> JsonObject::number(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return {};
  if (value->is_number()) return value->get<double>();
  if (*value == "Infinity") return std::numeric_limits<double>::infinity();
  if (*value == "-Infinity") return -std::numeric_limits<double>::infinity();
  refuse(key, io_detail::in_quotes(value->dump()), "a number");
}

double JsonObject::needed(const char* key) const {
  if (const auto value = number(key)) return *value;
  refuse(key, "missing", "a number");
}

std::string JsonObject::text(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return {};
  if (!value->is_string()) refuse(key, io_detail::in_quotes(value->dump()), "a string");
  return value->get<std::string>();
}

bool JsonObject::flag(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return false;
  if (!value->is_boolean()) refuse(key, io_detail::in_quotes(value->dump()), "true or false");
  return value->get<bool>();
}

JsonObject JsonObject::object(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value || !value->is_object()) refuse(key, value ? io_detail::in_quotes(value->dump()) : "missing", "an object");
  return {*value, path + '.' + key, in};
}

void JsonObject::name_others(std::initializer_list<std::string_view> used) const {
  for (const auto& [key, value] : json.items()) {
    const bool says_nothing = value.is_null() || (value.is_structured() && value.empty()) || value == false;
    if (says_nothing || std::ranges::find(used, std::string_view(key)) != used.end()) continue;
    in.warn(0, path + '.' + key, "is not known and is left out");
  }
}

}  // namespace petzval::inline v0::files_detail
