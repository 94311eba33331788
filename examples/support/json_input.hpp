// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli.hpp"
#include "files.hpp"

namespace examples {

/// @throws petzval::Error  "`where` = `found`; must be `rule`"; a long value is cut
[[noreturn]] void refuse(const std::string& where, const Json& found, const std::string& rule);

/// Reads a document.
/// @throws petzval::Error  that names the file, if it is not JSON, repeats a key (which would hide a value) or has more
///         than 8 levels (no format here needs more, and values are printed and compared recursively)
Json read_json(const std::filesystem::path& file);

/// A value of a file and its name in messages. Values of keys are nullopt if the key is missing.
/// @throws petzval::Error if a value is of the wrong kind
struct JsonEntry {
  std::string where;
  const Json& json;

  [[noreturn]] void refuse(const std::string& rule) const { examples::refuse(where, json, rule); }
  [[noreturn]] void refuse(const char* key, const std::string& rule) const {
    examples::refuse(where + ": " + key, json.value(key, Json()), rule);
  }
  /// Refuses other values than objects, and unknown keys. words: the keys, for the message; empty: `known`
  void keys(std::initializer_list<std::string_view> known, const std::string& words = {}) const;
  bool has(const char* key) const { return json.is_object() && json.contains(key); }

  double number(const Range& range) const;
  std::optional<double> number(const char* key, const Range& range) const;
  bool flag(const char* key, bool unless) const;
  /// A list of numbers. rule: the same in words, for messages.
  std::vector<double> list(std::size_t count, const Range& range, const std::string& rule) const;
  /// A list of `count` finite numbers; empty if the key is missing.
  std::vector<double> numbers(const char* key, std::size_t count, const char* rule) const {
    if (!has(key)) return {};
    return JsonEntry{where + ": " + key, json.at(key)}.list(count, finite_number, rule);
  }
};

}  // namespace examples
