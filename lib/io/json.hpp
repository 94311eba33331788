// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval::io_detail {

/// A JSON document as a tree that knows the position of each value. A value has a path ("surfaces[1].radius").
///
/// Bare Infinity, inf and NaN, with or without a sign, are read as strings.
class PETZVAL_API JsonTree {
 public:
  /// The name of a value in messages, from its path.
  using Words = std::string (*)(std::string_view path);

  /// Parses a text, which must outlive the tree. Numbers are read from their digits, independent of the locale.
  /// @param where  file name, for messages
  /// @throws Error, with line and column, if the text is not JSON, has a key twice in one object, a number out of
  ///         range, brackets deeper than 64 levels or more than 16 MiB (a tree takes many times the memory of its text)
  JsonTree(std::string_view text, std::string where, Words words);
  ~JsonTree();
  JsonTree(const JsonTree&) = delete;
  JsonTree& operator=(const JsonTree&) = delete;

  const nlohmann::json& root() const noexcept { return root_; }
  /// Throws Error: "lens.json:11:8: surface 1: message".
  /// @param key  path of a member whose key has the position; empty: the position of the value
  [[noreturn]] void fail(const std::string& path, const std::string& message, const std::string& key = {}) const;
  /// Throws Error: "lens.json:11:8: message", with the position of the value at a path.
  [[noreturn]] void fail_at(const std::string& path, const std::string& message) const;
  /// Throws Error: "lens.json:11:8: surface 1: radius = value; must be rule".
  [[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& rule) const;
  /// True if the value at a path is not in quotes in the text.
  bool is_bare(const std::string& path) const;

 private:
  JsonTree() = default;

  std::string_view text_;
  std::string where_;
  Words words_ = nullptr;
  nlohmann::json root_;
};

struct JsonField;

/// A value of a tree. Functions throw Error, with the position, if the value is of another kind.
class PETZVAL_API JsonPart {
 public:
  explicit JsonPart(const JsonTree& tree) : tree_(tree), json_(tree.root()) {}

  /// Integers: up to 2^53.
  double number(const char* rule = "a number") const;
  int whole_number(int least, int most) const;
  std::string text() const;
  const nlohmann::json& json() const noexcept { return json_; }

  // Stores the value. Numbers and strings that may be absent may be null.
  void get(double& to) const { to = number(); }
  void get(std::string& to) const { to = text(); }
  void get(bool& to) const;
  template <class T>
  void get(std::optional<T>& to) const {
    to.reset();
    if (!json_.is_null()) get(to.emplace());
  }
  /// Calls `read` for each entry of a list of at most 10,000 entries.
  void each(const std::function<void(const JsonPart&)>& read) const;
  /// Calls `read` for each member of an object, with its key.
  void each_member(const std::function<void(const std::string&, const JsonPart&)>& read) const;
  /// Reads the members of an object, in the order of `fields`. Then refuses unknown and missing keys.
  void read(const std::vector<JsonField>& fields) const;

  /// Throws Error: "lens.json:11:8: message", with the words of the path in front of the message.
  [[noreturn]] void fail(const std::string& message) const { tree_.fail(path_, message); }
  [[noreturn]] void refuse(const std::string& rule) const;
  /// Throws Error: "lens.json:11:8: message", with the position of an inner path.
  [[noreturn]] void fail_at(const std::string& path, const std::string& message) const {
    tree_.fail_at(path_ + (path_.empty() ? "" : ".") + path, message);
  }

 private:
  /// True for Infinity, inf and NaN without quotes.
  bool is_bare_word() const;
  JsonPart(const JsonPart& list, std::size_t index);
  JsonPart(const JsonPart& object, const std::string& key, const nlohmann::json& json);

  const JsonTree& tree_;
  const nlohmann::json& json_;
  std::string path_;
};

/// A key of an object, and where its value goes.
struct JsonField {
  template <class T>
    requires(!std::invocable<const T&, const JsonPart&>)
  JsonField(std::string_view key, T& to, bool needed = false)
      : name(key), set([&to](const JsonPart& part) { part.get(to); }), required(needed) {}
  template <std::invocable<const JsonPart&> Read>
  JsonField(std::string_view key, const Read& read, bool needed = false) : name(key), set(read), required(needed) {}

  std::string_view name;
  std::function<void(const JsonPart&)> set;
  bool required;
};
inline constexpr bool required = true;

/// Text in quotes for a message, shortened if it is long.
PETZVAL_API std::string in_quotes(std::string_view text);

/// The words of a path in messages: "surface 1: aspheric 0: order" for "surfaces[1].aspheric[0].order".
PETZVAL_API std::string words_of(std::string_view path);

/// Line and column (":11:8") of the value at a path in a JSON text, or of its key, for messages. If the text has no
/// such value, the result is the position of the nearest list or object on the path.
PETZVAL_API std::string json_position(std::string_view json, std::string path, bool key = false);

/// The shortest decimal number that is read back as the same double. It always has a decimal point, and no exponent
/// from 1e-4 to 1e16.
PETZVAL_API std::string json_number(double value);

/// A text in quotes, with escapes.
/// @throws Error if the text is not UTF-8
PETZVAL_API std::string json_text(const std::string& text);

}  // namespace petzval::io_detail
