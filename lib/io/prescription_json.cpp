// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/prescription_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <variant>

#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"

namespace petzval {
namespace {

constexpr std::string_view format_name = "petzval-lens 1";
constexpr std::size_t longest_list = 10'000;
constexpr std::int64_t largest_integer = std::int64_t{1} << 53;  // beyond it not every integer is a double
constexpr const char* wanted_integer = "an integer up to 2^53";

/// A value that is not a list or an object.
using Value = std::variant<std::nullptr_t, bool, double, std::string>;

/// The brackets of the format: what a list or an object stands for.
enum class Place { file, source, zoom, variable_gaps, aliases, object_space, surfaces, surface, aspheric, term };

constexpr bool is_list(Place place) {
  return place == Place::aliases || place == Place::surfaces || place == Place::aspheric;
}

/// Texts of a document are of any length, messages are not.
std::string shortened(std::string_view text, std::size_t longest = 60) {
  if (text.size() <= longest) return std::string(text);
  while (longest > 0 && (static_cast<unsigned char>(text[longest]) & 0xC0) == 0x80) --longest;  // whole characters only
  return std::string(text.substr(0, longest)) + "...";
}

std::string in_quotes(std::string_view text) { return '"' + shortened(text) + '"'; }

std::string describe(const Value& value) {
  if (std::holds_alternative<std::nullptr_t>(value)) return "null";
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const double* n = std::get_if<double>(&value)) return number(*n);
  return in_quotes(std::get<std::string>(value));
}

/// Builds a prescription while nlohmann's parser walks the text: nothing but the prescription itself is stored, and
/// what does not belong there is refused where it stands.
class Reader {
 public:
  explicit Reader(std::string where) : where_(std::move(where)) {}
  Prescription take() { return std::move(lens_); }

  // What the parser calls.
  bool null() { return assign(nullptr); }
  bool boolean(bool flag) { return assign(flag); }
  bool number_integer(std::int64_t n);
  bool number_unsigned(std::uint64_t n);
  bool number_float(double, const std::string& token);
  bool string(std::string& text) { return assign(std::move(text)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // no such thing in text
  bool start_object(std::size_t) { return open(false); }
  bool start_array(std::size_t) { return open(true); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name);
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error);

 private:
  struct Key {
    std::string_view name;
    void (*set)(Reader&, const Value&);  ///< for a plain value
    std::optional<Place> opens = {};     ///< for a list or an object
    bool required = false;
  };
  struct Open {
    Place place;
    std::uint32_t seen = 0;   ///< keys met, by number in the table of the place
    std::size_t entries = 0;  ///< of a list
  };

  static std::span<const Key> keys(Place place);
  const Key* current() const { return key_ < 0 ? nullptr : &keys(open_.back().place)[static_cast<std::size_t>(key_)]; }
  SurfaceRow& row() { return lens_.surfaces.back(); }
  Medium& medium() { return open_.back().place == Place::surface ? row().medium : lens_.object_space; }

  bool assign(Value value);
  bool open(bool list);
  bool close();
  void count_entry();
  std::string here() const;
  [[noreturn]] void refuse(const std::string& found, const std::string& wanted) const {
    throw Error(here() + " is " + found + ", wanted " + wanted);
  }

  double number_of(const Value& value) const;
  std::optional<double> maybe_number(const Value& value) const;
  std::string text_of(const Value& value) const;
  std::optional<std::string> maybe_text(const Value& value) const;
  bool flag_of(const Value& value) const;

  std::string where_;
  Prescription lens_;
  std::vector<Open> open_;
  int key_ = -1;  ///< the key just read, by number in the table of the innermost place
  int gap_ = 0;   ///< the key just read among the variable gaps
};

std::span<const Reader::Key> Reader::keys(Place place) {
  using R = Reader;
  using V = const Value;
  static constexpr std::array<Key, 18> file = {{
      {"format",
       [](R& r, V& v) {
         if (r.text_of(v) != format_name) r.refuse(describe(v), in_quotes(format_name));
       },
       {},
       true},
      {"id", [](R& r, V& v) { r.lens_.id = r.text_of(v); }},
      {"name", [](R& r, V& v) { r.lens_.name = r.text_of(v); }},
      {"source", nullptr, Place::source},
      {"focal_length_mm", [](R& r, V& v) { r.lens_.focal_length_mm = r.maybe_number(v); }},
      {"f_number", [](R& r, V& v) { r.lens_.f_number = r.maybe_number(v); }},
      {"half_field_deg", [](R& r, V& v) { r.lens_.half_field_deg = r.maybe_number(v); }},
      {"image_diagonal_mm", [](R& r, V& v) { r.lens_.image_diagonal_mm = r.maybe_number(v); }},
      {"reference_wavelength_nm", [](R& r, V& v) { r.lens_.reference_wavelength_nm = r.number_of(v); }},
      {"semi_diameters", [](R& r, V& v) { r.lens_.semi_diameters = r.maybe_text(v); }},
      {"stop_size", [](R& r, V& v) { r.lens_.stop_size = r.maybe_text(v); }},
      {"image_distance", [](R& r, V& v) { r.lens_.image_distance = r.maybe_text(v); }},
      {"glass_names", [](R& r, V& v) { r.lens_.glass_names = r.maybe_text(v); }},
      {"zoom", nullptr, Place::zoom},
      {"notes", [](R& r, V& v) { r.lens_.notes = r.maybe_text(v); }},
      {"aliases", nullptr, Place::aliases},
      {"object_space", nullptr, Place::object_space},
      {"surfaces", nullptr, Place::surfaces, true},
  }};
  static constexpr std::array<Key, 2> source = {{
      {"design", [](R& r, V& v) { r.lens_.source_design = r.text_of(v); }},
      {"numbers", [](R& r, V& v) { r.lens_.source_numbers = r.text_of(v); }},
  }};
  static constexpr std::array<Key, 2> zoom = {{
      {"position", [](R& r, V& v) { r.lens_.zoom->position = r.text_of(v); }},
      {"variable_gaps", nullptr, Place::variable_gaps},
  }};
  // The medium comes first: object_space has these keys alone.
  static constexpr std::array<Key, 14> surface = {{
      {"glass", [](R& r, V& v) { r.medium().glass = r.maybe_text(v); }},
      {"catalogue", [](R& r, V& v) { r.medium().catalogue = r.maybe_text(v); }},
      {"glass_origin", [](R& r, V& v) { r.medium().glass_origin = r.maybe_text(v); }},
      {"nd", [](R& r, V& v) { r.medium().nd = r.number_of(v); }, {}, true},
      {"vd", [](R& r, V& v) { r.medium().vd = r.maybe_number(v); }},
      {"radius", [](R& r, V& v) { r.row().radius = r.number_of(v); }, {}, true},
      {"thickness", [](R& r, V& v) { r.row().thickness = r.number_of(v); }, {}, true},
      {"semi_diameter", [](R& r, V& v) { r.row().semi_diameter = r.maybe_number(v); }},
      {"inner_semi_diameter", [](R& r, V& v) { r.row().inner_semi_diameter = r.maybe_number(v); }},
      {"conic", [](R& r, V& v) { r.row().conic = r.number_of(v); }},
      {"aspheric", nullptr, Place::aspheric},
      {"stop", [](R& r, V& v) { r.row().stop = r.flag_of(v); }},
      {"mirror", [](R& r, V& v) { r.row().mirror = r.flag_of(v); }},
      {"curved_in",
       [](R& r, V& v) {
         const std::string section = r.text_of(v);
         if (section != "x" && section != "y") r.refuse(describe(v), "\"x\" or \"y\"");
         r.row().curved_in = section == "x" ? Section::x : Section::y;
       }},
  }};
  static constexpr std::array<Key, 2> term = {{
      {"order",
       [](R& r, V& v) {
         const double order = r.number_of(v);
         if (!(order >= 2 && order <= 40 && order == std::floor(order)))
           r.refuse(describe(v), "a whole number from 2 to 40");
         r.row().aspheric.back().order = static_cast<int>(order);
       },
       {},
       true},
      {"coefficient", [](R& r, V& v) { r.row().aspheric.back().coefficient = r.number_of(v); }, {}, true},
  }};
  switch (place) {
    case Place::file: return file;
    case Place::source: return source;
    case Place::zoom: return zoom;
    case Place::object_space: return std::span(surface).first(5);
    case Place::surface: return surface;
    case Place::term: return term;
    case Place::variable_gaps:
    case Place::aliases:
    case Place::surfaces:
    case Place::aspheric: break;
  }
  return {};
}

/// The place in words: file, surface, term and key.
std::string Reader::here() const {
  std::string text = where_;
  for (const Open& open : open_) {
    if (open.place == Place::source) text += ": source";
    if (open.place == Place::zoom) text += ": zoom";
    if (open.place == Place::object_space) text += ": object_space";
    if (open.place == Place::variable_gaps) text += ": variable_gaps";
    if (open.place == Place::surfaces) text += ": surface " + std::to_string(open.entries - 1);
    if (open.place == Place::aspheric) text += ": aspheric " + std::to_string(open.entries - 1);
    if (open.place == Place::aliases) text += ": aliases";
  }
  if (const Key* key = open_.empty() ? nullptr : current()) return text + ": " + std::string(key->name);
  return text;
}

bool Reader::key(std::string& name) {
  Open& object = open_.back();
  if (object.place == Place::variable_gaps) {
    const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), gap_);
    const bool whole = status == std::errc() && end == name.data() + name.size() && name == std::to_string(gap_);
    if (!whole || gap_ < 0 || static_cast<std::size_t>(gap_) >= longest_list) {
      throw Error(here() + ": key " + in_quotes(name) + ", wanted the number of a surface");
    }
    if (lens_.zoom->variable_gaps.contains(gap_))
      throw Error(here() + ": key " + in_quotes(name) + " is given twice, wanted once");
    return true;
  }
  const auto table = keys(object.place);
  key_ = -1;
  const auto found = std::find_if(table.begin(), table.end(), [&](const Key& k) { return k.name == name; });
  if (found == table.end()) {
    std::string known;
    for (const Key& k : table) known += (known.empty() ? "" : ", ") + std::string(k.name);
    throw Error(here() + ": key " + in_quotes(name) + " is unknown, wanted one of " + known);
  }
  const auto index = static_cast<int>(found - table.begin());
  const std::uint32_t bit = std::uint32_t{1} << index;
  if (object.seen & bit) throw Error(here() + ": key " + in_quotes(name) + " is given twice, wanted once");
  object.seen |= bit;
  key_ = index;
  return true;
}

bool Reader::assign(Value value) {
  if (open_.empty()) throw Error(where_ + ": document is " + describe(value) + ", wanted an object");
  switch (open_.back().place) {
    case Place::variable_gaps: lens_.zoom->variable_gaps[gap_] = number_of(value); return true;
    case Place::aliases:
      count_entry();
      lens_.aliases.push_back(text_of(value));
      return true;
    case Place::surfaces:
    case Place::aspheric: count_entry(); refuse(describe(value), "an object");
    default: break;
  }
  const Key& key = *current();
  if (key.opens) refuse(describe(value), is_list(*key.opens) ? "a list" : "an object");
  key.set(*this, value);
  return true;
}

void Reader::count_entry() {
  if (open_.back().entries++ < longest_list) return;
  const bool surfaces = open_.back().place == Place::surfaces;
  throw Error(where_ + ": more than " + std::to_string(longest_list) + (surfaces ? " surfaces" : " entries in a list") +
              ", wanted a lens");
}

bool Reader::open(bool list) {
  const std::string found = list ? "a list" : "an object";
  if (open_.empty()) {
    if (list) throw Error(where_ + ": document is a list, wanted an object");
    open_.push_back({Place::file});
    return true;
  }
  const Place outer = open_.back().place;
  std::optional<Place> inner;
  if (is_list(outer)) {
    count_entry();
    if (list || outer == Place::aliases) refuse(found, outer == Place::aliases ? "a text" : "an object");
    inner = outer == Place::surfaces ? Place::surface : Place::term;
  } else if (outer == Place::variable_gaps) {
    refuse(found, "a number");
  } else {
    inner = current()->opens;
    if (!inner) refuse(found, "a plain value");
    if (is_list(*inner) != list) refuse(found, is_list(*inner) ? "a list" : "an object");
  }
  open_.push_back({*inner});
  key_ = -1;
  if (inner == Place::surface) lens_.surfaces.emplace_back();
  if (inner == Place::term) row().aspheric.emplace_back();
  if (inner == Place::zoom) lens_.zoom.emplace();
  return true;
}

bool Reader::close() {
  const Open closed = open_.back();
  key_ = -1;
  const auto table = keys(closed.place);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].required && !(closed.seen & (std::uint32_t{1} << i))) {
      throw Error(here() + ": key \"" + std::string(table[i].name) + "\" is missing");
    }
  }
  open_.pop_back();
  return true;
}

bool Reader::number_integer(std::int64_t n) {
  if (n < -largest_integer || n > largest_integer) refuse(std::to_string(n), wanted_integer);
  return assign(static_cast<double>(n));
}

bool Reader::number_unsigned(std::uint64_t n) {
  if (n > static_cast<std::uint64_t>(largest_integer)) refuse(std::to_string(n), wanted_integer);
  return assign(static_cast<double>(n));
}

bool Reader::number_float(double, const std::string& token) {
  // Read again from the digits: the parser's value went through the C locale's decimal point, and says nothing of a
  // number too small for double.
  std::string digits = token;
  for (char& c : digits) {
    if (!(c >= '0' && c <= '9') && c != '-' && c != '+' && c != 'e' && c != 'E') c = '.';
  }
  double value = 0;
  const auto status = std::from_chars(digits.data(), digits.data() + digits.size(), value).ec;
  if (digits.find_first_of(".eE") == std::string::npos) refuse(shortened(digits), wanted_integer);
  if (status != std::errc()) refuse(shortened(digits), "a number within the range of double");
  return assign(value);
}

bool Reader::parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
  std::string reason = error.what();
  for (const std::string_view prefix : {"] ", ": syntax error "}) {
    if (const auto at = reason.find(prefix); at != std::string::npos) reason.erase(0, at + prefix.size());
  }
  throw Error(where_ + ": byte " + std::to_string(position) + ": not JSON " + shortened(reason, 160));
}

double Reader::number_of(const Value& value) const {
  if (const double* n = std::get_if<double>(&value)) return *n;
  refuse(describe(value), "a number");
}

std::optional<double> Reader::maybe_number(const Value& value) const {
  if (std::holds_alternative<std::nullptr_t>(value)) return {};
  return number_of(value);
}

std::string Reader::text_of(const Value& value) const {
  if (const std::string* text = std::get_if<std::string>(&value)) return *text;
  refuse(describe(value), "a text");
}

std::optional<std::string> Reader::maybe_text(const Value& value) const {
  if (std::holds_alternative<std::nullptr_t>(value)) return {};
  return text_of(value);
}

bool Reader::flag_of(const Value& value) const {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag;
  refuse(describe(value), "true or false");
}

}  // namespace

Prescription parse_prescription(std::string_view json, const std::string& where) {
  // nlohmann's parser takes a zero byte for the end of the text and would not see what follows.
  if (const auto zero = json.find('\0'); zero != std::string_view::npos) {
    throw Error(where + ": byte " + std::to_string(zero + 1) + " is zero, wanted JSON in UTF-8");
  }
  Reader reader(where);
  nlohmann::json::sax_parse(json, &reader);
  Prescription prescription = reader.take();
  validate(prescription, where);
  return prescription;
}

Prescription read_prescription(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be opened, wanted a lens file");
  std::string text;
  std::error_code unknown;
  if (const auto size = std::filesystem::file_size(file, unknown); !unknown) text.reserve(size);
  std::array<char, 65536> block;
  while (stream.read(block.data(), block.size()), stream.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) throw Error(file.string() + ": cannot be read to its end");
  return parse_prescription(text, file.string());
}

}  // namespace petzval
