// SPDX-License-Identifier: Apache-2.0
// Structs as JSON by one list of members for writing and reading: members(value, of) calls of(key, member, rule,
// presence) for each member.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/json.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {

struct CameraSetup;

namespace io_detail {

/// JSON for writing: null, a number or text, or an object or list whose entries keep their order. The destructor
/// allocates no memory. A document of nlohmann_json allocates some, and terminates the program if memory runs out.
class OrderedJson {
 public:
  enum class Kind : std::uint8_t { value, object, list };

  OrderedJson() = default;
  template <class T>
    requires std::is_arithmetic_v<T>
  explicit OrderedJson(T value) {
    if constexpr (std::same_as<T, bool>) {
      text_ = value ? "true" : "false";
    } else if constexpr (std::integral<T>) {
      text_ = std::to_string(value);
    } else {
      text_ = json_number(value);
    }
  }
  explicit OrderedJson(const std::string& text) : text_(json_text(text)) {}
  static OrderedJson object() { return OrderedJson(Kind::object); }
  static OrderedJson list() { return OrderedJson(Kind::list); }

  Kind kind() const noexcept { return kind_; }
  bool is_null() const noexcept { return text_ == "null"; }
  const std::string& text() const noexcept { return text_; }  ///< of a value; of an object or list without entries
  const std::vector<std::string>& keys() const noexcept { return keys_; }  ///< of the entries of an object
  const std::vector<OrderedJson>& entries() const noexcept { return entries_; }

  /// Adds an entry to an object; its key must be new.
  OrderedJson& add(std::string_view key, OrderedJson entry) {
    keys_.emplace_back(key);
    return add(std::move(entry));
  }
  /// Adds an entry to a list.
  OrderedJson& add(OrderedJson entry) { return entries_.emplace_back(std::move(entry)); }

 private:
  explicit OrderedJson(Kind kind) : kind_(kind), text_(kind == Kind::object ? "{}" : "[]") {}

  Kind kind_ = Kind::value;
  std::string text_ = "null";
  std::vector<std::string> keys_;
  std::vector<OrderedJson> entries_;
};

/// A type, also if it is const: one list of members serves writing and reading.
template <class S, class T>
concept Is = std::same_as<std::remove_const_t<S>, T>;

/// The valid values of a number, and the rule in words. Infinity, if valid, is null.
struct Range {
  double least = -std::numeric_limits<double>::max(), most = std::numeric_limits<double>::max();
  const char* words = "a number";
};
inline constexpr Range any_number{};
inline constexpr Range positive{std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(),
                                "a number above 0"};
inline constexpr Range positive_or_infinite{std::numeric_limits<double>::denorm_min(),
                                            std::numeric_limits<double>::infinity(),
                                            "a number above 0, or null for infinity"};
inline constexpr Range not_negative{0, std::numeric_limits<double>::max(), "a number of 0 or more"};

/// Presence of a key, and the value of an optional member without a value.
enum class Presence : std::uint8_t {
  usual,    ///< the key may be missing; an optional member is written if it has a value
  needed,   ///< the key must be present
  or_null,  ///< as usual; an optional member without a value is written as null
  not_null  ///< as usual; null is refused
};

/// A coating is "none", "mgf2" (only read) or an object.
PETZVAL_API OrderedJson json_of(const Coating& coating);
PETZVAL_API void read_value(const JsonPart& part, Coating& to, const Range& = {});
/// A prescription as in a lens file. @throws Error if validate() throws
PETZVAL_API OrderedJson json_of(const Prescription& prescription);
PETZVAL_API void read_value(const JsonPart& part, Prescription& to, const Range& = {});

/// The name of an enumerator, or its number if it has no name.
template <class Enum>
std::string word_of(Enum value) {
  if constexpr (requires { name(value); }) {
    return std::string(name(value));
  } else if constexpr (std::same_as<Enum, Section>) {
    return value == Section::x ? "x" : value == Section::y ? "y" : "both";
  } else {
    return std::to_string(static_cast<int>(value));
  }
}

template <class T>
OrderedJson json_of(const T& value);
template <class T, class Rule = Range>
void read_value(const JsonPart& part, T& to, const Rule& rule = {});

/// Writes members. A number that is not finite is null if its range has infinity or the presence is or_null; otherwise
/// an optional one is left out.
struct MemberWriter {
  OrderedJson& to;

  template <class T, class Rule = Range>
  void operator()(const char* key, const T& member, const Rule& rule = {}, Presence presence = Presence::usual) const {
    if constexpr (requires { member.has_value(); }) {
      OrderedJson json = member ? json_of(*member) : OrderedJson();
      bool null_is_value = presence == Presence::or_null;
      if constexpr (requires { rule.most; }) null_is_value |= member && std::isinf(rule.most);
      if (!json.is_null() || null_is_value) to.add(key, std::move(json));
    } else {
      to.add(key, json_of(member));
    }
  }
  /// A member that is left out if it has its default value.
  template <class T, class Rule = Range>
  void unless_default(const char* key, const T& member, const Rule& = {}) const {
    if (!(member == T{})) to.add(key, json_of(member));
  }
  /// Members that are an object of their own in JSON.
  template <class List>
  void object(const char* key, const List& list) const {
    list(MemberWriter{to.add(key, OrderedJson::object())});
  }
};

/// Collects members for JsonPart::read(). A missing key keeps the value of its member.
struct MemberReader {
  std::vector<JsonField>& fields;

  template <class T, class Rule = Range>
  void operator()(const char* key, T& member, const Rule& rule = {}, Presence presence = Presence::usual) const {
    const auto read = [&member, rule, presence](const JsonPart& part) {
      if (presence == Presence::not_null && part.json().is_null()) part.refuse("a value");
      read_value(part, member, rule);
    };
    fields.emplace_back(key, read, presence == Presence::needed);
  }
  template <class T, class Rule = Range>
  void unless_default(const char* key, T& member, const Rule& rule = {}) const {
    (*this)(key, member, rule);
  }
  template <class List>
  void object(const char* key, const List& list) const {
    const auto read = [list](const JsonPart& part) {
      std::vector<JsonField> inner;
      list(MemberReader{inner});
      part.read(inner);
    };
    fields.emplace_back(key, read);
  }
};

template <class T>
OrderedJson json_of(const T& value) {
  if constexpr (std::floating_point<T>) {
    return std::isfinite(value) ? OrderedJson(value) : OrderedJson();
  } else if constexpr (std::integral<T> || std::same_as<T, std::string>) {
    return OrderedJson(value);
  } else if constexpr (requires { value.begin(); }) {
    OrderedJson list = OrderedJson::list();
    for (const auto& entry : value) list.add(json_of(entry));
    return list;
  } else if constexpr (requires(const MemberWriter& of) { members(value, of); }) {
    OrderedJson object = OrderedJson::object();
    members(value, MemberWriter{object});
    return object;
  } else if constexpr (requires { name(value); } || std::same_as<T, Section>) {
    return OrderedJson(word_of(value));
  } else {
    return OrderedJson(static_cast<int>(value));
  }
}

/// Reads a value that the rule allows: a Range, or the list of the enumerators.
template <class T, class Rule>
void read_value(const JsonPart& part, T& to, const Rule& rule) {
  if constexpr (requires { to.has_value(); }) {
    constexpr bool nullable =
        std::floating_point<typename T::value_type> || std::same_as<typename T::value_type, std::string>;
    to.reset();
    if constexpr (nullable) {
      if (part.json().is_null() && !std::isinf(rule.most)) return;
    }
    read_value(part, to.emplace(), rule);
  } else if constexpr (std::same_as<T, bool> || std::same_as<T, std::string>) {
    part.get(to);
  } else if constexpr (std::floating_point<T> || std::integral<T>) {
    if (std::isinf(rule.most) && part.json().is_null()) return void(to = std::numeric_limits<T>::infinity());
    const double value = part.number(rule.words);
    if (!(value >= rule.least && value <= rule.most)) part.refuse(rule.words);
    if (std::integral<T> && value != std::floor(value)) part.refuse(rule.words);
    to = static_cast<T>(value);
  } else if constexpr (requires { to.emplace_back(); }) {
    to.clear();
    part.each([&](const JsonPart& entry) { read_value(entry, to.emplace_back(), rule); });
  } else if constexpr (requires(const MemberReader& of) { members(to, of); }) {
    std::vector<JsonField> fields;
    members(to, MemberReader{fields});
    part.read(fields);
  } else {
    const std::string word = part.json().is_string() ? part.text() : part.json().dump();
    std::string known;
    for (const T& entry : rule) {
      if (word_of(entry) == word) return void(to = entry);
      known += (known.empty() ? "" : ", ") + word_of(entry);
    }
    part.refuse("one of " + known);
  }
}

/// Formats a document; lists of lenses and set-ups have an entry in each line.
PETZVAL_API std::string format_json(const OrderedJson& json);

/// A set-up as to_json() formats it, and the set-up of a part of a document.
PETZVAL_API OrderedJson setup_json(const CameraSetup& setup);
PETZVAL_API CameraSetup read_setup(const JsonPart& part);

}  // namespace io_detail
}  // namespace petzval
