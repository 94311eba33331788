// SPDX-License-Identifier: Apache-2.0
#include "json_tree.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/text.hpp"
#include "io/json.hpp"
#include "petzval/core/error.hpp"

namespace petzval::formats_detail {
namespace {

constexpr std::size_t largest_text = std::size_t{16} << 20;
constexpr std::size_t deepest = 64;

/// The text with bare words that are not JSON (Infinity, NaN) in quotes.
std::string with_quoted_numbers(std::string_view text) {
  std::string result;
  result.reserve(text.size() + text.size() / 16);
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_string) {
      if (text[i] == '\\' && i + 1 < text.size()) {
        result.push_back(text[i++]);  // an escaped character ends no string
      } else {
        in_string = text[i] != '"';
      }
    } else if (text[i] == '"') {
      in_string = true;
    } else {
      bool found = false;
      for (const std::string_view word : {"-Infinity", "Infinity", "NaN"}) {
        if (!text.substr(i).starts_with(word)) continue;
        result += '"' + std::string(word) + '"';
        i += word.size() - 1;
        found = true;
        break;
      }
      if (found) continue;
    }
    result.push_back(text[i]);
  }
  return result;
}

/// Receives the events of nlohmann's parser and builds a tree that its owner can empty.
class Builder {
 public:
  /// @param text the text as in the file, for positions
  Builder(nlohmann::json& root, const std::string& where, std::string_view text)
      : next_(&root), where_(where), tokens_(text) {}

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) { return add(value); }
  bool number_float(double value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(nlohmann::json::binary_t&) { return false; }  // does not occur in JSON text
  bool start_object(std::size_t) { return open(nlohmann::json::value_t::object); }
  bool start_array(std::size_t) { return open(nlohmann::json::value_t::array); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    tokens_.next();
    next_ = &(*open_.back())[name];
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) {
    tokens_.next();
    const std::string token = io_detail::in_quotes(tokens_.token());
    if (dynamic_cast<const nlohmann::json::parse_error*>(&error)) fail("not JSON: " + token);
    fail(token + " is out of range; must be a finite number");
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(where_ + ':' + tokens_.line_and_column(tokens_.byte()) + ": " + message);
  }
  nlohmann::json& slot() {
    if (open_.empty() || open_.back()->is_object()) return *next_;
    open_.back()->push_back(nullptr);
    return open_.back()->back();
  }
  template <class Value>
  bool add(Value&& value) {
    tokens_.next();
    slot() = std::forward<Value>(value);
    return true;
  }
  bool open(nlohmann::json::value_t type) {
    tokens_.next();
    if (open_.size() >= deepest) fail("more than " + std::to_string(deepest) + " levels of brackets; must be fewer");
    nlohmann::json& here = slot();
    here = type;
    open_.push_back(&here);
    return true;
  }
  bool close() {
    tokens_.next();
    open_.pop_back();
    return true;
  }

  nlohmann::json* next_;               ///< the root, then the member whose key was read last
  std::vector<nlohmann::json*> open_;  ///< stable: an entry moves only while its own entries are closed
  const std::string& where_;
  io_detail::JsonTokens tokens_;
};

/// Empties a value from the leaves up: the destructor of a list or object that is not empty allocates memory, and
/// terminates the program if memory runs out.
void empty(nlohmann::json& value) noexcept {
  if (!value.is_structured()) return;
  for (nlohmann::json& entry : value) empty(entry);
  value.clear();
}

}  // namespace

// Delegates to a constructor that completes before the text is read, so that the destructor runs if reading throws.
JsonTree::JsonTree(std::string_view text, std::string where) : JsonTree() {
  text_ = text, where_ = std::move(where);
  if (text.size() > largest_text) {
    throw Error(where_ + ": " + std::to_string(text.size()) + " bytes; must be at most " +
                std::to_string(largest_text));
  }
  Builder builder(root_, where_, text);
  nlohmann::json::sax_parse(with_quoted_numbers(text), &builder);
}

JsonTree::~JsonTree() { empty(root_); }

void JsonTree::refuse(const std::string& path, const std::string& value, const std::string& rule) const {
  // Paths begin with "file", or with the key of the lens in a database.
  const std::string_view in_text = path == "file"              ? std::string_view()
                                   : path.starts_with("file.") ? std::string_view(path).substr(5)
                                                               : std::string_view(path);
  throw Error(where_ + io_detail::json_position(text_, std::string(in_text)) + ": " + path +
              (value == "missing" ? " is " : " = ") + value + "; must be " + rule);
}

std::string shown(const nlohmann::json& value) {
  const auto* word = value.get_ptr<const std::string*>();
  if (word) return io_detail::in_quotes(*word);
  const std::string text = value.dump();
  constexpr std::size_t max_quoted_size = 60;
  return text.size() <= max_quoted_size ? text : std::string(beginning(text, max_quoted_size)) + "...";
}

const nlohmann::json* JsonObject::find(const char* key) const {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

std::optional<double> JsonObject::number(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return {};
  if (value->is_number()) return value->get<double>();
  if (const auto* word = value->get_ptr<const std::string*>()) {
    if (*word == "Infinity") return std::numeric_limits<double>::infinity();
    if (*word == "-Infinity") return -std::numeric_limits<double>::infinity();
  }
  refuse(key, shown(*value), "a number");
}

double JsonObject::needed(const char* key) const {
  if (const auto value = number(key)) return *value;
  refuse(key, "missing", "a number");
}

std::string JsonObject::text(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return {};
  if (!value->is_string()) refuse(key, shown(*value), "a string");
  return value->get<std::string>();
}

bool JsonObject::flag(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value) return false;
  if (!value->is_boolean()) refuse(key, shown(*value), "true or false");
  return value->get<bool>();
}

JsonObject JsonObject::object(const char* key) const {
  const nlohmann::json* value = find(key);
  if (!value || !value->is_object()) refuse(key, value ? shown(*value) : "missing", "an object");
  return {*value, path + '.' + key, in, tree};
}

void JsonObject::name_others(std::initializer_list<std::string_view> used) const {
  for (const auto& [key, value] : json.items()) {
    const bool says_nothing = value.is_null() || (value.is_structured() && value.empty()) || value == false;
    if (says_nothing || std::ranges::find(used, std::string_view(key)) != used.end()) continue;
    in.warn(0, path + '.' + key, "is not known and is left out");
  }
}

}  // namespace petzval::formats_detail
