// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <system_error>

#include "json_members.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/io/json.hpp"
#include "petzval/pupil/apertures.hpp"

namespace petzval {
namespace io_detail {

constexpr std::string_view lens_format = "petzval-lens 1";
constexpr int most_entries = 10'000;
constexpr Range list_index{0, most_entries, "a whole number from 0 to 10000"};
constexpr Range order_rule{2, 40, "a whole number from 2 to 40"},
    line_rule{0, 2e9, "a whole number from 0 to 2000000000"};
constexpr Range radius_rule{any_number.least, any_number.most, "a number (0 for a plane)"};
constexpr Range distance_rule{any_number.least, std::numeric_limits<double>::infinity(),
                              "a number, or null for infinity"};
constexpr std::array aperture_settings{ApertureSetting::entrance_pupil_diameter,
                                       ApertureSetting::f_number,
                                       ApertureSetting::working_f_number,
                                       ApertureSetting::object_na,
                                       ApertureSetting::image_na,
                                       ApertureSetting::stop_size};
constexpr std::array field_kinds{FieldKind::angle_deg, FieldKind::object_height, FieldKind::paraxial_image,
                                 FieldKind::real_image_height};
constexpr std::array curved_sections{Section::x, Section::y};

template <Is<Medium> S, class Of>
void members(S& medium, const Of& of) {
  of("glass", medium.glass, any_number, Presence::or_null), of("catalogue", medium.catalogue);
  of("glass_origin", medium.glass_origin);
  if constexpr (std::is_const_v<S>) {  // air is written with its index
    of("nd", medium.is_air() ? std::optional(medium.nd.value_or(1)) : medium.nd);
  } else {
    of("nd", medium.nd);
  }
  of("vd", medium.vd, any_number, Presence::or_null);
}
template <Is<ImportWarning> S, class Of>
void members(S& warning, const Of& of) {
  of("line", warning.line, line_rule), of("command", warning.command);
  of("message", warning.message, any_number, Presence::needed);
}
template <Is<FileOrigin> S, class Of>
void members(S& from, const Of& of) {
  of("format", from.format, any_number, Presence::needed), of("file", from.file);
  of.unless_default("entry", from.entry), of("units", from.units), of("title", from.title);
  of("notes", from.notes), of("warnings", from.warnings);
}
template <Is<DesignAperture> S, class Of>
void members(S& aperture, const Of& of) {
  of("setting", aperture.setting, aperture_settings, Presence::needed);
  of("value", aperture.value, any_number, Presence::needed);
}
template <Is<DesignField> S, class Of>
void members(S& field, const Of& of) {
  of("x", field.x), of("y", field.y), of("weight", field.weight);
  of.unless_default("decentre_x", field.decentre_x);
  of.unless_default("decentre_y", field.decentre_y);
  of.unless_default("compress_x", field.compress_x);
  of.unless_default("compress_y", field.compress_y);
  of.unless_default("angle_deg", field.angle_deg);
}
template <Is<DesignWavelength> S, class Of>
void members(S& wavelength, const Of& of) {
  of("nm", wavelength.nm, any_number, Presence::needed), of("weight", wavelength.weight);
}
template <Is<DesignData> S, class Of>
void members(S& design, const Of& of) {
  of("aperture", design.aperture), of("object_distance_mm", design.object_distance_mm, distance_rule);
  of("field_kind", design.field_kind, field_kinds), of("fields", design.fields);
  of("wavelengths", design.wavelengths), of("primary_wavelength", design.primary_wavelength, list_index);
}
template <Is<AsphereTerm> S, class Of>
void members(S& term, const Of& of) {
  of("order", term.order, order_rule, Presence::needed);
  of("coefficient", term.coefficient, any_number, Presence::needed);
}
template <Is<CoatingLayer> S, class Of>
void members(S& layer, const Of& of) {
  of("index", layer.index, any_number, Presence::needed);
  of.unless_default("absorption", layer.absorption);
  of("thickness_nm", layer.thickness_nm, any_number, Presence::needed);
}
template <Is<ReflectanceEntry> S, class Of>
void members(S& entry, const Of& of) {
  of("wavelength_nm", entry.wavelength_nm, any_number, Presence::needed);
  of("value", entry.reflectance, any_number, Presence::needed);
}
template <Is<Coating> S, class Of>
void members(S& coating, const Of& of) {
  of.unless_default("layers", coating.layers);
  of.unless_default("reflectance", coating.table);
}
template <Is<SurfaceRow> S, class Of>
void members(S& row, const Of& of) {
  of("radius", row.radius, radius_rule, Presence::needed), of("thickness", row.thickness, any_number, Presence::needed);
  members(row.medium, of);
  of("semi_diameter", row.semi_diameter, any_number, Presence::or_null);
  of.unless_default("semi_diameter_computed", row.semi_diameter_computed);
  of("inner_semi_diameter", row.obscuration_semi_diameter), of("conic", row.conic), of("aspheric", row.aspheric);
  of("stop", row.stop), of.unless_default("mirror", row.mirror), of("comment", row.comment);
  of.unless_default("curved_in", row.curved_in, curved_sections), of("coating", row.coating);
}
template <Is<SurfaceChange> S, class Of>
void members(S& change, const Of& of) {
  of("surface", change.surface, list_index, Presence::needed);
  of("thickness", change.thickness, any_number, Presence::not_null);
  of("radius", change.radius, radius_rule, Presence::not_null),
      of("conic", change.conic, any_number, Presence::not_null);
  of("semi_diameter", change.semi_diameter, any_number, Presence::not_null), of("medium", change.medium);
}
template <Is<Configuration> S, class Of>
void members(S& configuration, const Of& of) {
  of("name", configuration.name, any_number, Presence::needed), of("focus_of", configuration.focus_of);
  of("subject_distance_mm", configuration.subject_distance_mm), of("stop", configuration.stop, list_index);
  of("focal_length_mm", configuration.focal_length_mm), of("f_number", configuration.f_number);
  of("half_field_deg", configuration.half_field_deg), of("image_diagonal_mm", configuration.image_diagonal_mm);
  of("changes", configuration.changes);
}
template <Is<Prescription> S, class Of>
void members(S& lens, const Of& of) {
  of("id", lens.id), of("name", lens.name);
  of.object("source", [&lens](const auto& source) {
    source("design", lens.source_design), source("numbers", lens.source_numbers);
  });
  of("focal_length_mm", lens.focal_length_mm, any_number, Presence::or_null);
  of("f_number", lens.f_number, any_number, Presence::or_null);
  of("half_field_deg", lens.half_field_deg, any_number, Presence::or_null);
  of("image_diagonal_mm", lens.image_diagonal_mm, any_number, Presence::or_null);
  of("reference_wavelength_nm", lens.reference_wavelength_nm), of("semi_diameters", lens.semi_diameters);
  of("stop_size", lens.stop_size), of("image_distance", lens.image_distance), of("glass_names", lens.glass_names);
  of("notes", lens.notes), of.unless_default("aliases", lens.aliases);
  of("imported", lens.imported), of.unless_default("design", lens.design);
  of.unless_default("object_space", lens.object_space);
  of("surfaces", lens.surfaces, any_number, Presence::needed);
  of.unless_default("configurations", lens.configurations);
}

namespace {

/// The old form of a zoom position: a name, and thicknesses by the numbers of surfaces.
void read_zoom(const JsonPart& part, std::vector<Configuration>& list) {
  Configuration& zoom = list.emplace_back(Configuration{.name = "zoom"});
  const auto gaps = [&](const JsonPart& object) {
    object.each_member([&](const std::string& key, const JsonPart& thickness) {
      int surface = -1;
      const auto status = std::from_chars(key.data(), key.data() + key.size(), surface).ec;
      if (status != std::errc() || key != std::to_string(surface) || surface < 0 || surface >= most_entries) {
        object.fail("key " + in_quotes(key) + " must be the number of a surface");
      }
      SurfaceChange& change = zoom.changes.emplace_back();
      change.surface = surface, change.thickness = thickness.number();
    });
  };
  part.read({{"position", zoom.name}, {"variable_gaps", gaps}});
  std::ranges::sort(zoom.changes, {}, &SurfaceChange::surface);
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

/// Keys whose members or entries stand in lines of their own.
constexpr std::array<std::string_view, 17> keys_in_lines{
    "source",   "imported", "design",  "surfaces",     "aliases",        "notes",
    "warnings", "fields",   "changes", "wavelengths",  "configurations", "prescription",
    "glasses",  "lens",     "film",    "focal_points", "camera"};

/// Appends a value. depth: of its lines, for their indentation.
void append(std::string& text, const OrderedJson& json, bool in_lines, std::size_t depth) {
  const std::vector<OrderedJson>& entries = json.entries();
  if (entries.empty()) return void(text += json.text());
  const bool object = json.kind() == OrderedJson::Kind::object;
  const std::string margin = in_lines ? "\n" + std::string(2 * depth + 2, ' ') : "";
  text += object ? '{' : '[';
  for (std::size_t i = 0; i < entries.size(); ++i) {
    text += (i == 0 ? "" : in_lines ? "," : ", ") + margin;
    if (object) text += '"' + json.keys()[i] + "\": ";
    const bool lines = object && std::ranges::find(keys_in_lines, json.keys()[i]) != keys_in_lines.end();
    append(text, entries[i], lines, depth + (in_lines ? 1 : 0));
  }
  if (in_lines) text += "\n" + std::string(2 * depth, ' ');
  text += object ? '}' : ']';
}

}  // namespace

std::string format_json(const OrderedJson& json) {
  std::string text;
  append(text, json, true, 0);
  return text + '\n';
}

OrderedJson json_of(const Coating& coating) {
  if (coating == Coating{}) return OrderedJson("none");
  OrderedJson json = OrderedJson::object();
  members(coating, MemberWriter{json});
  return json;
}

void read_value(const JsonPart& part, Coating& coating, const Range&) {
  const std::string word = part.json().is_string() ? part.text() : "";
  coating = word == "mgf2" ? Coating::quarter_wave() : Coating();
  if (word == "none" || word == "mgf2") return;
  if (!part.json().is_structured()) part.refuse(R"("none", "mgf2" or an object)");
  std::vector<JsonField> fields;
  members(coating, MemberReader{fields});
  part.read(fields);
  if (coating == Coating{}) {
    part.fail(R"(must have entries in "layers" or "reflectance"; an uncoated surface is "none")");
  }
}

OrderedJson json_of(const Prescription& lens) {
  validate(lens, lens.name.empty() ? std::string("lens") : lens.name);
  OrderedJson json = OrderedJson::object();
  json.add("format", OrderedJson(std::string(lens_format)));
  members(lens, MemberWriter{json});
  return json;
}

void read_value(const JsonPart& part, Prescription& lens, const Range&) {
  const auto format = [](const JsonPart& text) {
    if (text.text() != lens_format) text.refuse(in_quotes(lens_format));
  };
  if (part.json().is_object() && !part.json().contains("format")) {
    part.fail("key \"format\" is missing; must be " + in_quotes(lens_format));
  }
  if (part.json().is_object() && part.json().contains("zoom") && part.json().contains("configurations")) {
    part.fail_at("configurations", R"("zoom" and "configurations" are given; must be one of the two)");
  }
  std::vector<JsonField> fields{{"format", format}};
  members(lens, MemberReader{fields});
  fields.emplace_back("zoom", [&](const JsonPart& zoom) { read_zoom(zoom, lens.configurations); });
  part.read(fields);
  const std::string where = "lens";
  try {
    validate(lens, where);
  } catch (const Error& error) {
    const std::string message = error.what();
    if (!message.starts_with(where + ": ")) throw;
    part.fail_at(path_of(std::string_view(message).substr(where.size() + 2)), message.substr(where.size() + 2));
  }
}

}  // namespace io_detail

Prescription parse_prescription(std::string_view json, const std::string& where) {
  Prescription prescription;
  io_detail::read_value(io_detail::JsonPart(io_detail::JsonTree(json, where, io_detail::words_of)), prescription);
  return prescription;
}

Prescription read_prescription(const std::filesystem::path& file) {
  const std::string text = read_file(file, "a lens file");
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] != '{') {
    throw Error(file.string() +
                ": is not JSON; must be a lens file of petzval (read_lens() reads files of other programs)");
  }
  return with_apertures(parse_prescription(text, file.string()));
}

std::string format_prescription(const Prescription& prescription) {
  return io_detail::format_json(io_detail::json_of(prescription));
}

void write_prescription(const Prescription& prescription, const std::filesystem::path& file) {
  write_file(format_prescription(prescription), file);
}

}  // namespace petzval
