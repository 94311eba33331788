// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// A JSON document of another program, as a tree. Python's Infinity, -Infinity and NaN are read as strings.
class JsonTree {
 public:
  /// Parses a text, which must outlive the tree.
  /// @throws Error, with line and column, if the text is not JSON, is nested deeper than 64 levels, or exceeds 16 MiB
  /// (a tree takes many times the memory of its text)
  JsonTree(std::string_view text, std::string where);
  ~JsonTree();
  JsonTree(const JsonTree&) = delete;
  JsonTree& operator=(const JsonTree&) = delete;

  const nlohmann::json& root() const noexcept { return root_; }
  /// Throws Error: "lens.json:11:8: file.a[1].radius = value; must be rule". If value is "missing": "... is missing;
  /// ...".
  [[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& rule) const;

 private:
  JsonTree() = default;

  std::string_view text_;
  std::string where_;
  nlohmann::json root_;
};

/// Text of a value for messages, shortened; strings in quotes.
std::string shown(const nlohmann::json& value);

/// One object of a tree and its path, for messages.
struct JsonObject {
  const nlohmann::json& json;
  std::string path;  ///< "file.surfaces[1]"
  Import& in;
  const JsonTree& tree;

  /// The member; null if it is absent.
  const nlohmann::json* find(const char* key) const;
  /// A number, which may be infinite; nullopt if it is absent.
  /// @throws Error if the member is not a number
  std::optional<double> number(const char* key) const;
  double needed(const char* key) const;
  std::string text(const char* key) const;  ///< empty if absent or null
  bool flag(const char* key) const;         ///< false if absent
  JsonObject object(const char* key) const;
  /// Warns of each key that is not `used` and has a value.
  void name_others(std::initializer_list<std::string_view> used) const;
  [[noreturn]] void refuse(const char* key, const std::string& value, const std::string& rule) const {
    tree.refuse(path + '.' + key, value, rule);
  }
};

}  // namespace petzval::formats_detail
