// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/lens_json.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <system_error>

#include "json.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace {

using io_detail::in_quotes;
using io_detail::required;
using Part = io_detail::JsonPart;

constexpr std::string_view format_name = "petzval-lens 1";
constexpr int longest_list = 10'000;

constexpr std::array aperture_settings{ApertureSetting::entrance_pupil_diameter,
                                       ApertureSetting::f_number,
                                       ApertureSetting::working_f_number,
                                       ApertureSetting::object_na,
                                       ApertureSetting::image_na,
                                       ApertureSetting::stop_size};
constexpr std::array field_kinds{FieldKind::angle_deg, FieldKind::object_height, FieldKind::paraxial_image,
                                 FieldKind::real_image_height};

/// Stores the value of an enumeration by its name.
template <class Enum, std::size_t count>
auto one_of(const std::array<Enum, count>& all, Enum& to) {
  return [&all, &to](const Part& part) {
    const std::string text = part.text();
    std::string known;
    for (const Enum entry : all) {
      if (name(entry) == text) return void(to = entry);
      known += (known.empty() ? "" : ", ") + std::string(name(entry));
    }
    part.refuse("one of " + known);
  };
}

/// Reads a list of objects, each by `read`.
template <class Entry>
auto list_of(std::vector<Entry>& list, void (*read)(const Part&, Entry&)) {
  return [&list, read](const Part& part) { part.each([&](const Part& entry) { read(entry, list.emplace_back()); }); };
}

/// Reads an object that may be absent.
template <class Value>
auto object_of(std::optional<Value>& value, void (*read)(const Part&, Value&)) {
  return [&value, read](const Part& part) { read(part, value.emplace()); };
}

auto texts(std::vector<std::string>& list) {
  return [&list](const Part& part) { part.each([&](const Part& entry) { entry.get(list.emplace_back()); }); };
}

auto whole(int& to, int least = 0, int most = longest_list) {
  return [&to, least, most](const Part& part) { to = part.whole_number(least, most); };
}

auto radius(auto& to) {
  return [&to](const Part& part) { to = part.number("a number (0 for a plane)"); };
}

/// A number of a change: it must not be null, as an absent number keeps the value of the row.
auto changed(std::optional<double>& to) {
  return [&to](const Part& part) { to = part.number(); };
}

void read_medium(const Part& part, Medium& medium) {
  part.read({{"glass", medium.glass},
             {"catalogue", medium.catalogue},
             {"glass_origin", medium.glass_origin},
             {"nd", medium.nd},
             {"vd", medium.vd}});
}

void read_warning(const Part& part, ImportWarning& warning) {
  part.read({{"line", whole(warning.line, 0, 2'000'000'000)},
             {"command", warning.command},
             {"message", warning.message, required}});
}

void read_origin(const Part& part, FileOrigin& from) {
  part.read({{"format", from.format, required},
             {"file", from.file},
             {"entry", from.entry},
             {"units", from.units},
             {"title", from.title},
             {"notes", texts(from.notes)},
             {"warnings", list_of(from.warnings, read_warning)}});
}

void read_aperture(const Part& part, DesignAperture& aperture) {
  part.read({{"setting", one_of(aperture_settings, aperture.setting), required}, {"value", aperture.value, required}});
}

void read_field(const Part& part, DesignField& field) {
  part.read({{"x", field.x},
             {"y", field.y},
             {"weight", field.weight},
             {"decentre_x", field.decentre_x},
             {"decentre_y", field.decentre_y},
             {"compress_x", field.compress_x},
             {"compress_y", field.compress_y},
             {"angle_deg", field.angle_deg}});
}

void read_wavelength(const Part& part, DesignWavelength& wavelength) {
  part.read({{"nm", wavelength.nm, required}, {"weight", wavelength.weight}});
}

void read_design(const Part& part, DesignData& design) {
  std::optional<double> distance;
  int primary = static_cast<int>(design.primary_wavelength);
  part.read({{"aperture", object_of(design.aperture, read_aperture)},
             {"object_distance_mm", distance},
             {"field_kind", one_of(field_kinds, design.field_kind)},
             {"fields", list_of(design.fields, read_field)},
             {"wavelengths", list_of(design.wavelengths, read_wavelength)},
             {"primary_wavelength", whole(primary)}});
  design.object_distance_mm = distance.value_or(std::numeric_limits<double>::infinity());
  design.primary_wavelength = static_cast<std::size_t>(primary);
}

void read_term(const Part& part, AsphereTerm& term) {
  part.read({{"order", whole(term.order, 2, 40), required}, {"coefficient", term.coefficient, required}});
}

void read_layer(const Part& part, CoatingLayer& layer) {
  part.read({{"index", layer.index, required},
             {"absorption", layer.absorption},
             {"thickness_nm", layer.thickness_nm, required}});
}

void read_reflectance(const Part& part, ReflectanceEntry& entry) {
  part.read({{"wavelength_nm", entry.wavelength_nm, required}, {"value", entry.reflectance, required}});
}

void read_coating(const Part& part, Coating& coating) {
  const std::string word = part.json().is_string() ? part.text() : "";
  if (word == "none") return;
  if (word == "mgf2") return void(coating = Coating::quarter_wave());
  if (!part.json().is_structured()) part.refuse(R"("none", "mgf2" or an object)");
  part.read(
      {{"layers", list_of(coating.layers, read_layer)}, {"reflectance", list_of(coating.table, read_reflectance)}});
  if (coating == Coating{}) {
    part.fail(R"(must have entries in "layers" or "reflectance"; an uncoated surface is "none")");
  }
}

void read_section(const Part& part, Section& section) {
  const std::string text = part.text();
  if (text != "x" && text != "y") part.refuse(R"("x" or "y")");
  section = text == "x" ? Section::x : Section::y;
}

void read_surface(const Part& part, SurfaceRow& row) {
  part.read({{"radius", radius(row.radius), required},
             {"thickness", row.thickness, required},
             {"glass", row.medium.glass},
             {"catalogue", row.medium.catalogue},
             {"glass_origin", row.medium.glass_origin},
             {"nd", row.medium.nd},
             {"vd", row.medium.vd},
             {"semi_diameter", row.semi_diameter},
             {"semi_diameter_computed", row.semi_diameter_computed},
             {"inner_semi_diameter", row.obscuration_semi_diameter},
             {"conic", row.conic},
             {"aspheric", list_of(row.aspheric, read_term)},
             {"stop", row.stop},
             {"mirror", row.mirror},
             {"curved_in", [&](const Part& section) { read_section(section, row.curved_in); }},
             {"comment", row.comment},
             {"coating", object_of(row.coating, read_coating)}});
}

void read_change(const Part& part, SurfaceChange& change) {
  part.read({{"surface", whole(change.surface), required},
             {"thickness", changed(change.thickness)},
             {"radius", radius(change.radius)},
             {"conic", changed(change.conic)},
             {"semi_diameter", changed(change.semi_diameter)},
             {"medium", object_of(change.medium, read_medium)}});
}

void read_configuration(const Part& part, Configuration& configuration) {
  const auto stop = [&](const Part& number) { configuration.stop = number.whole_number(0, longest_list); };
  part.read({{"name", configuration.name, required},
             {"focus_of", configuration.focus_of},
             {"subject_distance_mm", configuration.subject_distance_mm},
             {"stop", stop},
             {"focal_length_mm", configuration.focal_length_mm},
             {"f_number", configuration.f_number},
             {"half_field_deg", configuration.half_field_deg},
             {"image_diagonal_mm", configuration.image_diagonal_mm},
             {"changes", list_of(configuration.changes, read_change)}});
}

/// The old form of a zoom position: a name, and thicknesses by the numbers of surfaces.
void read_zoom(const Part& part, std::vector<Configuration>& list) {
  Configuration& zoom = list.emplace_back(Configuration{.name = "zoom"});
  const auto gaps = [&](const Part& object) {
    object.each_member([&](const std::string& key, const Part& thickness) {
      int surface = -1;
      const auto status = std::from_chars(key.data(), key.data() + key.size(), surface).ec;
      if (status != std::errc() || key != std::to_string(surface) || surface < 0 || surface >= longest_list) {
        object.fail("key " + in_quotes(key) + " must be the number of a surface");
      }
      SurfaceChange& change = zoom.changes.emplace_back();
      change.surface = surface, change.thickness = thickness.number();
    });
  };
  part.read({{"position", zoom.name}, {"variable_gaps", gaps}});
  std::ranges::sort(zoom.changes, {}, &SurfaceChange::surface);
}

void read_document(const Part& part, Prescription& lens) {
  const auto format = [](const Part& text) {
    if (text.text() != format_name) text.refuse(in_quotes(format_name));
  };
  const auto source = [&](const Part& object) {
    object.read({{"design", lens.source_design}, {"numbers", lens.source_numbers}});
  };
  const auto positions = [&](auto read) {
    return [&lens, read](const Part& value) {
      if (!lens.configurations.empty()) value.fail(R"("zoom" and "configurations" are given; must be one of the two)");
      read(value);
    };
  };
  if (part.json().is_object() && !part.json().contains("format")) {
    part.fail("key \"format\" is missing; must be " + in_quotes(format_name));
  }
  part.read({{"format", format},
             {"id", lens.id},
             {"name", lens.name},
             {"source", source},
             {"focal_length_mm", lens.focal_length_mm},
             {"f_number", lens.f_number},
             {"half_field_deg", lens.half_field_deg},
             {"image_diagonal_mm", lens.image_diagonal_mm},
             {"reference_wavelength_nm", lens.reference_wavelength_nm},
             {"semi_diameters", lens.semi_diameters},
             {"stop_size", lens.stop_size},
             {"image_distance", lens.image_distance},
             {"glass_names", lens.glass_names},
             {"zoom", positions([&](const Part& object) { read_zoom(object, lens.configurations); })},
             {"notes", lens.notes},
             {"aliases", texts(lens.aliases)},
             {"imported", object_of(lens.imported, read_origin)},
             {"design", [&](const Part& object) { read_design(object, lens.design); }},
             {"object_space", [&](const Part& object) { read_medium(object, lens.object_space); }},
             {"surfaces", list_of(lens.surfaces, read_surface), required},
             {"configurations", positions(list_of(lens.configurations, read_configuration))}});
}

/// The words of a path: "surface 1: aspheric 0: order" for "surfaces[1].aspheric[0].order".
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
  Prescription prescription;
  read_document(Part(io_detail::JsonTree(json, where, words_of)), prescription);
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
  return with_apertures(parse_prescription(text, file.string()));
}

}  // namespace petzval
