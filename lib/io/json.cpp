// SPDX-License-Identifier: Apache-2.0
#include "json.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0::io_detail {
namespace {

constexpr std::int64_t largest_integer = std::int64_t{1} << 53;  // beyond it not every integer is a double
constexpr const char* wanted_integer = "an integer up to 2^53";

/// Strings of a document have any length; messages must not.
std::string shortened(std::string_view text, std::size_t longest = 60) {
  if (text.size() <= longest) return std::string(text);
  return std::string(beginning(text, longest)) + "...";
}

/// Receives the events of nlohmann's parser.
class Sax {
 public:
  Sax(JsonReader& reader, const std::string& where) : reader_(reader), where_(where) {}

  bool null() { return assign(nullptr); }
  bool boolean(bool flag) { return assign(flag); }
  bool number_integer(std::int64_t n) {
    if (n < -largest_integer || n > largest_integer) reader_.refuse(std::to_string(n), wanted_integer);
    return assign(static_cast<double>(n));
  }
  bool number_unsigned(std::uint64_t n) {
    if (n > static_cast<std::uint64_t>(largest_integer)) reader_.refuse(std::to_string(n), wanted_integer);
    return assign(static_cast<double>(n));
  }
  bool number_float(double, const std::string& token);
  bool string(std::string& text) { return assign(std::move(text)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // does not occur in JSON text
  bool start_object(std::size_t) { return reader_.open(false), true; }
  bool start_array(std::size_t) { return reader_.open(true), true; }
  bool end_object() { return reader_.close(), true; }
  bool end_array() { return reader_.close(), true; }
  bool key(std::string& name) { return reader_.key(name), true; }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error);

 private:
  bool assign(JsonValue value) { return reader_.assign(std::move(value)), true; }

  JsonReader& reader_;
  const std::string& where_;
};

bool Sax::number_float(double, const std::string& token) {
  // Read the digits again: the parser's value depends on the decimal point of the C locale and hides an underflow.
  std::string digits = token;
  for (char& c : digits) {
    if (!(c >= '0' && c <= '9') && c != '-' && c != '+' && c != 'e' && c != 'E') c = '.';
  }
  double value = 0;
  const auto status = std::from_chars(digits.data(), digits.data() + digits.size(), value).ec;
  if (digits.find_first_of(".eE") == std::string::npos) reader_.refuse(shortened(digits), wanted_integer);
  if (status != std::errc()) reader_.refuse(shortened(digits), "a number within the range of double");
  return assign(value);
}

bool Sax::parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
  std::string reason = error.what();
  for (const std::string_view prefix : {"] ", ": syntax error "}) {
    if (const auto at = reason.find(prefix); at != std::string::npos) reason.erase(0, at + prefix.size());
  }
  throw Error(where_ + ": byte " + std::to_string(position) + ": not JSON " + shortened(reason, 160));
}

}  // namespace

std::string in_quotes(std::string_view text) { return '"' + shortened(text) + '"'; }

std::string describe(const JsonValue& value) {
  if (std::holds_alternative<std::nullptr_t>(value)) return "null";
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const double* n = std::get_if<double>(&value)) return to_text(*n);
  return in_quotes(std::get<std::string>(value));
}

void JsonReader::parse(std::string_view json) {
  // nlohmann's parser takes a zero byte for the end of the text and ignores the rest.
  if (const auto zero = json.find('\0'); zero != std::string_view::npos) {
    throw Error(where_ + ": byte " + std::to_string(zero + 1) + " is zero, wanted JSON in UTF-8");
  }
  Sax sax(*this, where_);
  nlohmann::json::sax_parse(json, &sax);
}

void JsonReader::refuse(const std::string& found, const std::string& wanted) const {
  throw Error(here() + " is " + found + ", wanted " + wanted);
}

double JsonReader::number_of(const JsonValue& value) const {
  if (const double* n = std::get_if<double>(&value)) return *n;
  refuse(describe(value), "a number");
}

std::optional<double> JsonReader::maybe_number(const JsonValue& value) const {
  if (std::holds_alternative<std::nullptr_t>(value)) return {};
  return number_of(value);
}

std::string JsonReader::text_of(const JsonValue& value) const {
  if (const std::string* text = std::get_if<std::string>(&value)) return *text;
  refuse(describe(value), "a string");
}

std::optional<std::string> JsonReader::maybe_text(const JsonValue& value) const {
  if (std::holds_alternative<std::nullptr_t>(value)) return {};
  return text_of(value);
}

bool JsonReader::flag_of(const JsonValue& value) const {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag;
  refuse(describe(value), "true or false");
}

std::string json_number(double value) {
  std::array<char, 64> buffer;
  const auto print = [&](std::chars_format layout) {
    return std::string(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, layout).ptr);
  };
  const std::string scientific = print(std::chars_format::scientific);
  const int exponent = std::atoi(scientific.c_str() + scientific.find('e') + 1);
  if (exponent < -4 || exponent >= 16) return scientific;
  const std::string plain = print(std::chars_format::fixed);
  return plain.find('.') == std::string::npos ? plain + ".0" : plain;
}

std::string json_text(const std::string& text) {
  try {
    return nlohmann::json(text).dump();
  } catch (const nlohmann::json::exception&) {
    throw Error("a string of the lens is not UTF-8, wanted UTF-8 to write JSON");
  }
}

}  // namespace petzval::inline v0::io_detail
