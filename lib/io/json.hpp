// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "petzval/core/export.hpp"

namespace petzval::io_detail {

/// A word in the position of a value that JSON does not know ("Infinity"), or a number beyond double.
struct JsonWord {
  std::string text;
};

/// A value that is not a list or an object.
using JsonValue = std::variant<std::nullptr_t, bool, double, std::string, JsonWord>;

/// The tokens of a JSON text for which the parser has events (values, keys and brackets), in their order. A parser that
/// calls `next` once an event knows the position of each.
class PETZVAL_API JsonTokens {
 public:
  explicit JsonTokens(std::string_view text);
  /// Moves to the next token. After the last token: to the end, or to text that the parser refuses.
  void next();
  std::size_t byte() const noexcept { return from_; }  ///< at which the token begins, from 0
  std::string_view token() const noexcept { return text_.substr(from_, to_ - from_); }
  std::string_view before() const noexcept { return before_; }  ///< the token before
  char separator() const noexcept { return separator_; }        ///< ',' or ':' in front of the token; 0 if none
  /// "11:8": line and column of a byte, both from 1. Columns count characters; lines end as in text_file.hpp.
  std::string line_and_column(std::size_t byte) const;

 private:
  std::string_view text_, before_;
  std::size_t from_ = 0, to_ = 0;
  char separator_ = 0;
};

/// The text in quotes for a message, shortened if it is long.
PETZVAL_API std::string in_quotes(std::string_view text);
/// The value for a message.
std::string describe(const JsonValue& value);

/// Builds a result while nlohmann's parser walks the text. Only the result is stored; whatever does not belong to the
/// format is refused with its line and column: `lens.json:11:8: surface 1: radius = "abc"; must be a number`.
class JsonReader {
 public:
  /// where: the file's name, for messages.
  explicit JsonReader(std::string where) : where_(std::move(where)) {}
  JsonReader(const JsonReader&) = delete;
  JsonReader& operator=(const JsonReader&) = delete;
  virtual ~JsonReader() = default;

  /// Throws Error for text that is not JSON, for integers beyond 2^53 and numbers out of range of double, and whatever
  /// the calls below throw. Numbers are read from their digits in every locale.
  void parse(std::string_view json);

  // The events, in the order of the text.
  virtual void key(const std::string& name) = 0;
  virtual void assign(JsonValue value) = 0;
  virtual void open(bool list) = 0;  ///< a list or an object
  virtual void close() = 0;
  /// The position in words: brackets and key ("surface 1: radius"); empty for the document as a whole.
  virtual std::string here() const = 0;
  /// Throws Error: "file:11:8: surface 1: radius = value; must be rule".
  [[noreturn]] void refuse(const std::string& value, const std::string& rule) const;

 protected:
  /// Throws Error for a list or an object in the position of something else, and the reverse.
  [[noreturn]] void refuse_kind(const std::string& kind, const std::string& rule) const;
  /// Throws Error: "file:11:8: surface 1: message", at the token that was read last or at a byte.
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

/// ":11:8", the line and column of a value in a JSON text by its path ("surfaces[1].radius"), for messages. If the text
/// has no such value: the position of the nearest list or object on its path. The text may have Infinity and NaN.
PETZVAL_API std::string json_position(std::string_view json, std::string path);

/// The shortest decimals that read back; without an exponent from 1e-4 to 1e16, and always with a point.
PETZVAL_API std::string json_number(double value);

/// A text in quotes, with escapes. Throws Error for one that is not UTF-8.
PETZVAL_API std::string json_text(const std::string& text);

}  // namespace petzval::io_detail
