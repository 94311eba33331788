// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace petzval::inline v0::io_detail {

/// A value that is not a list or an object.
using JsonValue = std::variant<std::nullptr_t, bool, double, std::string>;

/// The text in quotes for a message, shortened if it is long.
std::string in_quotes(std::string_view text);
/// The value for a message.
std::string describe(const JsonValue& value);

/// Builds a result while nlohmann's parser walks the text. Only the result is stored; whatever does not belong to the
/// format is refused at its place.
class JsonReader {
 public:
  /// where: the file's name, for messages.
  explicit JsonReader(std::string where) : where_(std::move(where)) {}
  JsonReader(const JsonReader&) = delete;
  JsonReader& operator=(const JsonReader&) = delete;
  virtual ~JsonReader() = default;

  /// Throws Error for text that is not JSON (with the byte), for integers beyond 2^53 and numbers out of range of
  /// double, and whatever the calls below throw. Numbers are read from their digits in every locale.
  void parse(std::string_view json);

  // The events, in the order of the text.
  virtual void key(const std::string& name) = 0;
  virtual void assign(JsonValue value) = 0;
  virtual void open(bool list) = 0;  ///< a list or an object
  virtual void close() = 0;
  /// The place in words: file, brackets and key.
  virtual std::string here() const = 0;
  [[noreturn]] void refuse(const std::string& found, const std::string& wanted) const;

 protected:
  double number_of(const JsonValue& value) const;
  std::optional<double> maybe_number(const JsonValue& value) const;
  std::string text_of(const JsonValue& value) const;
  std::optional<std::string> maybe_text(const JsonValue& value) const;
  bool flag_of(const JsonValue& value) const;

  std::string where_;
};

/// The shortest decimals that read back; without an exponent from 1e-4 to 1e16, and always with a point.
std::string json_number(double value);

/// A text in quotes, with escapes. Throws Error for one that is not UTF-8.
std::string json_text(const std::string& text);

}  // namespace petzval::inline v0::io_detail
