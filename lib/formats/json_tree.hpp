// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "import.hpp"

namespace petzval::formats_detail {

/// A JSON document of another program, as a tree: Infinity, -Infinity and NaN, which Python writes, are read too, as
/// strings of these names.
class JsonTree {
 public:
  /// Throws Error with line and column for text that is no JSON, for nesting deeper than 64, and for more than 16 MiB:
  /// a tree takes many times the memory of its text. The text must outlive the tree.
  JsonTree(std::string_view text, std::string where);
  ~JsonTree();
  JsonTree(const JsonTree&) = delete;
  JsonTree& operator=(const JsonTree&) = delete;

  const nlohmann::json& root() const noexcept { return root_; }
  /// Throws Error: "lens.json:11:8: file.a[1].radius = value; must be rule". value "missing": "... is missing; ...".
  [[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& rule) const;

 private:
  JsonTree() = default;

  std::string_view text_;
  std::string where_;
  nlohmann::json root_;
};

/// A value as messages show it, shortened: strings in quotes.
std::string shown(const nlohmann::json& value);

/// One object of a tree, and where it stands, for messages.
struct JsonObject {
  const nlohmann::json& json;
  std::string path;  ///< "file.surfaces[1]"
  Import& in;
  const JsonTree& tree;

  /// The member, or null.
  const nlohmann::json* find(const char* key) const;
  /// A number, which may be infinite; refuses anything else. Without it: nothing.
  std::optional<double> number(const char* key) const;
  double needed(const char* key) const;
  std::string text(const char* key) const;  ///< empty where it is absent or null
  bool flag(const char* key) const;         ///< false where it is absent
  JsonObject object(const char* key) const;
  /// Names each key that is neither `used` nor `silent` in a warning.
  void name_others(std::initializer_list<std::string_view> used) const;
  [[noreturn]] void refuse(const char* key, const std::string& value, const std::string& rule) const {
    tree.refuse(path + '.' + key, value, rule);
  }
};

}  // namespace petzval::formats_detail
