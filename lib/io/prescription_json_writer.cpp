// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "json.hpp"
#include "petzval/core/files.hpp"
#include "petzval/io/lens_json.hpp"

namespace petzval {
namespace {

std::string json(double value) { return io_detail::json_number(value); }

std::string json(const std::string& text) { return io_detail::json_text(text); }

std::string json(bool flag) { return flag ? "true" : "false"; }

template <class T>
std::string json(const std::optional<T>& value) {
  return value ? json(*value) : "null";
}

std::string json(const AsphereTerm& term) {
  return "{\"order\": " + std::to_string(term.order) + ", \"coefficient\": " + json(term.coefficient) + "}";
}

/// `"key": value`
template <class T>
std::string member(const char* key, const T& value) {
  return '"' + std::string(key) + "\": " + json(value);
}

std::string medium(const Medium& m) {
  std::string text = member("glass", m.glass);
  if (m.catalogue) text += ", " + member("catalogue", m.catalogue);
  if (m.glass_origin) text += ", " + member("glass_origin", m.glass_origin);
  if (m.nd || m.is_air()) text += ", " + member("nd", m.nd.value_or(1));
  return text + ", " + member("vd", m.vd);
}

std::string json(const Coating& coating) {
  if (coating == Coating{}) return json(std::string("none"));
  std::string entries;
  for (const CoatingLayer& layer : coating.layers) {
    entries += (entries.empty() ? "{" : ", {") + member("index", layer.index) + ", " +
               (layer.absorption != 0 ? member("absorption", layer.absorption) + ", " : std::string()) +
               member("thickness_nm", layer.thickness_nm) + "}";
  }
  for (const ReflectanceEntry& entry : coating.table) {
    entries += (entries.empty() ? "{" : ", {") + member("wavelength_nm", entry.wavelength_nm) + ", " +
               member("value", entry.reflectance) + "}";
  }
  return std::string(coating.layers.empty() ? R"({"reflectance": [)" : R"({"layers": [)") + entries + "]}";
}

std::string surface(const SurfaceRow& row) {
  const bool limited = row.semi_diameter && std::isfinite(*row.semi_diameter);
  std::string text = "{" + member("radius", row.radius) + ", " + member("thickness", row.thickness) + ", " +
                     medium(row.medium) + ", " + member("semi_diameter", limited ? row.semi_diameter : std::nullopt);
  if (row.semi_diameter_computed) text += ", " + member("semi_diameter_computed", true);
  if (row.obscuration_semi_diameter) text += ", " + member("inner_semi_diameter", row.obscuration_semi_diameter);
  text += ", " + member("conic", row.conic) + ", \"aspheric\": [";
  for (std::size_t i = 0; i < row.aspheric.size(); ++i) text += (i > 0 ? ", " : "") + json(row.aspheric[i]);
  text += "], " + member("stop", row.stop);
  if (row.mirror) text += ", " + member("mirror", true);
  if (row.comment) text += ", " + member("comment", row.comment);
  if (row.curved_in != Section::both)
    text += ", " + member("curved_in", std::string(row.curved_in == Section::x ? "x" : "y"));
  if (row.coating) text += ", \"coating\": " + json(*row.coating);
  return text + "}";
}

/// The entries of a list, one per line, indented by six blanks.
template <class Entry, class Text>
std::string list(const std::vector<Entry>& entries, const Text& text_of) {
  if (entries.empty()) return "[]";
  std::string text = "[";
  for (const Entry& entry : entries) text += (&entry == entries.data() ? "\n      " : ",\n      ") + text_of(entry);
  return text + "\n    ]";
}

std::string imported(const FileOrigin& origin) {
  const auto warning = [](const ImportWarning& w) {
    return "{\"line\": " + std::to_string(w.line) + ", " + member("command", w.command) + ", " +
           member("message", w.message) + "}";
  };
  return "{\n    " + member("format", origin.format) + ",\n    " + member("file", origin.file) + ",\n    " +
         (origin.entry.empty() ? "" : member("entry", origin.entry) + ",\n    ") + member("units", origin.units) +
         ",\n    " + member("title", origin.title) +
         ",\n    \"notes\": " + list(origin.notes, [](const std::string& note) { return json(note); }) +
         ",\n    \"warnings\": " + list(origin.warnings, warning) + "\n  }";
}

std::string design(const DesignData& d) {
  std::string text = "{";
  if (d.aperture) {
    text += "\n    \"aperture\": {" + member("setting", std::string(name(d.aperture->setting))) + ", " +
            member("value", d.aperture->value) + "},";
  }
  const auto field = [](const DesignField& f) {
    std::string entry = "{" + member("x", f.x) + ", " + member("y", f.y) + ", " + member("weight", f.weight);
    const auto unless_0 = [&entry](const char* key, double value) {
      if (value != 0) entry += ", " + member(key, value);
    };
    unless_0("decentre_x", f.decentre_x);
    unless_0("decentre_y", f.decentre_y);
    unless_0("compress_x", f.compress_x);
    unless_0("compress_y", f.compress_y);
    unless_0("angle_deg", f.angle_deg);
    return entry + "}";
  };
  const auto wavelength = [](const DesignWavelength& w) {
    return "{" + member("nm", w.nm) + ", " + member("weight", w.weight) + "}";
  };
  const std::optional<double> object =
      std::isfinite(d.object_distance_mm) ? std::optional(d.object_distance_mm) : std::nullopt;
  return text + "\n    " + member("object_distance_mm", object) + ",\n    " +
         member("field_kind", std::string(name(d.field_kind))) + ",\n    \"fields\": " + list(d.fields, field) +
         ",\n    \"wavelengths\": " + list(d.wavelengths, wavelength) +
         ",\n    \"primary_wavelength\": " + std::to_string(d.primary_wavelength) + "\n  }";
}

std::string change(const SurfaceChange& c) {
  std::string text = "{\"surface\": " + std::to_string(c.surface);
  const auto if_given = [&text](const char* key, const std::optional<double>& value) {
    if (value && std::isfinite(*value)) text += ", " + member(key, value);
  };
  if_given("thickness", c.thickness);
  if_given("radius", c.radius);
  if_given("conic", c.conic);
  if_given("semi_diameter", c.semi_diameter);
  if (c.medium) text += ", \"medium\": {" + medium(*c.medium) + "}";
  return text + "}";
}

std::string configuration(const Configuration& c) {
  std::string text = "{" + member("name", c.name);
  const auto if_given = [&text](const char* key, const auto& value) {
    if (value) text += ", " + member(key, value);
  };
  if_given("focus_of", c.focus_of);
  if (c.subject_distance_mm && std::isfinite(*c.subject_distance_mm)) {
    text += ", " + member("subject_distance_mm", c.subject_distance_mm);
  }
  if (c.stop) text += ", \"stop\": " + std::to_string(*c.stop);
  if_given("focal_length_mm", c.focal_length_mm);
  if_given("f_number", c.f_number);
  if_given("half_field_deg", c.half_field_deg);
  if_given("image_diagonal_mm", c.image_diagonal_mm);
  return text + ", \"changes\": " + list(c.changes, change) + "}";
}

}  // namespace

std::string format_prescription(const Prescription& p) {
  validate(p, p.name.empty() ? std::string("lens") : p.name);
  std::string text = "{\n  \"format\": \"petzval-lens 1\"";
  const auto line = [&text](const std::string& entry) { text += ",\n  " + entry; };
  const auto line_if = [&line](const char* key, const std::optional<std::string>& value) {
    if (value) line(member(key, *value));
  };
  line(member("id", p.id));
  line(member("name", p.name));
  line("\"source\": {\n    " + member("design", p.source_design) + ",\n    " + member("numbers", p.source_numbers) +
       "\n  }");
  line(member("focal_length_mm", p.focal_length_mm));
  line(member("f_number", p.f_number));
  line(member("half_field_deg", p.half_field_deg));
  line(member("image_diagonal_mm", p.image_diagonal_mm));
  line(member("reference_wavelength_nm", p.reference_wavelength_nm));
  line_if("semi_diameters", p.semi_diameters);
  line_if("stop_size", p.stop_size);
  line_if("image_distance", p.image_distance);
  line_if("glass_names", p.glass_names);
  line_if("notes", p.notes);
  if (!p.aliases.empty()) {
    std::string aliases;
    for (const std::string& alias : p.aliases) aliases += (aliases.empty() ? "\n    " : ",\n    ") + json(alias);
    line("\"aliases\": [" + aliases + "\n  ]");
  }
  if (p.imported) line("\"imported\": " + imported(*p.imported));
  if (p.design != DesignData{}) line("\"design\": " + design(p.design));
  if (p.object_space != Medium{}) line("\"object_space\": {" + medium(p.object_space) + "}");
  text += ",\n  \"surfaces\": [";
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) text += (i > 0 ? ",\n    " : "\n    ") + surface(p.surfaces[i]);
  text += "\n  ]";
  if (!p.configurations.empty()) {
    line("\"configurations\": [");
    for (std::size_t i = 0; i < p.configurations.size(); ++i) {
      text += (i > 0 ? ",\n    " : "\n    ") + configuration(p.configurations[i]);
    }
    text += "\n  ]";
  }
  return text + "\n}\n";
}

void write_prescription(const Prescription& prescription, const std::filesystem::path& file) {
  write_file(format_prescription(prescription), file);
}

}  // namespace petzval
