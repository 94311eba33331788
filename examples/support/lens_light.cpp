// SPDX-License-Identifier: Apache-2.0
#include "lens_light.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <sstream>

#include "bokeh.hpp"
#include "number_csv.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/glass/glass.hpp"
#include "text.hpp"

namespace examples {

petzval::Coating coating_named(const std::string& name) {
  if (name == "none") return {};
  if (name == "mgf2") return petzval::Coating::quarter_wave();
  if (!name.ends_with(".csv")) {
    throw petzval::Error("--coatings = \"" + name + "\"; must be none, mgf2 or a file.csv");
  }
  constexpr std::array layers{CsvColumn{"index"}, CsvColumn{"absorption"}, CsvColumn{"thickness_nm"}};
  constexpr std::array table{CsvColumn{"wavelength_nm"}, CsvColumn{"reflectance"}};
  const std::string text = read_text(name);
  petzval::Coating coating;
  if (text.starts_with(table[0].name)) {
    const auto columns = parse_columns(text, table, name);
    for (std::size_t i = 0; i < columns[0].size(); ++i) coating.table.push_back({columns[0][i], columns[1][i]});
  } else {
    const auto columns = parse_columns(text, layers, name);
    for (std::size_t i = 0; i < columns[0].size(); ++i) {
      coating.layers.push_back({columns[0][i], columns[1][i], columns[2][i]});
    }
  }
  petzval::validate(coating, name);
  return coating;
}

LightReport report_light(const Report& report, const petzval::Lens& colours, const petzval::Lens& visible) {
  LightReport result;
  const double z = subject_z(report.subject, colours);
  for (const double degrees : report.subject.fields.degrees) {
    const petzval::FieldPoint point{.field_rad = petzval::radians(degrees), .z = z};
    for (std::size_t w = 0; w < colours.wavelengths_nm().size(); ++w) {
      result.values.push_back({colours.wavelengths_nm()[w], degrees, petzval::transmittance(colours, point, w)});
    }
  }
  const auto table = petzval::ColourMatching::load(petzval::data_directory() / "glass" / "cie1931_2deg_5nm.csv");
  result.colour = petzval::lens_colour(visible, subject_z(report.subject, visible), white_light("D65"), table);
  return result;
}

Json to_json(const std::optional<LightReport>& light) {
  Json json{{"transmittance", nullptr}, {"t_stop", nullptr}, {"colour", nullptr}};
  if (!light) return json;
  json["transmittance"] = Json::array();
  for (const auto& [nm, degrees, value] : light->values) {
    json["transmittance"].push_back(
        {{"wavelength_nm", nm}, {"field_deg", degrees}, {"value", value ? Json(*value) : Json()}});
  }
  if (!light->colour) return json;
  json["t_stop"] = light->colour->t_stop;
  json["colour"] = {{"x", light->colour->xy[0]}, {"y", light->colour->xy[1]}};
  return json;
}

std::string to_text(const LightReport& light) {
  std::ostringstream text;
  text << "\nlight that the surfaces pass:\n";
  for (const auto& [nm, degrees, value] : light.values) {
    text << "  " << number(degrees, 4) << "\u00b0, " << number(nm, 6)
         << " nm: " << (value ? number(100 * *value, 4) + " %" : "no ray passes") << '\n';
  }
  if (light.colour) {
    const petzval::LensColour& colour = *light.colour;
    text << "  T-stop " << number(colour.t_stop, 4) << " (" << number(100 * colour.luminous_transmittance, 4)
         << " % of daylight D65)\n  white light becomes x = " << number(colour.xy[0], 4)
         << ", y = " << number(colour.xy[1], 4) << " (CIE 1931; D65 is " << number(colour.light_xy[0], 4) << ", "
         << number(colour.light_xy[1], 4) << ")\n";
  }
  return text.str();
}

}  // namespace examples
