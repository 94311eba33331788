// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import.hpp"
#include "io/json.hpp"

namespace petzval::formats_detail {

/// The name of a value in messages: "file.surfaces[1]" for the path "surfaces[1]".
std::string words_of_path(std::string_view path);

/// Text of a value for messages, shortened; strings in quotes.
std::string shown(const nlohmann::json& value);

/// One object of a tree and its path, for messages.
struct JsonObject {
  const nlohmann::json& json;
  std::string path;  ///< "file.surfaces[1]", or "key.surfaces[1]" in a database
  Import& in;
  const io_detail::JsonTree& tree;

  /// The member; null if it is absent.
  const nlohmann::json* find(const char* key) const;
  /// A number, which may be infinite; nullopt if it is absent.
  /// @throws Error if the member is not a number
  std::optional<double> number(const char* key) const;
  double needed(const char* key) const;
  std::string text(const char* key) const;  ///< empty if absent or null
  bool flag(const char* key) const;         ///< false if absent
  JsonObject object(const char* key) const;
  const nlohmann::json& list(const char* key) const;
  JsonObject entry(const char* list, std::size_t i) const;  ///< an object of a list
  /// A list of aspheric coefficients of orders first, first + step, ..., without the zeros; empty if absent.
  std::vector<AsphereTerm> terms(const char* key, int first, int step) const;
  /// Warns of each key that is not `used` and has a value.
  void name_others(std::initializer_list<std::string_view> used) const;
  [[noreturn]] void refuse(const char* key, const std::string& value, const std::string& rule) const;
  /// An object of a list of this object, at a path "key[i]".
  JsonObject entry(const std::string& at, const nlohmann::json& value) const;
};

}  // namespace petzval::formats_detail
