// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "petzval/core/config.hpp"

namespace petzval::io_detail {

/// A word that stands for a value but is not JSON ("Infinity"), or a number outside the range of double.
struct JsonWord {
  std::string text;
};

/// A value other than a list or an object.
using JsonValue = std::variant<std::nullptr_t, bool, double, std::string, JsonWord>;

/// The tokens of a JSON text for which the parser has events (values, keys and brackets), in order. A class that calls
/// `next` once per event knows the position of each event.
class PETZVAL_API JsonTokens {
 public:
  explicit JsonTokens(std::string_view text);
  /// Moves to the next token; after the last token, to the end or to text that the parser refuses.
  void next();
  std::size_t byte() const noexcept { return from_; }  ///< offset of the token
  std::string_view token() const noexcept { return text_.substr(from_, to_ - from_); }
  std::string_view before() const noexcept { return before_; }  ///< previous token
  char separator() const noexcept { return separator_; }        ///< ',' or ':' in front of the token, or 0
  /// Line and column of a byte, both from 1: "11:8". Columns count characters; lines end as in text_file.hpp.
  std::string line_and_column(std::size_t byte) const;

 private:
  std::string_view text_, before_;
  std::size_t from_ = 0, to_ = 0;
  char separator_ = 0;
};

/// Text in quotes for a message, shortened if it is long.
PETZVAL_API std::string in_quotes(std::string_view text);
/// Text of a value for a message.
std::string describe(const JsonValue& value);

/// Builds a result while nlohmann's parser walks the text. Only the result is stored. Content that does not belong to
/// the format is refused with its line and column: `lens.json:11:8: surface 1: radius = "abc"; must be a number`.
class JsonReader {
 public:
  /// @param where file name, for messages
  explicit JsonReader(std::string where) : where_(std::move(where)) {}
  JsonReader(const JsonReader&) = delete;
  JsonReader& operator=(const JsonReader&) = delete;
  virtual ~JsonReader() = default;

  /// Parses a text. Numbers are read from their digits, independent of the locale.
  /// @throws Error if the text is not JSON, a number is out of range (integers: 2^53), or a call below throws
  void parse(std::string_view json);

  // The events, in the order of the text.
  virtual void key(const std::string& name) = 0;
  virtual void assign(JsonValue value) = 0;
  virtual void open(bool list) = 0;  ///< a list or an object
  virtual void close() = 0;
  /// The position as text, from brackets and keys ("surface 1: radius"); empty for the document itself.
  virtual std::string here() const = 0;
  /// Throws Error: "file:11:8: surface 1: radius = value; must be rule".
  [[noreturn]] void refuse(const std::string& value, const std::string& rule) const;

 protected:
  /// Throws Error because a list or an object stands in the position of another kind of value, or vice versa.
  [[noreturn]] void refuse_kind(const std::string& kind, const std::string& rule) const;
  /// Throws Error: "file:11:8: surface 1: message", at the last token or at a byte.
  [[noreturn]] void fail(const std::string& message) const { fail(byte(), message); }
  [[noreturn]] void fail(std::size_t byte, const std::string& message) const;
  std::size_t byte() const noexcept { return tokens_.byte(); }

  double number_of(const JsonValue& value) const;
  std::optional<double> maybe_number(const JsonValue& value) const;
  std::string text_of(const JsonValue& value) const;
  std::optional<std::string> maybe_text(const JsonValue& value) const;
  bool flag_of(const JsonValue& value) const;

  std::string where_;

 private:
  friend class JsonEvents;

  JsonTokens tokens_{{}};
};

/// Line and column (":11:8") of the value at a path ("surfaces[1].radius") in a JSON text, for messages. If the text
/// has no such value, the result is the position of the nearest list or object on the path. The text may contain
/// Infinity and NaN.
PETZVAL_API std::string json_position(std::string_view json, std::string path);

/// The shortest decimal number that is read back as the same double. It always has a decimal point, and no exponent
/// from 1e-4 to 1e16.
PETZVAL_API std::string json_number(double value);

/// A text in quotes, with escapes.
/// @throws Error if the text is not UTF-8
PETZVAL_API std::string json_text(const std::string& text);

}  // namespace petzval::io_detail
