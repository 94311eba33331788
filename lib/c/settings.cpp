// SPDX-License-Identifier: Apache-2.0
// The set-up of a camera as JSON.
#include <limits>
#include <nlohmann/json.hpp>

#include "handles.hpp"
#include "petzval/io/lens_json.hpp"

namespace petzval::c_detail {
namespace {

using Json = nlohmann::json;
constexpr const char* format = "petzval-camera 1";

/// JSON has no infinity.
Json number(double value) { return std::isinf(value) ? Json(value > 0 ? "inf" : "-inf") : Json(value); }
double number(const Json& json) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return !json.is_string() ? json.get<double>() : json.get<std::string>() == "inf" ? infinity : -infinity;
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
    const double read = number(from.at(name));
    if constexpr (std::is_floating_point_v<T>) {
      value = read;
    } else {
      if (!(std::abs(read) <= 1e9)) throw Error(std::string("camera set-up: ") + name + " is out of range");
      value = static_cast<T>(read);
    }
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
  if (json.at("format") != format) {
    throw Error("camera set-up: format = " + json.at("format").dump() + "; must be \"" + format + "\"");
  }
  CameraSettings settings{};
  const Json& lens = json.at("lens");
  LensSettings& own = settings.lens;
  own.prescription = parse_prescription(lens.at("prescription").get<std::string>(), "camera set-up");
  own.wavelengths_nm = lens.at("wavelengths_nm").get<std::vector<double>>();
  lens_members(own, Reader{lens});
  if (lens.contains("f_number")) own.f_number = lens["f_number"].get<double>();
  if (lens.contains("focus")) {
    const int origin = lens["focus"].at(1).get<int>();
    if (origin < 0 || origin > static_cast<int>(DistanceOrigin::front_principal)) {
      throw Error("camera set-up: the origin of the focus is out of range");
    }
    own.focus = {.distance_mm = number(lens["focus"].at(0)), .origin = static_cast<DistanceOrigin>(origin)};
  }
  std::vector<Glass> glasses;
  for (const Json& one : lens.at("glasses")) {
    Glass glass;
    glass.catalogue = one.at("catalogue").get<std::string>(), glass.name = one.at("name").get<std::string>();
    glass_members(glass, Reader{one});
    const int formula = one.at("formula").get<int>();
    if (formula < 0 || formula > static_cast<int>(DispersionFormula::tabulated)) {
      throw Error("camera set-up: the formula of a glass is out of range");
    }
    glass.formula = static_cast<DispersionFormula>(formula);
    glass.coefficients = one.at("coefficients").get<std::vector<double>>();
    glasses.push_back(std::move(glass));
  }
  if (!glasses.empty()) own.glasses = std::make_shared<const GlassCatalogue>(std::move(glasses));
  film_members(settings.film, Reader{json.at("film")});
  option_members(settings.options, Reader{json.at("options")});
  settings.film.size = sizeof settings.film, settings.options.size = sizeof settings.options;
  settings.model = json.at("model").get<std::string>();
  settings.opens_mm = number(json.at("opens_mm")), settings.closes_mm = number(json.at("closes_mm"));
  return settings;
} catch (const Json::exception& error) {
  throw Error(std::string("camera set-up: ") + error.what());
}

}  // namespace petzval::c_detail
