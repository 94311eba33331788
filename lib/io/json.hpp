// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace petzval::inline v0::io_detail {

/// A value that is not a list or an object.
using JsonValue = std::variant<std::nullptr_t, bool, double, std::string>;

/// The text in quotes for a message, its end left out where it is long.
std::string in_quotes(std::string_view text);
/// The value for a message.
std::string describe(const JsonValue& value);

/// What a document becomes while nlohmann's parser walks its text: nothing but the result is stored, and what does not
/// belong there is refused where it stands.
class JsonReader {
 public:
  /// where: the file's name, for messages.
  explicit JsonReader(std::string where) : where_(std::move(where)) {}
  JsonReader(const JsonReader&) = delete;
  JsonReader& operator=(const JsonReader&) = delete;
  virtual ~JsonReader() = default;

  /// Throws Error with the byte where the text is no JSON, for integers beyond 2^53 and numbers beyond double, and what
  /// the calls below throw. Numbers are read from their digits, whatever the locale.
  void parse(std::string_view json);

  // What the text has, in its order.
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

/// A file's bytes; wanted: what it should be, for the message where it cannot be opened.
std::string read_text(const std::filesystem::path& file, const std::string& wanted);

/// Shortest decimals that read back; plain from 1e-4 to 1e16 and with a point always, so that a number looks like one.
std::string json_number(double value);

}  // namespace petzval::inline v0::io_detail
