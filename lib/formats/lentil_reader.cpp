// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <vector>

#include "core/text.hpp"
#include "io/json.hpp"
#include "json_object.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

constexpr std::array<const char*, 3> positions = {"short", "middle", "long"};

/// A member of a lens as text, whatever its type; empty if it is absent.
std::string text_of(const nlohmann::json& lens, const char* name) {
  const auto found = lens.is_object() ? lens.find(name) : lens.end();
  if (found == lens.end() || found->is_null()) return {};
  return found->is_string() ? found->get<std::string>() : found->dump();
}

std::string title_of(const nlohmann::json& lens) {
  std::string title;
  for (const char* part : {"company", "product-name", "year"}) {
    if (const std::string word = text_of(lens, part); !word.empty()) append(title, " ", word);
  }
  return title;
}

/// A lens of a database and its key.
struct Entry {
  std::string key;
  const nlohmann::json* lens = nullptr;
};

/// The lenses of a database with a key; if there is no such key, the lenses with this name.
std::vector<Entry> entries_of(const nlohmann::json& database, const std::string& word) {
  std::vector<Entry> by_key, by_name;
  for (const auto& [key, lens] : database.items()) {
    if (same(key, word)) by_key.push_back({key, &lens});
    if (same(text_of(lens, "product-name"), word) || same(title_of(lens), word)) by_name.push_back({key, &lens});
  }
  return by_key.empty() ? by_name : by_key;
}

/// "1 (angenieux double-gauss 1953), 2 (...)", limited to the length of messages.
std::string listed(const nlohmann::json& database) {
  constexpr std::size_t max_list_size = 4000;
  std::string list;
  for (const auto& [key, lens] : database.items()) {
    if (list.size() > max_list_size) return list + ", ...";
    append(list, ", ", beginning(key, 60));
    if (const std::string title = title_of(lens); !title.empty())
      list += " (" + std::string(beginning(title, 80)) + ')';
  }
  return list;
}

class LentilReader {
 public:
  explicit LentilReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  Entry choose(const nlohmann::json& database) const;
  void lens(const JsonObject& o);
  void element(const JsonObject& e);
  void thickness(const JsonObject& e, SurfaceRow& row);

  Import& in_;
};

/// Reads one number, or three: for the short, middle and long end of a zoom lens.
void LentilReader::thickness(const JsonObject& e, SurfaceRow& row) {
  const nlohmann::json* value = e.find("thickness");
  if (!value || !value->is_array()) {
    row.thickness = e.needed("thickness");
    return;
  }
  const bool three =
      value->size() == 3 && (*value)[0].is_number() && (*value)[1].is_number() && (*value)[2].is_number();
  if (!three) e.refuse("thickness", shown(*value), "a number or a list of three numbers");
  row.thickness = (*value)[0].get<double>();
  auto& list = in_.lens.configurations;
  if (list.empty()) {
    list.resize(3);
    for (std::size_t i = 0; i < 3; ++i) list[i].name = positions[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    SurfaceChange& change = list[i].changes.emplace_back();
    change.surface = static_cast<int>(in_.lens.surfaces.size());
    change.thickness = (*value)[i].get<double>();
  }
}

void LentilReader::element(const JsonObject& e) {
  SurfaceRow row;
  row.radius = e.needed("radius");
  thickness(e, row);
  const std::string material = lower(e.text("material")), geometry = lower(e.text("lens-geometry"));
  const Medium before = in_.lens.surfaces.empty() ? in_.lens.object_space : in_.lens.surfaces.back().medium;
  row.stop = material == "iris";
  if (row.stop) {
    row.medium = before;
    row.radius = 0;
  } else if (material != "air") {
    row.medium.nd = e.needed("ior");
    if (const double vd = e.number("abbe").value_or(0); vd > 0) row.medium.vd = vd;
    const bool is_name = !material.empty() && material != "glass" && material != "none" && material != "abbe";
    if (is_name) row.medium.glass = e.text("material");
  }
  if (row.radius != 0 && std::abs(row.radius) >= 9999) row.radius = geometry == "planar" ? 0 : row.radius;
  const double rim = e.number("housing-radius").value_or(0);
  if (rim > 0) row.semi_diameter = rim;
  const nlohmann::json* asphere = e.find("aspherical-equation");
  if (geometry == "aspherical" || (asphere && asphere->is_array())) {
    e.refuse("lens-geometry", "aspherical",
             "spherical, planar, cyl-x or cyl-y: the format does not define its coefficients");
  }
  // The letter names the axis of the cylinder: the normals of cyl-y have no y component.
  if (geometry == "cyl-y") {
    row.curved_in = Section::x;
  } else if (geometry == "cyl-x") {
    row.curved_in = Section::y;
  } else if (!geometry.empty() && geometry != "spherical" && geometry != "planar") {
    e.refuse("lens-geometry", io_detail::in_quotes(geometry), "spherical, planar, cyl-x or cyl-y");
  }
  e.name_others(
      {"radius", "thickness", "material", "ior", "abbe", "housing-radius", "lens-geometry", "aspherical-equation"});
  in_.lens.surfaces.push_back(std::move(row));
}

void LentilReader::lens(const JsonObject& o) {
  const nlohmann::json* adjusted = o.find("optical-elements-adjusted");
  const bool has_adjusted = adjusted && adjusted->is_array() && !adjusted->empty();
  const char* key = has_adjusted ? "optical-elements-adjusted" : "optical-elements-patent";
  const nlohmann::json* elements = o.find(key);
  if (!elements || !elements->is_array()) o.refuse(key, elements ? "no list" : "missing", "a list of surfaces");
  in_.limit(elements->size());
  if (has_adjusted && o.find("optical-elements-patent")) {
    in_.warn(0, "optical-elements-patent", "is left out, as optical-elements-adjusted is given");
  }
  for (std::size_t i = 0; i < elements->size(); ++i) {
    element(o.entry(std::string(key) + '[' + std::to_string(i) + ']', (*elements)[i]));
  }
  in_.lens.imported->title = title_of(o.json);
  if (const std::string patent = text_of(o.json, "patent-number"); !patent.empty()) in_.lens.source_design = patent;
  for (const char* note : {"notes", "lens-type", "photographic-description"}) {
    if (const std::string word = text_of(o.json, note); !word.empty()) in_.lens.imported->notes.push_back(word);
  }
  for (const char* name : {"focal-length-mm-raytraced", "focal-length-mm-patent"}) {
    const nlohmann::json* value = o.find(name);
    if (value && value->is_number() && !in_.lens.focal_length_mm) in_.lens.focal_length_mm = value->get<double>();
  }
  const nlohmann::json* f_number = o.find("fstop");
  if (f_number && f_number->is_number() && f_number->get<double>() > 0) in_.lens.f_number = f_number->get<double>();
  in_.lens.semi_diameters = "housing radii";
  o.name_others({"company", "product-name", "year", "patent-number", "notes", "lens-type", "photographic-description",
                 "focal-length-mm-raytraced", "focal-length-mm-patent", "fstop", "optical-elements-patent",
                 "optical-elements-adjusted", "production-status", "production-ready", "commercial", "prime",
                 "patent-location", "polynomial-optics", "implementation-version"});
}

/// The lens of a database named by the options; the only lens if the database has a single lens.
Entry LentilReader::choose(const nlohmann::json& database) const {
  const std::string& entry_name = in_.entry();
  const auto found = entry_name.empty() ? std::vector<Entry>() : entries_of(database, entry_name);
  if (found.size() == 1) return found.front();
  if (database.size() == 1) return {database.begin().key(), &*database.begin()};
  const std::string rule = "; must be the key of one of " + std::to_string(database.size()) + ": " + listed(database);
  if (entry_name.empty()) throw Error(in_.where() + ": no lens is chosen (--configuration)" + rule);
  throw Error(in_.where() + ": --configuration = " + io_detail::in_quotes(entry_name) +
              (found.empty() ? "" : ", the name of " + std::to_string(found.size()) + " lenses") + rule);
}

void LentilReader::read(std::string_view text) {
  const io_detail::JsonTree tree(text, in_.where(), words_of_path);
  const nlohmann::json& document = tree.root();
  if (!document.is_object()) tree.refuse("", shown(document), "an object");
  if (document.contains("optical-elements-patent") || document.contains("optical-elements-adjusted")) {
    return lens({document, "file", in_, tree});
  }
  const Entry entry = choose(document);
  if (!entry.lens->is_object()) tree.refuse(entry.key, shown(*entry.lens), "a lens");
  if (document.size() > 1 || !entries_of(document, in_.entry()).empty()) in_.lens.imported->entry = entry.key;
  lens({*entry.lens, entry.key, in_, tree});
}

}  // namespace

bool is_lentil(std::string_view text) {
  return trimmed(text).starts_with('{') && (text.find("\"optical-elements-patent\"") != std::string_view::npos ||
                                            text.find("\"optical-elements-adjusted\"") != std::string_view::npos);
}

void read_lentil(std::string_view text, Import& in) { LentilReader(in).read(text); }

}  // namespace petzval::formats_detail
