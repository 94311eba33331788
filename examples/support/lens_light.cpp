// SPDX-License-Identifier: Apache-2.0
#include "lens_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>
#include <sstream>

#include "bokeh.hpp"
#include "number_csv.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/apertures.hpp"
#include "text.hpp"

namespace examples {

petzval::Coating coating_named(const std::string& name) {
  if (name == "none") return {};
  if (name == "mgf2") return petzval::Coating::quarter_wave();
  if (!name.ends_with(".csv")) {
    throw petzval::Error("--coatings = \"" + name + "\"; must be none, mgf2, file or a file.csv");
  }
  // The ranges of validate(), which does not know lines.
  constexpr std::array layers{CsvColumn{"index", {1e-3, 1e3, "0.001 to 1000"}},
                              CsvColumn{"absorption", {0, 1e3, "0 to 1000"}},
                              CsvColumn{"thickness_nm", {0, 1e7, "0 to 1e7"}}};
  constexpr std::array table{CsvColumn{"wavelength_nm", {10, 1e6, "10 to 1e6"}},
                             CsvColumn{"reflectance", {0, 1, "0 to 1"}}};
  constexpr std::size_t most_rows = 10'000;  // as in the JSON of lenses
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
  if (std::max(coating.layers.size(), coating.table.size()) > most_rows) {
    throw petzval::Error(name + ": rows = " + std::to_string(std::max(coating.layers.size(), coating.table.size())) +
                         "; must be at most " + std::to_string(most_rows));
  }
  if (coating == petzval::Coating{}) throw petzval::Error(name + ": no rows; must have at least one");
  petzval::validate(coating, name);
  return coating;
}

namespace {

/// Change of the reciprocal colour temperature, 10^6 / K, as on the filters of photographers: positive is warmer.
std::optional<double> shift_mired(const petzval::LensColour& colour) {
  if (!colour.cct_k || !colour.light_cct_k) return {};
  return 1e6 / *colour.cct_k - 1e6 / *colour.light_cct_k;
}

}  // namespace

Option* add_coatings(App& app, std::string& coatings, const std::string& by_default) {
  return app
      .add_option("--coatings", coatings,
                  "coating of all surfaces between air and glass, for the light that passes the lens: none (uncoated), "
                  "mgf2 (a quarter wave of magnesium fluoride at 550 nm), or a CSV file of layers from the air "
                  "(index,absorption,thickness_nm) or of reflectances (wavelength_nm,reflectance); file: the coatings "
                  "that the lens file states")
      ->type_name("none|mgf2|file|FILE.csv")
      ->default_str(by_default);
}

std::optional<petzval::Lens> coated(const petzval::Lens& lens, const std::string& coatings) {
  if (coatings == "file" && !petzval::states_coatings(lens)) {
    throw petzval::Error("--coatings = \"file\"; must be none, mgf2 or a file.csv: the lens file states no coating");
  }
  if (!coatings.empty() && coatings != "file") return petzval::with_coating(lens, coating_named(coatings));
  return petzval::states_coatings(lens) ? std::optional(lens) : std::nullopt;
}

std::vector<double> visible_wavelengths(const petzval::Lens& lens) {
  double shortest = 400, longest = 700;
  for (const petzval::LensSurface& surface : lens.surfaces()) {
    if (!surface.coating || surface.coating->table.empty()) continue;
    shortest = std::max(shortest, 10 * std::ceil(surface.coating->table.front().wavelength_nm / 10));
    longest = std::min(longest, surface.coating->table.back().wavelength_nm);
  }
  std::vector<double> result;
  for (double nm = shortest; nm <= longest; nm += 10) result.push_back(nm);
  return result.size() < 2 ? std::vector<double>() : result;
}

LightReport report_light(const Report& report, const std::string& coatings, const petzval::Lens& colours,
                         const std::optional<petzval::Lens>& visible) {
  LightReport result{coatings, {}, colours, report.subject.fields.degrees, {{}, 1}, visible, {}};
  for (const std::size_t surface : petzval::uncoated_surfaces(colours)) {
    result.uncoated.push_back(report.surface_number(surface));
  }
  std::vector<double> fields;
  for (const double degrees : result.fields_deg) fields.push_back(petzval::radians(degrees));
  result.values = petzval::transmittance(colours, subject_z(report.subject, colours), fields, threads());
  if (visible) result.colour = daylight_behind(*visible, subject_z(report.subject, *visible));
  result.t_stop = petzval::aperture_state(colours).t_number;
  return result;
}

GhostReport report_ghosts(const Report& report, const std::optional<LightReport>& light) {
  GhostReport result;
  const petzval::Lens& lens = report.loaded.lens;
  const auto& fields = report.subject.fields.degrees;
  if (!fields.empty()) result.field_deg = 0.7 * *std::ranges::max_element(fields);
  const petzval::GhostOptions options{.max_pairs = 300, .tolerance = 1e-2, .threads = threads()};
  try {
    const petzval::ScenePoint point =
        petzval::scene_point(lens, {petzval::radians(result.field_deg), subject_z(report.subject, lens)});
    const auto add = [&](const std::string& coatings, const petzval::Lens& coated) {
      petzval::Ghosts ghosts = petzval::ghost_pairs(coated, point, options);
      GhostReport::Column column{coatings};
      if (result.columns.empty()) {
        result.left_out = ghosts.left_out, result.pairs = ghosts.pairs;
        result.pairs.resize(std::min<std::size_t>(result.pairs.size(), 10));
      }
      for (const petzval::GhostPair& wanted : result.pairs) {
        const auto same = std::ranges::find_if(ghosts.pairs, [&](const petzval::GhostPair& pair) {
          return pair.first == wanted.first && pair.second == wanted.second;
        });
        column.energies.push_back(same == ghosts.pairs.end() ? 0 : same->energy);
      }
      for (const petzval::GhostPair& pair : ghosts.pairs) column.glare += pair.energy;
      result.columns.push_back(std::move(column));
    };
    add("no coatings", petzval::with_coating(lens, {}));
    add("MgF2", petzval::with_coating(lens, petzval::Coating::quarter_wave()));
    if (light && light->coatings != "none" && light->coatings != "mgf2") {
      add(light->coatings.empty() ? "of the file" : light->coatings, *coated(lens, light->coatings));
    }
  } catch (const petzval::Error& error) {
    result.failure = error.what();
  }
  return result;
}

std::optional<petzval::LensColour> daylight_behind(const petzval::Lens& visible, double subject_z) {
  const auto table = petzval::ColourMatching::load(petzval::data_directory() / "glass" / "cie1931_2deg_5nm.csv");
  return petzval::lens_colour(visible, subject_z, white_light("D65"), table);
}

std::optional<petzval::Lens> visible_lens(const LoadedLens& loaded, const petzval::Lens& coated) {
  try {
    // Glasses that end before 400 or 700 nm keep their last index, which changes transmittances little.
    auto options = compile_options(loaded);
    options.clamp_wavelengths = true;
    return petzval::compile(loaded.prescription, visible_wavelengths(coated), options);
  } catch (const petzval::Error&) {
    return {};  // media without dispersion have indices at one wavelength only
  }
}

Json to_json(const std::optional<LightReport>& light) {
  Json json{{"coatings", nullptr},
            {"uncoated_surfaces", nullptr},
            {"transmittance", nullptr},
            {"t_stop", nullptr},
            {"colour", nullptr}};
  if (!light) return json;
  json["coatings"] = light->coatings.empty() ? "file" : light->coatings;
  json["uncoated_surfaces"] = light->uncoated;
  json["transmittance"] = Json::array();
  for (std::size_t field = 0; field < light->values.size(); ++field) {
    for (std::size_t w = 0; w < light->values.columns; ++w) {
      json["transmittance"].push_back({{"wavelength_nm", light->colours.wavelengths_nm()[w]},
                                       {"field_deg", light->fields_deg[field]},
                                       {"value", or_null(light->values[field][w])}});
    }
  }
  if (light->t_stop) json["t_stop"] = finite_or_null(*light->t_stop);
  if (light->colour) json["colour"] = to_json(*light->colour);
  return json;
}

Json to_json(const petzval::LensColour& colour) {
  return {{"x", colour.xy[0]},
          {"y", colour.xy[1]},
          {"correlated_colour_temperature_k", or_null(colour.cct_k)},
          {"light_correlated_colour_temperature_k", or_null(colour.light_cct_k)},
          {"shift_mired", or_null(shift_mired(colour))}};
}

std::string coatings_in_words(const LightReport& light) {
  const bool mirrors = std::ranges::any_of(light.colours.surfaces(), [](const petzval::LensSurface& surface) {
    return surface.mirror && surface.coating.value_or(petzval::Coating{}) == petzval::Coating{};
  });
  const std::string lossless = mirrors ? "; mirrors lose no light" : "";
  if (!light.coatings.empty()) {
    return "coatings: " + light.coatings + " on all surfaces to air (--coatings)" + lossless;
  }
  std::string text = "coatings: of the file" + lossless;
  if (light.uncoated.empty()) return text;
  const bool one = light.uncoated.size() == 1;
  text += one ? "; surface " : "; surfaces ";
  for (std::size_t i = 0; i < light.uncoated.size(); ++i) {
    text += (i == 0 ? "" : i + 1 < light.uncoated.size() ? ", " : " and ") + std::to_string(light.uncoated[i]);
  }
  return text + (one ? " to air has none and is uncoated" : " to air have none and are uncoated");
}

std::string t_stop_in_words(const LightReport& light) {
  if (!light.t_stop || !std::isfinite(*light.t_stop)) return {};
  const double nm = light.colours.wavelengths_nm()[light.colours.primary_wavelength()];
  return "T-stop " + number(*light.t_stop, 4) + " at " + number(nm, 6) + " nm";
}

std::vector<std::string> colour_in_words(const petzval::LensColour& colour) {
  const auto kelvin = [](const std::optional<double>& value) {
    return value ? ", " + number(std::round(*value), 6) + " K" : std::string();
  };
  std::string shift;
  if (const auto mired = shift_mired(colour)) {
    const double rounded = std::round(10 * *mired) / 10;
    shift = "; " + number(std::abs(rounded), 4) + " mired" + (rounded == 0 ? "" : rounded < 0 ? " cooler" : " warmer");
  }
  return {number(100 * colour.luminous_transmittance, 4) + " % of daylight D65",
          "White light becomes x = " + number(colour.xy[0], 4) + ", y = " + number(colour.xy[1], 4) +
              kelvin(colour.cct_k) + " (CIE 1931; D65 is " + number(colour.light_xy[0], 4) + ", " +
              number(colour.light_xy[1], 4) + kelvin(colour.light_cct_k) + ")" + shift};
}

std::string to_text(const LightReport& light) {
  std::ostringstream text;
  text << "\nlight that the lens passes, mean over the pupil:\n  " << coatings_in_words(light) << '\n';
  for (std::size_t field = 0; field < light.values.size(); ++field) {
    for (std::size_t w = 0; w < light.values.columns; ++w) {
      const std::optional<double>& value = light.values[field][w];
      text << "  " << number(light.fields_deg[field], 4) << "\u00b0, " << number(light.colours.wavelengths_nm()[w], 6)
           << " nm: " << (value ? number(100 * *value, 4) + " %" : "no ray passes") << '\n';
    }
  }
  if (const std::string words = t_stop_in_words(light); !words.empty()) text << "  " << words << '\n';
  if (!light.visible) text << "  no colour: indices or reflectances from 400 to 700 nm are unknown\n";
  if (light.visible && !light.colour) text << "  no T-stop and colour: no light passes\n";
  if (!light.colour) return text.str();
  for (const std::string& line : colour_in_words(*light.colour)) text << "  " << line << '\n';
  return text.str();
}

}  // namespace examples
