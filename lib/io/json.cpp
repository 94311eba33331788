// SPDX-License-Identifier: Apache-2.0
#include "json.hpp"

#include <algorithm>
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

namespace petzval::io_detail {
namespace {

constexpr std::int64_t largest_integer = std::int64_t{1} << 53;  // not every larger integer is a double
constexpr const char* integer_rule = "an integer up to 2^53";

/// Shortens text for messages: strings of a document may be long.
std::string shortened(std::string_view text, std::size_t longest = 60) {
  if (text.size() <= longest) return std::string(text);
  return std::string(beginning(text, longest)) + "...";
}

constexpr std::string_view blanks = " \t\r\n";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// True for words that stand for non-finite numbers, which JSON does not allow: "Infinity", "NaN".
bool is_not_finite(std::string_view word) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  std::string lower(word);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower == "infinity" || lower == "inf" || lower == "nan";
}

}  // namespace

/// Receives the events of nlohmann's parser.
class JsonEvents {
 public:
  explicit JsonEvents(JsonReader& reader) : reader_(reader) {}

  bool null() { return assign(nullptr); }
  bool boolean(bool flag) { return assign(flag); }
  bool number_integer(std::int64_t n) { return integer(n, n >= -largest_integer && n <= largest_integer); }
  bool number_unsigned(std::uint64_t n) { return integer(n, n <= static_cast<std::uint64_t>(largest_integer)); }
  bool number_float(double, const std::string& token);
  bool string(std::string& text) { return assign(std::move(text)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // does not occur in JSON text
  bool start_object(std::size_t) { return next(), reader_.open(false), true; }
  bool start_array(std::size_t) { return next(), reader_.open(true), true; }
  bool end_object() { return next(), reader_.close(), true; }
  bool end_array() { return next(), reader_.close(), true; }
  bool key(std::string& name) { return next(), reader_.key(name), true; }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error);

 private:
  void next() { reader_.tokens_.next(); }
  bool assign(JsonValue value) { return next(), reader_.assign(std::move(value)), true; }
  template <class Integer>
  bool integer(Integer n, bool is_double) {
    if (is_double) return assign(static_cast<double>(n));
    next();
    reader_.refuse(std::to_string(n), integer_rule);
  }

  JsonReader& reader_;
};

bool JsonEvents::number_float(double, const std::string& token) {
  // Read the digits again: the number from the parser depends on the decimal point of the C locale and hides an
  // underflow.
  std::string digits = token;
  for (char& c : digits) {
    if (!is_digit(c) && c != '-' && c != '+' && c != 'e' && c != 'E') c = '.';
  }
  double value = 0;
  const auto status = std::from_chars(digits.data(), digits.data() + digits.size(), value).ec;
  if (digits.find_first_of(".eE") != std::string::npos && status == std::errc()) return assign(value);
  next();
  reader_.refuse(shortened(digits), status == std::errc() ? integer_rule : "a number within the range of double");
}

bool JsonEvents::parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) {
  JsonTokens& tokens = reader_.tokens_;
  const std::size_t last = tokens.byte();
  tokens.next();
  const std::string_view token = tokens.token();
  const bool overflow = dynamic_cast<const nlohmann::json::out_of_range*>(&error) != nullptr;
  // Common mistakes in lenses typed by hand; the message names the key and the rule for its value.
  if (tokens.separator() == ':' && (overflow || is_not_finite(token))) {
    reader_.assign(JsonWord{shortened(token)});
  }
  const std::string_view before = tokens.before();
  const bool decimal_comma = tokens.separator() == ',' && !token.empty() && is_digit(token[0]) && !before.empty() &&
                             is_digit(before.back()) && tokens.byte() == last + before.size() + 1;
  if (decimal_comma) {
    reader_.fail(last, shortened(std::string(before) + ',' + std::string(token)) +
                           " has a decimal comma; must be a number with a decimal point");
  }
  std::string reason = error.what();
  for (const std::string_view prefix : {"] ", ": syntax error "}) {
    if (const auto at = reason.find(prefix); at != std::string::npos) reason.erase(0, at + prefix.size());
  }
  throw Error(reader_.where_ + ':' + tokens.line_and_column(tokens.byte()) + ": not JSON " + shortened(reason, 160));
}

JsonTokens::JsonTokens(std::string_view text) : text_(text) {
  if (text_.starts_with(byte_order_mark)) from_ = to_ = byte_order_mark.size();
}

void JsonTokens::next() {
  before_ = token();
  const auto skip_blanks = [this] { from_ = std::min(text_.find_first_not_of(blanks, from_), text_.size()); };
  from_ = to_;
  skip_blanks();
  separator_ = 0;
  // An unexpected separator (a second one, or one after an opening bracket) is a token of its own.
  const bool after_bracket = before_ == "{" || before_ == "[" || before_.empty();
  if (from_ < text_.size() && (text_[from_] == ',' || text_[from_] == ':') && !after_bracket) {
    separator_ = text_[from_++];
    skip_blanks();
  }
  to_ = from_;
  if (to_ == text_.size()) return;
  const char first = text_[to_++];
  if (first == '"') {
    while (to_ < text_.size() && text_[to_] != '"') to_ += text_[to_] == '\\' ? 2 : 1;
    to_ = std::min(to_ + 1, text_.size());
  } else if (std::string_view("{}[],:").find(first) == std::string_view::npos) {
    to_ = std::min(text_.find_first_of(" \t\r\n,:{}[]\"", to_), text_.size());
  }
}

std::string JsonTokens::line_and_column(std::size_t byte) const {
  std::size_t line = 1, column = 1;
  for (std::size_t i = text_.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; i < byte; ++i) {
    const char c = text_[i];
    if (c == '\n' || (c == '\r' && text_.substr(i + 1, 1) != "\n")) {
      ++line, column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) {
      ++column;
    }
  }
  return std::to_string(line) + ':' + std::to_string(column);
}

namespace {

/// Byte offset of the value at a path; nullopt if the text has no such value. The whole document has the path "".
std::optional<std::size_t> find_in_json(std::string_view json, std::string_view path) {
  struct Level {
    bool list;
    std::size_t path_size, entries = 0;
  };
  std::vector<Level> levels;
  std::string here;  // path of the token
  JsonTokens tokens(json);
  for (tokens.next(); !tokens.token().empty(); tokens.next()) {
    const std::string_view token = tokens.token();
    if (token == "}" || token == "]") {
      if (levels.empty()) return {};
      levels.pop_back();
      continue;
    }
    if (!levels.empty()) {
      Level& level = levels.back();
      const bool is_key = !level.list && tokens.separator() != ':';
      if (level.list || is_key) here.resize(level.path_size);
      if (level.list) here += '[' + std::to_string(level.entries++) + ']';
      if (is_key) {
        here += (here.empty() ? "" : ".") + std::string(token.substr(1, std::max<std::size_t>(token.size(), 2) - 2));
        continue;
      }
    }
    if (here == path) return tokens.byte();
    if (token == "{" || token == "[") levels.push_back({token == "[", here.size()});
  }
  return {};
}

}  // namespace

std::string json_position(std::string_view json, std::string path) {
  while (true) {
    if (const auto byte = find_in_json(json, path)) return ':' + JsonTokens(json).line_and_column(*byte);
    if (path.empty()) return {};
    const std::size_t last = path.find_last_of(".[");
    path.resize(last == std::string::npos ? 0 : last);
  }
}

std::string in_quotes(std::string_view text) { return '"' + shortened(text) + '"'; }

std::string describe(const JsonValue& value) {
  if (std::holds_alternative<std::nullptr_t>(value)) return "null";
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const double* n = std::get_if<double>(&value)) return to_text(*n);
  if (const JsonWord* word = std::get_if<JsonWord>(&value)) return word->text;
  return in_quotes(std::get<std::string>(value));
}

void JsonReader::parse(std::string_view json) {
  tokens_ = JsonTokens(json);
  // nlohmann's parser treats a zero byte as the end of the text and ignores the rest of the text.
  if (const auto zero = json.find('\0'); zero != std::string_view::npos) {
    throw Error(where_ + ':' + tokens_.line_and_column(zero) + ": not JSON: a byte is 0; must be UTF-8");
  }
  JsonEvents events(*this);
  nlohmann::json::sax_parse(json, &events);
}

void JsonReader::fail(std::size_t byte, const std::string& message) const {
  const std::string location = here();
  throw Error(where_ + ':' + tokens_.line_and_column(byte) + ": " + location + (location.empty() ? "" : ": ") +
              message);
}

void JsonReader::refuse(const std::string& value, const std::string& rule) const {
  const std::string location = here();
  throw Error(where_ + ':' + tokens_.line_and_column(byte()) + ": " + (location.empty() ? "document" : location) +
              " = " + value + "; must be " + rule);
}

void JsonReader::refuse_kind(const std::string& kind, const std::string& rule) const {
  const std::string location = here();
  throw Error(where_ + ':' + tokens_.line_and_column(byte()) + ": " + (location.empty() ? "document" : location) +
              " is " + kind + "; must be " + rule);
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
    throw Error("a string of the lens is not UTF-8; must be UTF-8 to write JSON");
  }
}

}  // namespace petzval::io_detail
