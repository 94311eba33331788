// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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

/// @throws petzval::Error unless `json` is an object with no other keys than `known`. words: the keys, for the message
void check_keys(const std::string& where, const Json& json, std::initializer_list<std::string_view> known,
                const std::string& words);

/// The points of a file: a list, or an object with the list "points".
/// @throws petzval::Error  if the document is neither
Json points_of(const std::string& where, const Json& document);

/// An object of a file and its name in messages. Values are nullopt if the key is missing.
/// @throws petzval::Error if a value is of the wrong kind
struct JsonEntry {
  std::string where;
  const Json& json;

  void keys(std::initializer_list<std::string_view> known, const std::string& words) const {
    check_keys(where, json, known, words);
  }
  std::optional<double> number(const char* key, const Range& range) const;
  /// A list of `count` finite numbers. rule: the same in words, for messages.
  template <std::size_t count>
  std::optional<std::array<double, count>> numbers(const char* key, const char* rule) const {
    const std::vector<double> found = list(key, count, rule);
    if (found.empty()) return {};
    std::array<double, count> result;
    for (std::size_t i = 0; i < count; ++i) result[i] = found[i];
    return result;
  }

 private:
  std::vector<double> list(const char* key, std::size_t count, const char* rule) const;
};

}  // namespace examples
