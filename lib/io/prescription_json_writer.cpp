// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "json.hpp"
#include "petzval/core/error.hpp"
#include "petzval/io/lens_json.hpp"
#include "petzval/io/write_file.hpp"

namespace petzval::inline v0 {
namespace {

std::string json(double value) { return io_detail::json_number(value); }

std::string json(const std::string& text) {
  try {
    return nlohmann::json(text).dump();
  } catch (const nlohmann::json::exception&) {
    throw Error("a string of the lens is not UTF-8, wanted UTF-8 to write JSON");
  }
}

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
  return text + ", " + member("nd", m.nd) + ", " + member("vd", m.vd);
}

std::string surface(const SurfaceRow& row) {
  const bool limited = row.semi_diameter && std::isfinite(*row.semi_diameter);
  std::string text = "{" + member("radius", row.radius) + ", " + member("thickness", row.thickness) + ", " +
                     medium(row.medium) + ", " + member("semi_diameter", limited ? row.semi_diameter : std::nullopt);
  if (row.obscuration_semi_diameter) text += ", " + member("inner_semi_diameter", row.obscuration_semi_diameter);
  text += ", " + member("conic", row.conic) + ", \"aspheric\": [";
  for (std::size_t i = 0; i < row.aspheric.size(); ++i) text += (i > 0 ? ", " : "") + json(row.aspheric[i]);
  text += "], " + member("stop", row.stop);
  if (row.mirror) text += ", " + member("mirror", true);
  if (row.curved_in != Section::both)
    text += ", " + member("curved_in", std::string(row.curved_in == Section::x ? "x" : "y"));
  return text + "}";
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
  if (p.zoom) {
    std::string gaps;
    for (const auto& [number, gap] : p.zoom->variable_gaps) {
      gaps += (gaps.empty() ? "\n      " : ",\n      ") + member(std::to_string(number).c_str(), gap);
    }
    line("\"zoom\": {\n    " + member("position", p.zoom->position) + ",\n    \"variable_gaps\": {" +
         (gaps.empty() ? "" : gaps + "\n    ") + "}\n  }");
  }
  line_if("notes", p.notes);
  if (!p.aliases.empty()) {
    std::string aliases;
    for (const std::string& alias : p.aliases) aliases += (aliases.empty() ? "\n    " : ",\n    ") + json(alias);
    line("\"aliases\": [" + aliases + "\n  ]");
  }
  if (p.object_space != Medium{}) line("\"object_space\": {" + medium(p.object_space) + "}");
  text += ",\n  \"surfaces\": [";
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) text += (i > 0 ? ",\n    " : "\n    ") + surface(p.surfaces[i]);
  return text + "\n  ]\n}\n";
}

void write_prescription(const Prescription& prescription, const std::filesystem::path& file) {
  write_file(format_prescription(prescription), file);
}

}  // namespace petzval::inline v0
