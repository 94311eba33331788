// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lens_json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <system_error>

#include "json.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0 {
namespace {

using io_detail::describe;
using io_detail::in_quotes;
using io_detail::JsonValue;

constexpr std::string_view format_name = "petzval-lens 1";
constexpr std::size_t longest_list = 10'000;

/// The lists and objects of the format.
enum class Place { file, source, zoom, variable_gaps, aliases, object_space, surfaces, surface, aspheric, term };

constexpr bool is_list(Place place) {
  return place == Place::aliases || place == Place::surfaces || place == Place::aspheric;
}

/// Builds a prescription while nlohmann's parser walks the text.
class Reader : public io_detail::JsonReader {
 public:
  using JsonReader::JsonReader;
  Prescription take() { return std::move(lens_); }

 private:
  struct Key {
    std::string_view name;
    void (*set)(Reader&, const JsonValue&);  ///< for a plain value
    std::optional<Place> opens = {};         ///< for a list or an object
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

  void key(const std::string& name) override;
  void assign(JsonValue value) override;
  void open(bool list) override;
  void close() override;
  std::string here() const override;
  void count_entry();

  Prescription lens_;
  std::vector<Open> open_;
  int key_ = -1;  ///< the key just read, by number in the table of the innermost place
  int gap_ = 0;   ///< the key just read among the variable gaps
};

std::span<const Reader::Key> Reader::keys(Place place) {
  using R = Reader;
  using V = const JsonValue;
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
  // The keys of the medium come first: object_space has only these.
  static constexpr std::array<Key, 14> surface = {{
      {"glass", [](R& r, V& v) { r.medium().glass = r.maybe_text(v); }},
      {"catalogue", [](R& r, V& v) { r.medium().catalogue = r.maybe_text(v); }},
      {"glass_origin", [](R& r, V& v) { r.medium().glass_origin = r.maybe_text(v); }},
      {"nd", [](R& r, V& v) { r.medium().nd = r.number_of(v); }, {}, true},
      {"vd", [](R& r, V& v) { r.medium().vd = r.maybe_number(v); }},
      {"radius", [](R& r, V& v) { r.row().radius = r.number_of(v); }, {}, true},
      {"thickness", [](R& r, V& v) { r.row().thickness = r.number_of(v); }, {}, true},
      {"semi_diameter", [](R& r, V& v) { r.row().semi_diameter = r.maybe_number(v); }},
      {"inner_semi_diameter", [](R& r, V& v) { r.row().obscuration_semi_diameter = r.maybe_number(v); }},
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

void Reader::key(const std::string& name) {
  Open& object = open_.back();
  if (object.place == Place::variable_gaps) {
    const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), gap_);
    const bool whole = status == std::errc() && end == name.data() + name.size() && name == std::to_string(gap_);
    if (!whole || gap_ < 0 || static_cast<std::size_t>(gap_) >= longest_list) {
      throw Error(here() + ": key " + in_quotes(name) + ", wanted the number of a surface");
    }
    if (lens_.zoom->variable_gaps.contains(gap_))
      throw Error(here() + ": key " + in_quotes(name) + " is given twice, wanted once");
    return;
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
}

void Reader::assign(JsonValue value) {
  if (open_.empty()) throw Error(where_ + ": document is " + describe(value) + ", wanted an object");
  switch (open_.back().place) {
    case Place::variable_gaps: lens_.zoom->variable_gaps[gap_] = number_of(value); return;
    case Place::aliases:
      count_entry();
      lens_.aliases.push_back(text_of(value));
      return;
    case Place::surfaces:
    case Place::aspheric: count_entry(); refuse(describe(value), "an object");
    default: break;
  }
  const Key& key = *current();
  if (key.opens) refuse(describe(value), is_list(*key.opens) ? "a list" : "an object");
  key.set(*this, value);
}

void Reader::count_entry() {
  if (open_.back().entries++ < longest_list) return;
  const bool surfaces = open_.back().place == Place::surfaces;
  throw Error(where_ + ": more than " + std::to_string(longest_list) + (surfaces ? " surfaces" : " entries in a list") +
              ", wanted fewer");
}

void Reader::open(bool list) {
  const std::string found = list ? "a list" : "an object";
  if (open_.empty()) {
    if (list) throw Error(where_ + ": document is a list, wanted an object");
    open_.push_back({Place::file});
    return;
  }
  const Place outer = open_.back().place;
  std::optional<Place> inner;
  if (is_list(outer)) {
    count_entry();
    if (list || outer == Place::aliases) refuse(found, outer == Place::aliases ? "a string" : "an object");
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
}

void Reader::close() {
  const Open closed = open_.back();
  key_ = -1;
  const auto table = keys(closed.place);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].required && !(closed.seen & (std::uint32_t{1} << i))) {
      throw Error(here() + ": key \"" + std::string(table[i].name) + "\" is missing");
    }
  }
  open_.pop_back();
}

}  // namespace

Prescription parse_prescription(std::string_view json, const std::string& where) {
  Reader reader(where);
  reader.parse(json);
  Prescription prescription = reader.take();
  validate(prescription, where);
  return prescription;
}

Prescription read_prescription(const std::filesystem::path& file) {
  return parse_prescription(io_detail::read_text(file, "a lens file"), file.string());
}

}  // namespace petzval::inline v0
