// SPDX-License-Identifier: Apache-2.0
#include "json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <system_error>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::io_detail {
namespace {

constexpr std::int64_t largest_integer = std::int64_t{1} << 53;  // not every larger integer is a double
constexpr const char* integer_rule = "an integer up to 2^53";
constexpr std::size_t largest_text = std::size_t{16} << 20, deepest = 64, longest_list = 10'000, longest_words = 160;

/// Shortens text for messages: strings of a document may be long.
std::string shortened(std::string_view text, std::size_t longest = 60) {
  if (text.size() <= longest) return std::string(text);
  return std::string(beginning(text, longest)) + "...";
}

constexpr std::string_view blanks = " \t\r\n";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::string_view ends_of_words = " \t\r\n,:{}[]\"";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// True for words that stand for non-finite numbers, which JSON does not allow: "Infinity", "NaN".
bool is_not_finite(std::string_view word) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  std::string lower(word);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower == "infinity" || lower == "inf" || lower == "nan";
}

/// The text with bare words for non-finite numbers in quotes.
std::string with_quoted_numbers(std::string_view text) {
  std::string result;
  result.reserve(text.size() + text.size() / 16);
  for (std::size_t i = 0, end; i < text.size(); i = end) {
    end = i + 1;
    if (text[i] == '"') {
      while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
      end = std::min(end + 1, text.size());
    } else if (ends_of_words.find(text[i]) == std::string_view::npos) {
      end = std::min(text.find_first_of(ends_of_words, i), text.size());
    }
    const std::string_view word = text.substr(i, end - i);
    is_not_finite(word) ? result.append(1, '"').append(word).append(1, '"') : result.append(word);
  }
  return result;
}

/// The tokens of a JSON text for which the parser has events (values, keys and brackets), in order. A class that calls
/// `next` once per event knows the position of each event.
class JsonTokens {
 public:
  explicit JsonTokens(std::string_view text) : text_(text) {
    if (text_.starts_with(byte_order_mark)) from_ = to_ = byte_order_mark.size();
  }
  /// Moves to the next token; after the last token, to the end or to text that the parser refuses.
  void next();
  std::size_t byte() const noexcept { return from_; }  ///< offset of the token
  std::string_view token() const noexcept { return text_.substr(from_, to_ - from_); }
  std::string_view before() const noexcept { return before_; }  ///< previous token
  char separator() const noexcept { return separator_; }        ///< ',' or ':' in front of the token, or 0
  /// Line and column of a byte, both from 1: ":11:8". Columns count characters; lines end as in text_file.hpp.
  std::string position(std::size_t byte) const;

 private:
  std::string_view text_, before_;
  std::size_t from_ = 0, to_ = 0;
  char separator_ = 0;
};

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
    to_ = std::min(text_.find_first_of(ends_of_words, to_), text_.size());
  }
}

std::string JsonTokens::position(std::size_t byte) const {
  std::size_t line = 1, column = 1;
  for (std::size_t i = text_.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; i < byte; ++i) {
    const char c = text_[i];
    if (c == '\n' || (c == '\r' && text_.substr(i + 1, 1) != "\n")) {
      ++line, column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) {
      ++column;
    }
  }
  return ':' + std::to_string(line) + ':' + std::to_string(column);
}

/// "value = x; must be rule", or "value is a list; ..." of lists and objects.
std::string refusal(const std::string& words, const std::string& value, const std::string& rule) {
  const bool sort = value == "a list" || value == "an object" || value == "missing";
  return (words.empty() ? "document" : words) + (sort ? " is " : " = ") + value + "; must be " + rule;
}

/// Receives the events of nlohmann's parser and builds a tree that its owner can empty.
class Builder {
 public:
  /// @param text the text as in the file, for positions
  Builder(nlohmann::json& root, std::string_view text, const std::string& where, JsonTree::Words words)
      : next_(&root), tokens_(text), where_(where), words_(words) {}

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) { return add(value); }
  bool number_float(double, const std::string& token);
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(nlohmann::json::binary_t&) { return false; }  // does not occur in JSON text
  bool start_object(std::size_t) { return open(nlohmann::json::value_t::object); }
  bool start_array(std::size_t) { return open(nlohmann::json::value_t::array); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name);
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error);

 private:
  struct Level {
    nlohmann::json* json;  ///< stable: an entry moves only while its own entries are closed
    std::size_t path_size;
  };

  [[noreturn]] void fail(std::size_t byte, const std::string& message) const {
    throw Error(where_ + tokens_.position(byte) + ": " + message);
  }
  [[noreturn]] void refuse(const std::string& value, const std::string& rule) const {
    fail(tokens_.byte(), refusal(value_name(), value, rule));
  }
  std::string value_name() const { return shortened(words_(path_), longest_words); }
  std::string located(const std::string& message) const {
    return value_name().empty() ? message : value_name() + ": " + message;
  }
  bool in_list() const noexcept { return !levels_.empty() && levels_.back().json->is_array(); }
  /// Moves the path to the next value.
  void name_value() {
    if (!in_list()) return;
    path_.resize(levels_.back().path_size);
    path_ += '[' + std::to_string(levels_.back().json->size()) + ']';
  }
  /// The place of the next value.
  nlohmann::json& slot() {
    tokens_.next();
    name_value();
    return in_list() ? levels_.back().json->emplace_back() : *next_;
  }
  template <class Value>
  bool add(Value&& value) {
    slot() = std::forward<Value>(value);
    return true;
  }
  bool open(nlohmann::json::value_t type) {
    nlohmann::json& here = slot();
    if (levels_.size() >= deepest) {
      fail(tokens_.byte(), "more than " + std::to_string(deepest) + " levels of brackets; must be fewer");
    }
    here = type;
    levels_.push_back({&here, path_.size()});
    return true;
  }
  bool close() {
    tokens_.next();
    path_.resize(levels_.back().path_size);
    levels_.pop_back();
    return true;
  }

  nlohmann::json* next_;  ///< the root, then the member whose key was read last
  std::vector<Level> levels_;
  std::string path_;
  JsonTokens tokens_;
  const std::string& where_;
  JsonTree::Words words_;
};

bool Builder::key(std::string& name) {
  tokens_.next();
  auto& [object, path_size] = levels_.back();
  path_.resize(path_size);
  const auto [member, is_new] = object->emplace(name, nullptr);
  if (!is_new) fail(tokens_.byte(), located("key " + in_quotes(name) + " is given twice; must be given once"));
  path_ += (path_.empty() ? "" : ".") + name;
  next_ = &*member;
  return true;
}

bool Builder::number_float(double, const std::string& token) {
  // Read the digits again: the number from the parser depends on the decimal point of the C locale and hides an
  // underflow.
  std::string digits = token;
  for (char& c : digits) {
    if (!is_digit(c) && c != '-' && c != '+' && c != 'e' && c != 'E') c = '.';
  }
  double value = 0;
  const auto status = std::from_chars(digits.data(), digits.data() + digits.size(), value).ec;
  const bool is_integer = digits.find_first_of(".eE") == std::string::npos;
  if (!is_integer && status == std::errc()) return add(value);
  slot();
  refuse(shortened(digits), status == std::errc() ? integer_rule : "a number within the range of double");
}

bool Builder::parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) {
  const std::size_t last = tokens_.byte();
  tokens_.next();
  const std::string_view token = tokens_.token();
  if (dynamic_cast<const nlohmann::json::out_of_range*>(&error)) {
    name_value();
    refuse(shortened(token), "a finite number");
  }
  // A common mistake in lenses typed by hand.
  const std::string_view before = tokens_.before();
  const bool decimal_comma = tokens_.separator() == ',' && !token.empty() && is_digit(token[0]) && !before.empty() &&
                             is_digit(before.back()) && tokens_.byte() == last + before.size() + 1;
  if (decimal_comma) {
    fail(last, located(shortened(std::string(before) + ',' + std::string(token)) +
                       " has a decimal comma; must be a number with a decimal point"));
  }
  std::string reason = error.what();
  for (const std::string_view prefix : {"] ", ": syntax error "}) {
    if (const auto at = reason.find(prefix); at != std::string::npos) reason.erase(0, at + prefix.size());
  }
  fail(tokens_.byte(), "not JSON " + shortened(reason, 160));
}

/// Empties a value from the leaves up: the destructor of a list or object that is not empty allocates memory, and
/// terminates the program if memory runs out.
void empty(nlohmann::json& value) noexcept {
  if (!value.is_structured()) return;
  for (nlohmann::json& entry : value) empty(entry);
  value.clear();
}

/// Byte offset of the value at a path, or of its key; nullopt if the text has no such value. The whole document has the
/// path "".
std::optional<std::size_t> find_in_json(std::string_view json, std::string_view path, bool key) {
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
        if (key && here == path) return tokens.byte();
        continue;
      }
    }
    if (here == path) return tokens.byte();
    if (token == "{" || token == "[") levels.push_back({token == "[", here.size()});
  }
  return {};
}

}  // namespace

// Delegates to a constructor that completes before the text is read, so that the destructor runs if reading throws.
JsonTree::JsonTree(std::string_view text, std::string where, Words words) : JsonTree() {
  text_ = text, where_ = std::move(where), words_ = words;
  if (text.size() > largest_text) {
    throw Error(where_ + ": " + std::to_string(text.size()) + " bytes; must be at most " +
                std::to_string(largest_text));
  }
  // nlohmann's parser treats a zero byte as the end of the text and ignores the rest of the text.
  if (const auto zero = text.find('\0'); zero != std::string_view::npos) {
    throw Error(where_ + JsonTokens(text).position(zero) + ": not JSON: a byte is 0; must be UTF-8");
  }
  Builder builder(root_, text, where_, words);
  nlohmann::json::sax_parse(with_quoted_numbers(text), &builder);
}

JsonTree::~JsonTree() { empty(root_); }

void JsonTree::fail(const std::string& path, const std::string& message, const std::string& key) const {
  const std::string location = shortened(words_(path), longest_words);
  const bool at_key = !key.empty();
  throw Error(where_ + json_position(text_, at_key ? key : path, at_key) + ": " + location +
              (location.empty() ? "" : ": ") + message);
}

void JsonTree::fail_at(const std::string& path, const std::string& message) const {
  throw Error(where_ + json_position(text_, path) + ": " + message);
}

void JsonTree::refuse(const std::string& path, const std::string& value, const std::string& rule) const {
  throw Error(where_ + json_position(text_, path) + ": " +
              refusal(shortened(words_(path), longest_words), value, rule));
}

bool JsonTree::is_bare(const std::string& path) const {
  const auto byte = find_in_json(text_, path, false);
  return byte && text_[*byte] != '"';
}

JsonPart::JsonPart(const JsonPart& list, std::size_t index)
    : tree_(list.tree_), json_(list.json_[index]), path_(list.path_ + '[' + std::to_string(index) + ']') {}

JsonPart::JsonPart(const JsonPart& object, const std::string& key, const nlohmann::json& json)
    : tree_(object.tree_), json_(json), path_(object.path_ + (object.path_.empty() ? "" : ".") + key) {}

void JsonPart::refuse(const std::string& rule) const {
  const auto* word = json_.get_ptr<const std::string*>();
  tree_.refuse(path_,
               is_bare_word()      ? *word
               : word              ? in_quotes(*word)
               : json_.is_array()  ? "a list"
               : json_.is_object() ? "an object"
               : json_.is_number() ? to_text(json_.get<double>())
                                   : json_.dump(),
               rule);
}

bool JsonPart::is_bare_word() const {
  const auto* word = json_.get_ptr<const std::string*>();
  return word && is_not_finite(*word) && tree_.is_bare(path_);
}

double JsonPart::number(const char* rule) const {
  if (!json_.is_number()) refuse(rule);
  const bool is_exact = json_.is_number_unsigned()  ? json_.get<std::uint64_t>() <= std::uint64_t{largest_integer}
                        : json_.is_number_integer() ? json_.get<std::int64_t>() >= -largest_integer
                                                    : true;
  if (!is_exact) tree_.refuse(path_, json_.dump(), integer_rule);
  return json_.get<double>();
}

int JsonPart::whole_number(int least, int most) const {
  const double value = number();
  if (value >= least && value <= most && value == std::floor(value)) return static_cast<int>(value);
  refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

std::string JsonPart::text() const {
  if (!json_.is_string() || is_bare_word()) refuse("a string");
  return json_.get<std::string>();
}

void JsonPart::get(bool& to) const {
  if (!json_.is_boolean()) refuse("true or false");
  to = json_.get<bool>();
}

void JsonPart::each(const std::function<void(const JsonPart&)>& read) const {
  if (!json_.is_array()) refuse("a list");
  if (json_.size() > longest_list) {
    fail("more than " + std::to_string(longest_list) + " entries; must be fewer");
  }
  for (std::size_t i = 0; i < json_.size(); ++i) read(JsonPart(*this, i));
}

void JsonPart::each_member(const std::function<void(const std::string&, const JsonPart&)>& read) const {
  if (!json_.is_object()) refuse("an object");
  for (const auto& [key, value] : json_.items()) read(key, JsonPart(*this, key, value));
}

void JsonPart::read(const std::vector<JsonField>& fields) const {
  if (!json_.is_object()) refuse("an object");
  for (const JsonField& field : fields) {
    if (const auto member = json_.find(field.name); member != json_.end()) {
      field.set(JsonPart(*this, std::string(field.name), *member));
    }
  }
  each_member([&](const std::string& key, const JsonPart& part) {
    if (std::ranges::find(fields, std::string_view(key), &JsonField::name) != fields.end()) return;
    std::string known;
    for (const JsonField& field : fields) known += (known.empty() ? "" : ", ") + std::string(field.name);
    tree_.fail(path_, "key " + in_quotes(key) + " is unknown; must be one of " + known, part.path_);
  });
  for (const JsonField& field : fields) {
    if (!field.required || json_.contains(field.name)) continue;
    fail("key " + in_quotes(field.name) + " is missing");
  }
}

std::string words_of(std::string_view path) {
  std::string words;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('.'), path.size()), bracket = path.substr(0, end).find('[');
    std::string_view list = path.substr(0, std::min(bracket, end));
    words += words.empty() ? "" : ": ";
    if (bracket != std::string_view::npos) {
      list.remove_suffix(list.ends_with("ases") ? 2 : list.ends_with('s') ? 1 : 0);
      words.append(list).append(1, ' ').append(path.substr(bracket + 1, end - bracket - 2));
    } else {
      words += list;
    }
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return words;
}

std::string json_position(std::string_view json, std::string path, bool key) {
  while (true) {
    if (const auto byte = find_in_json(json, path, key)) return JsonTokens(json).position(*byte);
    if (path.empty()) return {};
    const std::size_t last = path.find_last_of(".[");
    path.resize(last == std::string::npos ? 0 : last);
  }
}

std::string in_quotes(std::string_view text) { return '"' + shortened(text) + '"'; }

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
