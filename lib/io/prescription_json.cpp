// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lens_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <system_error>

#include "json.hpp"
#include "missing_apertures.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

using io_detail::describe;
using io_detail::in_quotes;
using io_detail::JsonValue;

constexpr std::string_view format_name = "petzval-lens 1";
constexpr std::size_t longest_list = 10'000;

/// The lists and objects of the format.
enum class Scope {
  file,
  source,
  zoom,
  variable_gaps,
  aliases,
  imported,
  notes,
  warnings,
  warning,
  design,
  aperture,
  fields,
  field,
  wavelengths,
  wavelength,
  object_space,
  surfaces,
  surface,
  aspheric,
  term,
  coating,
  layers,
  layer,
  reflectances,
  reflectance,
  configurations,
  configuration,
  changes,
  change,
  new_medium,
};

/// Kind of the entries of a list; nullopt for strings.
struct ListOf {
  std::optional<Scope> entry;
  const char* word;  ///< name of an entry in messages
};

constexpr std::optional<ListOf> list_of(Scope scope) {
  switch (scope) {
    case Scope::aliases: return ListOf{{}, "aliases"};
    case Scope::notes: return ListOf{{}, "notes"};
    case Scope::warnings: return ListOf{Scope::warning, "warning"};
    case Scope::fields: return ListOf{Scope::field, "field"};
    case Scope::wavelengths: return ListOf{Scope::wavelength, "wavelength"};
    case Scope::surfaces: return ListOf{Scope::surface, "surface"};
    case Scope::aspheric: return ListOf{Scope::term, "aspheric"};
    case Scope::layers: return ListOf{Scope::layer, "layer"};
    case Scope::reflectances: return ListOf{Scope::reflectance, "reflectance"};
    case Scope::configurations: return ListOf{Scope::configuration, "configuration"};
    case Scope::changes: return ListOf{Scope::change, "change"};
    default: return {};
  }
}

constexpr bool is_list(Scope scope) { return list_of(scope).has_value(); }

constexpr std::array aperture_settings{ApertureSetting::entrance_pupil_diameter,
                                       ApertureSetting::f_number,
                                       ApertureSetting::working_f_number,
                                       ApertureSetting::object_na,
                                       ApertureSetting::image_na,
                                       ApertureSetting::stop_size};
constexpr std::array field_kinds{FieldKind::angle_deg, FieldKind::object_height, FieldKind::paraxial_image,
                                 FieldKind::real_image_height};

/// Builds a prescription while nlohmann's parser walks the text.
class Reader : public io_detail::JsonReader {
 public:
  using JsonReader::JsonReader;
  Prescription take() { return std::move(lens_); }

 private:
  struct Key {
    std::string_view name;
    void (*set)(Reader&, const JsonValue&);  ///< for a plain value
    std::optional<Scope> opens = {};         ///< for a list or an object; a key with both functions takes either
    bool required = false;
  };
  struct Open {
    Scope scope;
    std::size_t byte = 0;     ///< of the opening bracket
    std::uint32_t seen = 0;   ///< bits of the keys so far, by index in the table of the place
    std::size_t entries = 0;  ///< number of entries of a list
  };

  static std::span<const Key> keys(Scope scope);
  const Key* current() const { return key_ < 0 ? nullptr : &keys(open_.back().scope)[static_cast<std::size_t>(key_)]; }
  SurfaceRow& row() { return lens_.surfaces.back(); }
  Configuration& configuration() { return lens_.configurations.back(); }
  SurfaceChange& change() { return configuration().changes.back(); }
  Coating& coating() { return *row().coating; }
  DesignField& field() { return lens_.design.fields.back(); }
  Medium& medium() {
    switch (open_.back().scope) {
      case Scope::surface: return row().medium;
      case Scope::new_medium: return *change().medium;
      default: return lens_.object_space;
    }
  }
  int whole_number(const JsonValue& value, int least, int most) const;
  double radius_of(const JsonValue& value) const;
  template <class Enum, std::size_t count>
  Enum one_of(const JsonValue& value, const std::array<Enum, count>& all) const;

  void key(const std::string& name) override;
  void assign(JsonValue value) override;
  void open(bool list) override;
  void close() override;
  std::string here() const override;
  void count_entry();

  Prescription lens_;
  std::vector<Open> open_;
  int key_ = -1;  ///< the last key, by index in the table of the innermost place
  int gap_ = 0;   ///< the last key among the variable gaps
};

std::span<const Reader::Key> Reader::keys(Scope scope) {
  using R = Reader;
  using V = const JsonValue;
  static constexpr std::array<Key, 21> file = {{
      {"format",
       [](R& r, V& v) {
         if (r.text_of(v) != format_name) r.refuse(describe(v), in_quotes(format_name));
       },
       {},
       true},
      {"id", [](R& r, V& v) { r.lens_.id = r.text_of(v); }},
      {"name", [](R& r, V& v) { r.lens_.name = r.text_of(v); }},
      {"source", nullptr, Scope::source},
      {"focal_length_mm", [](R& r, V& v) { r.lens_.focal_length_mm = r.maybe_number(v); }},
      {"f_number", [](R& r, V& v) { r.lens_.f_number = r.maybe_number(v); }},
      {"half_field_deg", [](R& r, V& v) { r.lens_.half_field_deg = r.maybe_number(v); }},
      {"image_diagonal_mm", [](R& r, V& v) { r.lens_.image_diagonal_mm = r.maybe_number(v); }},
      {"reference_wavelength_nm", [](R& r, V& v) { r.lens_.reference_wavelength_nm = r.number_of(v); }},
      {"semi_diameters", [](R& r, V& v) { r.lens_.semi_diameters = r.maybe_text(v); }},
      {"stop_size", [](R& r, V& v) { r.lens_.stop_size = r.maybe_text(v); }},
      {"image_distance", [](R& r, V& v) { r.lens_.image_distance = r.maybe_text(v); }},
      {"glass_names", [](R& r, V& v) { r.lens_.glass_names = r.maybe_text(v); }},
      {"zoom", nullptr, Scope::zoom},
      {"notes", [](R& r, V& v) { r.lens_.notes = r.maybe_text(v); }},
      {"aliases", nullptr, Scope::aliases},
      {"imported", nullptr, Scope::imported},
      {"design", nullptr, Scope::design},
      {"object_space", nullptr, Scope::object_space},
      {"surfaces", nullptr, Scope::surfaces, true},
      {"configurations", nullptr, Scope::configurations},
  }};
  static constexpr std::array<Key, 2> source = {{
      {"design", [](R& r, V& v) { r.lens_.source_design = r.text_of(v); }},
      {"numbers", [](R& r, V& v) { r.lens_.source_numbers = r.text_of(v); }},
  }};
  static constexpr std::array<Key, 2> zoom = {{
      {"position", [](R& r, V& v) { r.configuration().name = r.text_of(v); }},
      {"variable_gaps", nullptr, Scope::variable_gaps},
  }};
  static constexpr std::array<Key, 7> imported = {{
      {"format", [](R& r, V& v) { r.lens_.imported->format = r.text_of(v); }, {}, true},
      {"file", [](R& r, V& v) { r.lens_.imported->file = r.text_of(v); }},
      {"entry", [](R& r, V& v) { r.lens_.imported->entry = r.text_of(v); }},
      {"units", [](R& r, V& v) { r.lens_.imported->units = r.text_of(v); }},
      {"title", [](R& r, V& v) { r.lens_.imported->title = r.text_of(v); }},
      {"notes", nullptr, Scope::notes},
      {"warnings", nullptr, Scope::warnings},
  }};
  static constexpr std::array<Key, 3> warning = {{
      {"line", [](R& r, V& v) { r.lens_.imported->warnings.back().line = r.whole_number(v, 0, 2'000'000'000); }},
      {"command", [](R& r, V& v) { r.lens_.imported->warnings.back().command = r.text_of(v); }},
      {"message", [](R& r, V& v) { r.lens_.imported->warnings.back().message = r.text_of(v); }, {}, true},
  }};
  static constexpr std::array<Key, 6> design = {{
      {"aperture", nullptr, Scope::aperture},
      {"object_distance_mm",
       [](R& r, V& v) {
         r.lens_.design.object_distance_mm = r.maybe_number(v).value_or(std::numeric_limits<double>::infinity());
       }},
      {"field_kind", [](R& r, V& v) { r.lens_.design.field_kind = r.one_of(v, field_kinds); }},
      {"fields", nullptr, Scope::fields},
      {"wavelengths", nullptr, Scope::wavelengths},
      {"primary_wavelength",
       [](R& r, V& v) {
         r.lens_.design.primary_wavelength = static_cast<std::size_t>(r.whole_number(v, 0, longest_list));
       }},
  }};
  static constexpr std::array<Key, 2> aperture = {{
      {"setting", [](R& r, V& v) { r.lens_.design.aperture->setting = r.one_of(v, aperture_settings); }, {}, true},
      {"value", [](R& r, V& v) { r.lens_.design.aperture->value = r.number_of(v); }, {}, true},
  }};
  static constexpr std::array<Key, 8> field = {{
      {"x", [](R& r, V& v) { r.field().x = r.number_of(v); }},
      {"y", [](R& r, V& v) { r.field().y = r.number_of(v); }},
      {"weight", [](R& r, V& v) { r.field().weight = r.number_of(v); }},
      {"decentre_x", [](R& r, V& v) { r.field().decentre_x = r.number_of(v); }},
      {"decentre_y", [](R& r, V& v) { r.field().decentre_y = r.number_of(v); }},
      {"compress_x", [](R& r, V& v) { r.field().compress_x = r.number_of(v); }},
      {"compress_y", [](R& r, V& v) { r.field().compress_y = r.number_of(v); }},
      {"angle_deg", [](R& r, V& v) { r.field().angle_deg = r.number_of(v); }},
  }};
  static constexpr std::array<Key, 2> wavelength = {{
      {"nm", [](R& r, V& v) { r.lens_.design.wavelengths.back().nm = r.number_of(v); }, {}, true},
      {"weight", [](R& r, V& v) { r.lens_.design.wavelengths.back().weight = r.number_of(v); }},
  }};
  static constexpr std::array<Key, 9> configuration = {{
      {"name", [](R& r, V& v) { r.configuration().name = r.text_of(v); }, {}, true},
      {"focus_of", [](R& r, V& v) { r.configuration().focus_of = r.maybe_text(v); }},
      {"subject_distance_mm", [](R& r, V& v) { r.configuration().subject_distance_mm = r.maybe_number(v); }},
      {"stop", [](R& r, V& v) { r.configuration().stop = r.whole_number(v, 0, longest_list); }},
      {"focal_length_mm", [](R& r, V& v) { r.configuration().focal_length_mm = r.maybe_number(v); }},
      {"f_number", [](R& r, V& v) { r.configuration().f_number = r.maybe_number(v); }},
      {"half_field_deg", [](R& r, V& v) { r.configuration().half_field_deg = r.maybe_number(v); }},
      {"image_diagonal_mm", [](R& r, V& v) { r.configuration().image_diagonal_mm = r.maybe_number(v); }},
      {"changes", nullptr, Scope::changes},
  }};
  static constexpr std::array<Key, 6> change = {{
      {"surface", [](R& r, V& v) { r.change().surface = r.whole_number(v, 0, longest_list); }, {}, true},
      {"thickness", [](R& r, V& v) { r.change().thickness = r.number_of(v); }},
      {"radius", [](R& r, V& v) { r.change().radius = r.radius_of(v); }},
      {"conic", [](R& r, V& v) { r.change().conic = r.number_of(v); }},
      {"semi_diameter", [](R& r, V& v) { r.change().semi_diameter = r.number_of(v); }},
      {"medium", nullptr, Scope::new_medium},
  }};
  // The keys of the medium come first: they are the only keys of object_space.
  static constexpr std::array<Key, 17> surface = {{
      {"glass", [](R& r, V& v) { r.medium().glass = r.maybe_text(v); }},
      {"catalogue", [](R& r, V& v) { r.medium().catalogue = r.maybe_text(v); }},
      {"glass_origin", [](R& r, V& v) { r.medium().glass_origin = r.maybe_text(v); }},
      {"nd", [](R& r, V& v) { r.medium().nd = r.maybe_number(v); }},
      {"vd", [](R& r, V& v) { r.medium().vd = r.maybe_number(v); }},
      {"radius", [](R& r, V& v) { r.row().radius = r.radius_of(v); }, {}, true},
      {"thickness", [](R& r, V& v) { r.row().thickness = r.number_of(v); }, {}, true},
      {"semi_diameter", [](R& r, V& v) { r.row().semi_diameter = r.maybe_number(v); }},
      {"semi_diameter_computed", [](R& r, V& v) { r.row().semi_diameter_computed = r.flag_of(v); }},
      {"inner_semi_diameter", [](R& r, V& v) { r.row().obscuration_semi_diameter = r.maybe_number(v); }},
      {"conic", [](R& r, V& v) { r.row().conic = r.number_of(v); }},
      {"aspheric", nullptr, Scope::aspheric},
      {"stop", [](R& r, V& v) { r.row().stop = r.flag_of(v); }},
      {"mirror", [](R& r, V& v) { r.row().mirror = r.flag_of(v); }},
      {"curved_in",
       [](R& r, V& v) {
         const std::string section = r.text_of(v);
         if (section != "x" && section != "y") r.refuse(describe(v), R"("x" or "y")");
         r.row().curved_in = section == "x" ? Section::x : Section::y;
       }},
      {"comment", [](R& r, V& v) { r.row().comment = r.maybe_text(v); }},
      {"coating",
       [](R& r, V& v) {
         const auto* word = std::get_if<std::string>(&v);
         if (!word || (*word != "none" && *word != "mgf2")) r.refuse(describe(v), R"("none", "mgf2" or an object)");
         r.row().coating = *word == "none" ? Coating{} : Coating::quarter_wave();
       },
       Scope::coating},
  }};
  static constexpr std::array<Key, 2> term = {{
      {"order", [](R& r, V& v) { r.row().aspheric.back().order = r.whole_number(v, 2, 40); }, {}, true},
      {"coefficient", [](R& r, V& v) { r.row().aspheric.back().coefficient = r.number_of(v); }, {}, true},
  }};
  static constexpr std::array<Key, 2> coating = {{
      {"layers", nullptr, Scope::layers},
      {"reflectance", nullptr, Scope::reflectances},
  }};
  static constexpr std::array<Key, 3> layer = {{
      {"index", [](R& r, V& v) { r.coating().layers.back().index = r.number_of(v); }, {}, true},
      {"absorption", [](R& r, V& v) { r.coating().layers.back().absorption = r.number_of(v); }},
      {"thickness_nm", [](R& r, V& v) { r.coating().layers.back().thickness_nm = r.number_of(v); }, {}, true},
  }};
  static constexpr std::array<Key, 2> reflectance = {{
      {"wavelength_nm", [](R& r, V& v) { r.coating().table.back().wavelength_nm = r.number_of(v); }, {}, true},
      {"value", [](R& r, V& v) { r.coating().table.back().reflectance = r.number_of(v); }, {}, true},
  }};
  switch (scope) {
    case Scope::file: return file;
    case Scope::source: return source;
    case Scope::zoom: return zoom;
    case Scope::imported: return imported;
    case Scope::warning: return warning;
    case Scope::design: return design;
    case Scope::aperture: return aperture;
    case Scope::field: return field;
    case Scope::wavelength: return wavelength;
    case Scope::object_space:
    case Scope::new_medium: return std::span(surface).first(5);
    case Scope::surface: return surface;
    case Scope::term: return term;
    case Scope::coating: return coating;
    case Scope::layer: return layer;
    case Scope::reflectance: return reflectance;
    case Scope::configuration: return configuration;
    case Scope::change: return change;
    default: return {};
  }
}

/// The position in words: surface, term and key.
std::string Reader::here() const {
  std::string text;
  const auto add = [&text](std::string_view word) { text += (text.empty() ? "" : ": ") + std::string(word); };
  for (const Open& open : open_) {
    switch (open.scope) {
      case Scope::source: add("source"); break;
      case Scope::zoom: add("zoom"); break;
      case Scope::variable_gaps: add("variable_gaps"); break;
      case Scope::imported: add("imported"); break;
      case Scope::design: add("design"); break;
      case Scope::aperture: add("aperture"); break;
      case Scope::object_space: add("object_space"); break;
      case Scope::new_medium: add("medium"); break;
      case Scope::coating: add("coating"); break;
      default:
        if (const auto list = list_of(open.scope)) {
          add(list->word + (list->entry ? ' ' + std::to_string(open.entries - 1) : std::string()));
        }
    }
  }
  if (const Key* key = open_.empty() ? nullptr : current()) add(key->name);
  return text;
}

void Reader::key(const std::string& name) {
  Open& object = open_.back();
  if (object.scope == Scope::variable_gaps) {
    const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), gap_);
    const bool whole = status == std::errc() && end == name.data() + name.size() && name == std::to_string(gap_);
    if (!whole || gap_ < 0 || static_cast<std::size_t>(gap_) >= longest_list) {
      fail("key " + in_quotes(name) + " must be the number of a surface");
    }
    if (std::ranges::find(configuration().changes, gap_, &SurfaceChange::surface) != configuration().changes.end())
      fail("key " + in_quotes(name) + " is given twice; must be given once");
    return;
  }
  const auto table = keys(object.scope);
  key_ = -1;
  const auto found = std::find_if(table.begin(), table.end(), [&](const Key& k) { return k.name == name; });
  if (found == table.end()) {
    std::string known;
    for (const Key& k : table) known += (known.empty() ? "" : ", ") + std::string(k.name);
    fail("key " + in_quotes(name) + " is unknown; must be one of " + known);
  }
  const auto index = static_cast<int>(found - table.begin());
  const std::uint32_t bit = std::uint32_t{1} << index;
  if (object.seen & bit) fail("key " + in_quotes(name) + " is given twice; must be given once");
  object.seen |= bit;
  key_ = index;
}

void Reader::assign(JsonValue value) {
  if (open_.empty()) refuse_kind(describe(value), "an object");
  switch (open_.back().scope) {
    case Scope::variable_gaps: {
      const double thickness = number_of(value);
      SurfaceChange& change = configuration().changes.emplace_back();
      change.surface = gap_, change.thickness = thickness;
      return;
    }
    case Scope::aliases:
      count_entry();
      lens_.aliases.push_back(text_of(value));
      return;
    case Scope::notes:
      count_entry();
      lens_.imported->notes.push_back(text_of(value));
      return;
    default: break;
  }
  if (is_list(open_.back().scope)) {
    count_entry();
    refuse_kind(describe(value), "an object");
  }
  const Key& key = *current();
  if (!key.set) refuse_kind(describe(value), is_list(*key.opens) ? "a list" : "an object");
  key.set(*this, value);
}

void Reader::count_entry() {
  if (open_.back().entries++ < longest_list) return;
  const bool surfaces = open_.back().scope == Scope::surfaces;
  throw Error(where_ + ": more than " + std::to_string(longest_list) + (surfaces ? " surfaces" : " entries in a list") +
              "; must be fewer");
}

void Reader::open(bool list) {
  const std::string found = list ? "a list" : "an object";
  if (open_.empty()) {
    if (list) refuse_kind(found, "an object");
    open_.push_back({Scope::file, byte()});
    return;
  }
  const Scope outer = open_.back().scope;
  std::optional<Scope> inner;
  if (is_list(outer)) {
    count_entry();
    inner = list_of(outer)->entry;
    if (list || !inner) refuse_kind(found, inner ? "an object" : "a string");
  } else if (outer == Scope::variable_gaps) {
    refuse_kind(found, "a number");
  } else {
    inner = current()->opens;
    if (!inner) refuse_kind(found, "a plain value");
    if (is_list(*inner) != list) refuse_kind(found, is_list(*inner) ? "a list" : "an object");
  }
  if ((*inner == Scope::zoom || *inner == Scope::configurations) && !lens_.configurations.empty()) {
    fail(R"("zoom" and "configurations" are given; must be one of the two)");
  }
  open_.push_back({*inner, byte()});
  key_ = -1;
  switch (*inner) {
    case Scope::surface: lens_.surfaces.emplace_back(); break;
    case Scope::term: row().aspheric.emplace_back(); break;
    case Scope::coating: row().coating.emplace(); break;
    case Scope::layer: coating().layers.emplace_back(); break;
    case Scope::reflectance: coating().table.emplace_back(); break;
    case Scope::zoom: lens_.configurations.push_back({.name = "zoom"}); break;
    case Scope::imported: lens_.imported.emplace(); break;
    case Scope::warning: lens_.imported->warnings.emplace_back(); break;
    case Scope::aperture: lens_.design.aperture.emplace(); break;
    case Scope::field: lens_.design.fields.emplace_back(); break;
    case Scope::wavelength: lens_.design.wavelengths.emplace_back(); break;
    case Scope::configuration: lens_.configurations.emplace_back(); break;
    case Scope::change: configuration().changes.emplace_back(); break;
    case Scope::new_medium: change().medium.emplace(); break;
    default: break;
  }
}

int Reader::whole_number(const JsonValue& value, int least, int most) const {
  const double number = number_of(value);
  if (number >= least && number <= most && number == std::floor(number)) return static_cast<int>(number);
  refuse(describe(value), "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

double Reader::radius_of(const JsonValue& value) const {
  if (const double* radius = std::get_if<double>(&value)) return *radius;
  refuse(describe(value), "a number (0 for a plane)");
}

template <class Enum, std::size_t count>
Enum Reader::one_of(const JsonValue& value, const std::array<Enum, count>& all) const {
  const std::string text = text_of(value);
  std::string known;
  for (const Enum entry : all) {
    if (name(entry) == text) return entry;
    known += (known.empty() ? "" : ", ") + std::string(name(entry));
  }
  refuse(describe(value), "one of " + known);
}

void Reader::close() {
  const Open closed = open_.back();
  key_ = -1;
  const auto table = keys(closed.scope);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].required && !(closed.seen & (std::uint32_t{1} << i))) {
      std::string message = "key " + in_quotes(table[i].name) + " is missing";
      if (table[i].name == "format" && closed.scope == Scope::file) message += "; must be " + in_quotes(format_name);
      fail(closed.byte, message);
    }
  }
  if (closed.scope == Scope::coating && coating() == Coating{}) {
    fail(closed.byte, R"(must have entries in "layers" or "reflectance"; an uncoated surface is "none")");
  }
  open_.pop_back();
}

/// The path in the document named by a message of validate(): "surfaces[1].nd" for "surface 1: nd = 9".
std::string path_of(std::string_view message) {
  std::string path;
  const auto add = [&path](std::string_view key) { path += (path.empty() ? "" : ".") + std::string(key); };
  for (std::size_t end = message.find(": "); end != std::string_view::npos; end = message.find(": ")) {
    const std::string_view part = message.substr(0, end);
    const std::size_t blank = part.find(' ');
    add(part.substr(0, blank));
    if (blank != std::string_view::npos) path += "s[" + std::string(part.substr(blank + 1)) + ']';
    message.remove_prefix(end + 2);
  }
  add(message.substr(0, message.find(' ')));
  return path;
}

}  // namespace

Prescription parse_prescription(std::string_view json, const std::string& where) {
  Reader reader(where);
  reader.parse(json);
  Prescription prescription = reader.take();
  try {
    validate(prescription, where);
  } catch (const Error& error) {
    std::string_view message = error.what();
    if (!message.starts_with(where + ": ")) throw;
    message.remove_prefix(where.size() + 2);
    throw Error(where + io_detail::json_position(json, path_of(message)) + ": " + std::string(message));
  }
  return prescription;
}

Prescription read_prescription(const std::filesystem::path& file) {
  const std::string text = read_file(file, "a lens file");
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] != '{') {
    throw Error(file.string() +
                ": is not JSON; must be a lens file of petzval (read_lens() reads files of other programs)");
  }
  return io_detail::with_missing_apertures(parse_prescription(text, file.string()));
}

}  // namespace petzval
