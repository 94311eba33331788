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

/// Throws petzval::Error: `where`, what was found there, cut if long, and what was wanted.
[[noreturn]] void refuse(const std::string& where, const Json& found, const std::string& wanted);

/// The document. Throws petzval::Error that names the file: if it is no JSON, for a repeated key, which would hide a
/// value, and for more than 8 levels, which no format here has: printing and comparing values takes a call for each.
Json read_json(const std::filesystem::path& file);

/// Throws petzval::Error unless `json` is an object with no other keys than these. words: the keys, for the message.
void check_keys(const std::string& where, const Json& json, std::initializer_list<std::string_view> known,
                const std::string& words);

/// An object of a file and its name in messages. What it has no key for is nothing; what is of another kind throws
/// petzval::Error.
struct JsonEntry {
  std::string where;
  const Json& json;

  void keys(std::initializer_list<std::string_view> known, const std::string& words) const {
    check_keys(where, json, known, words);
  }
  std::optional<double> number(const char* key, const Range& range) const;
  /// So many finite numbers. wanted: in words.
  template <std::size_t count>
  std::optional<std::array<double, count>> numbers(const char* key, const char* wanted) const {
    const std::vector<double> found = list(key, count, wanted);
    if (found.empty()) return {};
    std::array<double, count> result;
    for (std::size_t i = 0; i < count; ++i) result[i] = found[i];
    return result;
  }

 private:
  std::vector<double> list(const char* key, std::size_t count, const char* wanted) const;
};

}  // namespace examples
