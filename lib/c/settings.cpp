// SPDX-License-Identifier: Apache-2.0
// The set-up of a camera as JSON.
#include <limits>
#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "handles.hpp"
#include "petzval/io/lens_json.hpp"

namespace petzval::c_detail {
namespace {

using Json = nlohmann::json;
constexpr const char* format = "petzval-camera 1";

/// JSON has no infinity and no NaN, which members that are not used may have.
Json number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : to_text(value);
}

[[noreturn]] void refuse(const std::string& name, const Json& value, const std::string& rule) {
  throw Error("camera set-up: " + name + " = " + (value.is_structured() ? value.type_name() : value.dump()) +
              "; must be " + rule);
}
/// A member of a set-up. A missing member counts as null.
template <class T = Json>
T member(const Json& from, const char* name, const char* rule = "present") {
  const Json value = from.is_object() ? from.value(name, Json()) : Json();
  try {
    if (!value.is_null()) return value.get<T>();
  } catch (const Json::exception&) {
  }
  refuse(name, value, rule);
}
double number(const Json& json, const char* name) {
  if (json.is_number()) return json.get<double>();
  for (const double value : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    if (json == to_text(value)) return value;
  }
  refuse(name, json, "a number");
}
/// A number of the type T.
template <class T>
T number_of(const Json& from, const char* name) {
  const auto value = member(from, name, "a number");
  const double read = number(value, name);
  if constexpr (std::is_floating_point_v<T>) {
    return read;
  } else {
    constexpr double least = std::numeric_limits<T>::lowest(), most = std::numeric_limits<T>::max();
    if (!(read >= least && read <= most && read == std::floor(read))) {
      refuse(name, value, "a whole number from " + to_text(least) + " to " + to_text(most));
    }
    return static_cast<T>(read);
  }
}

/// Calls of(name, member) for the members of a struct; one list for writing and reading.
template <class Film, class Of>
void film_members(Film& film, const Of& of) {
  of("width_mm", film.width_mm), of("height_mm", film.height_mm), of("columns", film.columns), of("rows", film.rows);
  of("shift_x_mm", film.shift_x_mm), of("shift_y_mm", film.shift_y_mm), of("margin_mm", film.margin_mm);
  of("tilt_rad", film.tilt_rad), of("swing_rad", film.swing_rad), of("z_mm", film.z_mm), of("has_z", film.has_z);
}
template <class Options, class Of>
void option_members(Options& own, const Of& of) {
  of("normalisation", own.normalisation), of("frame", own.frame), of("origin", own.origin), of("threads", own.threads);
  of("units_per_mm", own.units_per_mm), of("clamp_wavelengths", own.clamp_wavelengths);
  of("importance_tables", own.importance_tables), of("near_mm", own.near_mm), of("far_mm", own.far_mm);
  of("near_far_origin", own.near_far_origin), of("keep_light", own.keep_light), of("lens_ratio", own.lens_ratio);
  of("rate_of_change", own.rate_of_change), of("weight_distribution", own.weight_distribution);
  of("weight_strength", own.weight_strength);
}
template <class Lens, class Of>
void lens_members(Lens& lens, const Of& of) {
  of("primary_nm", lens.primary_nm), of("clamp", lens.clamp), of("abbe", lens.abbe);
  of("configuration", lens.configuration), of("blades", lens.iris.blades), of("roundness", lens.iris.roundness);
  of("rotation_rad", lens.iris.rotation_rad);
}
template <class Glass, class Of>
void glass_members(Glass& glass, const Of& of) {
  of("nd", glass.nd), of("vd", glass.vd), of("shortest_nm", glass.shortest_nm), of("longest_nm", glass.longest_nm);
}

struct Writer {
  Json& to;
  template <class T>
  void operator()(const char* name, const T& value) const {
    to[name] = number(static_cast<double>(value));
  }
};
struct Reader {
  const Json& from;
  template <class T>
  void operator()(const char* name, T& value) const {
    value = number_of<T>(from, name);
  }
};

/// The glasses of the lens that are in the catalogue of the user.
Json glasses_of(const LensSettings& lens) {
  Json list = Json::array();
  if (!lens.glasses) return list;
  const auto add = [&](const Medium& medium) {
    const Glass* const glass = glass_of(medium, *lens.glasses);
    if (!glass) return;
    Json one{{"catalogue", glass->catalogue},
             {"name", glass->name},
             {"formula", static_cast<int>(glass->formula)},
             {"coefficients", glass->coefficients}};
    glass_members(*glass, Writer{one});
    if (std::ranges::find(list, one) == list.end()) list.push_back(std::move(one));
  };
  add(lens.prescription.object_space);
  for (const SurfaceRow& row : lens.prescription.surfaces) add(row.medium);
  for (const Configuration& configuration : lens.prescription.configurations) {
    for (const SurfaceChange& one : configuration.changes) {
      if (one.medium) add(*one.medium);
    }
  }
  return list;
}

}  // namespace

std::string write_settings(const CameraSettings& settings) {
  const LensSettings& own = settings.lens;
  Json lens{{"prescription", format_prescription(own.prescription)},
            {"wavelengths_nm", own.wavelengths_nm},
            {"glasses", glasses_of(own)}};
  lens_members(own, Writer{lens});
  if (own.f_number) lens["f_number"] = *own.f_number;
  if (own.focus) lens["focus"] = {number(own.focus->distance_mm), static_cast<int>(own.focus->origin)};
  Json film, options;
  film_members(settings.film, Writer{film});
  option_members(settings.options, Writer{options});
  return Json{{"format", format},
              {"lens", std::move(lens)},
              {"film", std::move(film)},
              {"options", std::move(options)},
              {"model", settings.model},
              {"opens_mm", number(settings.opens_mm)},
              {"closes_mm", number(settings.closes_mm)}}
      .dump();
}

CameraSettings read_settings(std::string_view bytes) try {
  const Json json = Json::parse(bytes);
  if (const auto found = member(json, "format"); found != format) refuse("format", found, Json(format).dump());
  constexpr const char *text = "text", *numbers = "a list of numbers";
  CameraSettings settings{};
  const auto lens = member(json, "lens");
  LensSettings& own = settings.lens;
  own.prescription = parse_prescription(member<std::string>(lens, "prescription", text), "camera set-up");
  own.wavelengths_nm = member<std::vector<double>>(lens, "wavelengths_nm", numbers);
  lens_members(own, Reader{lens});
  if (lens.contains("f_number")) own.f_number = number_of<double>(lens, "f_number");
  if (lens.contains("focus")) {
    const auto focus = member<std::vector<Json>>(lens, "focus", "a distance and its origin");
    constexpr auto last = static_cast<int>(DistanceOrigin::front_principal);
    if (focus.size() != 2 || !focus[1].is_number_integer() || focus[1] < 0 || focus[1] > last) {
      refuse("focus", lens["focus"], "a distance and its origin");
    }
    own.focus = {.distance_mm = number(focus[0], "focus"), .origin = static_cast<DistanceOrigin>(focus[1].get<int>())};
  }
  std::vector<Glass> glasses;
  for (const Json& one : member<std::vector<Json>>(lens, "glasses", "a list")) {
    Glass glass;
    glass.catalogue = member<std::string>(one, "catalogue", text), glass.name = member<std::string>(one, "name", text);
    glass_members(glass, Reader{one});
    const int formula = number_of<int>(one, "formula");
    if (formula < 0 || formula > static_cast<int>(DispersionFormula::tabulated)) {
      refuse("formula", formula, "the number of a dispersion formula");
    }
    glass.formula = static_cast<DispersionFormula>(formula);
    glass.coefficients = member<std::vector<double>>(one, "coefficients", numbers);
    glasses.push_back(std::move(glass));
  }
  if (!glasses.empty()) own.glasses = std::make_shared<const GlassCatalogue>(std::move(glasses));
  film_members(settings.film, Reader{member(json, "film")});
  option_members(settings.options, Reader{member(json, "options")});
  settings.film.size = sizeof settings.film, settings.options.size = sizeof settings.options;
  settings.model = member<std::string>(json, "model", text);
  settings.opens_mm = number_of<double>(json, "opens_mm"), settings.closes_mm = number_of<double>(json, "closes_mm");
  return settings;
} catch (const Json::exception& error) {
  throw Error(std::string("camera set-up: ") + error.what());
}

}  // namespace petzval::c_detail
