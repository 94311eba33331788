// SPDX-License-Identifier: Apache-2.0
#include "petzval/io/json.hpp"

#include <array>
#include <system_error>
#include <utility>

#include "json_members.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/ideal_lens.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval {
namespace io_detail {

constexpr std::string_view setup_format = "petzval-camera 2";

constexpr Range count_rule{1, 2147483647, "a whole number from 1 to 2147483647"};
constexpr Range length_rule{0, 1e9, "a number from 0 to 1e9"};
constexpr Range angle_rule{-3.1415926535897932, 3.1415926535897932, "an angle from -pi to pi"};
constexpr Range extent_rule{-20, 20, "a number from -20 to 20"};
constexpr Range wavelength_rule{10, 1e5, "10 to 100000 nm"};
constexpr Range fraction_rule{0, 1, "a number from 0 to 1"};

constexpr std::array all_criteria{FocusCriterion::thin, FocusCriterion::paraxial, FocusCriterion::min_rms,
                                  FocusCriterion::min_max};
constexpr std::array all_origins{DistanceOrigin::front_vertex, DistanceOrigin::film, DistanceOrigin::entrance_pupil,
                                 DistanceOrigin::front_principal};
constexpr std::array all_normalisations{Normalisation::irradiance, Normalisation::unity_on_axis,
                                        Normalisation::unity_at_each_wavelength};
constexpr std::array all_surface_kinds{SurfaceKind::affine, SurfaceKind::shepard};
constexpr std::array all_formulas{DispersionFormula::sellmeier,  DispersionFormula::sellmeier_squared,
                                  DispersionFormula::polynomial, DispersionFormula::cauchy,
                                  DispersionFormula::buchdahl,   DispersionFormula::rational,
                                  DispersionFormula::herzberger, DispersionFormula::tabulated};

template <Is<AbsorptionEntry> S, class Of>
void members(S& entry, const Of& of) {
  of("wavelength_nm", entry.wavelength_nm, positive), of("per_mm", entry.per_mm);
}
template <Is<Glass> S, class Of>
void members(S& glass, const Of& of) {
  of("catalogue", glass.catalogue), of("name", glass.name), of("nd", glass.nd), of("vd", glass.vd);
  of("formula", glass.formula, all_formulas), of("shortest_nm", glass.shortest_nm), of("longest_nm", glass.longest_nm);
  of("coefficients", glass.coefficients), of("absorption", glass.absorption);
}
template <Is<LensSource> S, class Of>
void members(S& lens, const Of& of) {
  of("file", lens.file), of("prescription", lens.prescription), of("thin_mm", lens.thin_mm, not_negative);
  of("configuration", lens.configuration), of("glass_files", lens.glass_files), of("glasses", lens.glasses);
  of("match_glasses", lens.match_glasses), of("require_glasses", lens.require_glasses);
  of("clamp_wavelengths", lens.clamp_wavelengths), of("wavelengths_nm", lens.wavelengths_nm, wavelength_rule);
  of("primary_nm", lens.primary_nm, wavelength_rule);
}
template <Is<Iris> S, class Of>
void members(S& iris, const Of& of) {
  constexpr Range blades{0, 20, "0, or a whole number from 3 to 20"}, roundness{-1, 1, "a number from -1 to 1"};
  of("blades", iris.blades, blades), of("roundness", iris.roundness, roundness), of("rotation_rad", iris.rotation_rad);
}
template <Is<FocusField> S, class Of>
void members(S& field, const Of& of) {
  of("field_rad", field.field_rad), of("weight", field.weight, not_negative);
}
template <Is<FocusOptions> S, class Of>
void members(S& focus, const Of& of) {
  of("criterion", focus.criterion, all_criteria), of("origin", focus.origin, all_origins), of("fields", focus.fields);
  of("wavelength_weights", focus.wavelength_weights, not_negative);
}
template <Is<Film> S, class Of>
void members(S& film, const Of& of) {
  of("width_mm", film.width_mm, positive), of("height_mm", film.height_mm, positive);
  of("columns", film.columns, count_rule), of("rows", film.rows, count_rule);
  of("shift_x_mm", film.shift_x_mm), of("shift_y_mm", film.shift_y_mm), of("margin_mm", film.margin_mm, length_rule);
  of("z_mm", film.z_mm), of("tilt_rad", film.tilt_rad, angle_rule), of("swing_rad", film.swing_rad, angle_rule);
  of("travel_mm", film.travel_mm);
}
template <Is<BokehControls> S, class Of>
void members(S& bokeh, const Of& of) {
  of("blades", bokeh.blades, Range{0, 20, "0, or a whole number from 3 to 20"});
  of("lens_ratio", bokeh.lens_ratio, positive), of("rate_of_change", bokeh.rate_of_change);
  of("keep_light", bokeh.keep_light), of("weight_distribution", bokeh.weight_distribution);
  of("weight_strength", bokeh.weight_strength), of("map_keeps_mean", bokeh.weight_map.keep_mean);
}
template <Is<PowerKnot> S, class Of>
void members(S& knot, const Of& of) {
  of("radius", knot.radius, fraction_rule), of("power", knot.power);
}
template <Is<FilmPoint> S, class Of>
void members(S& point, const Of& of) {
  of("x", point.x), of("y", point.y);
}
template <Is<FilmOffset> S, class Of>
void members(S& offset, const Of& of) {
  of("film_point", offset.film_point), of("offset_mm", offset.offset_mm), of("weight", offset.weight, not_negative);
}
template <Is<ExpressiveLens> S, class Of>
void members(S& lens, const Of& of) {
  of("power", lens.power), of("film_offsets", lens.film_offsets), of("dispersion", lens.dispersion);
}
template <Is<CameraOptions> S, class Of>
void members(S& options, const Of& of) {
  of("model", options.model, models()), of("normalisation", options.normalisation, all_normalisations);
  of("bokeh", options.bokeh), of("expressive", options.expressive), of("paraxial_focus", options.paraxial_focus);
  of("transmission", options.transmission);
  of("clamp_wavelengths", options.clamp_wavelengths), of("importance_tables", options.importance_tables);
}
template <Is<FocalPoint> S, class Of>
void members(S& point, const Of& of) {
  of("film_point", point.film_point), of("inverse_distance", point.inverse_distance), of("blur_mm", point.blur_mm);
  of("extent_stops", point.extent_stops, extent_rule), of("weight", point.weight, not_negative);
  of("fade", point.fade, fraction_rule);
}
template <Is<FocalSurfaceOptions> S, class Of>
void members(S& options, const Of& of) {
  of("kind", options.kind, all_surface_kinds), of("beta", options.beta, Range{1, 8, "a number from 1 to 8"});
  of("default_inverse_distance", options.default_inverse_distance);
}
template <Is<CameraSetup> S, class Of>
void members(S& setup, const Of& of) {
  of("lens", setup.lens), of("f_number", setup.f_number, positive), of("iris", setup.iris);
  of("coating", setup.coating), of("focus_mm", setup.focus_mm, positive_or_infinite), of("focus", setup.focus);
  of("film", setup.film), of("camera", setup.camera), of("iris_map", setup.iris_map);
  of("focal_points", setup.focal_points), of("focal_surface", setup.focal_surface);
}

OrderedJson setup_json(const CameraSetup& setup) {
  if (setup.camera.focal_surface) throw Error("camera.focal_surface is set; must be given as focal_points");
  if (!setup.camera.bokeh.weight_map.empty() && setup.iris_map.empty()) {
    throw Error("camera.bokeh.weight_map has values; must be the picture file iris_map");
  }
  OrderedJson json = OrderedJson::object();
  json.add("format", OrderedJson(std::string(setup_format)));
  members(setup, MemberWriter{json});
  return json;
}

CameraSetup read_setup(const JsonPart& part) {
  CameraSetup setup;
  const auto format = [](const JsonPart& text) {
    if (text.text() != setup_format) text.refuse(in_quotes(setup_format));
  };
  std::vector<JsonField> fields{{"format", format, required}};
  members(setup, MemberReader{fields});
  part.read(fields);
  const LensSource& lens = setup.lens;
  const int given = !lens.file.empty() + lens.prescription.has_value() + (lens.thin_mm > 0);
  if (given != 1) {
    part.fail_at("lens", "lens: " + std::to_string(given) + " of file, prescription and thin_mm are given; must be 1");
  }
  if (lens.thin_mm > 0 && !setup.f_number) part.fail_at("lens.thin_mm", "f_number is missing; must be given");
  return setup;
}

}  // namespace io_detail

std::string_view name(Normalisation normalisation) noexcept {
  switch (normalisation) {
    case Normalisation::irradiance: return "irradiance";
    case Normalisation::unity_on_axis: return "unity_on_axis";
    case Normalisation::unity_at_each_wavelength: return "unity_at_each_wavelength";
  }
  return "unknown";
}

std::string to_json(const CameraSetup& setup) { return io_detail::format_json(io_detail::setup_json(setup)); }

CameraSetup camera_setup(std::string_view json, const std::string& where) {
  const io_detail::JsonTree tree(json, where, io_detail::words_of);
  const io_detail::JsonPart document(tree);
  std::optional<CameraSetup> setup;
  document.each_member([&](const std::string& key, const io_detail::JsonPart& part) {
    if (key == "setup") setup = io_detail::read_setup(part);
  });
  return setup ? *std::move(setup) : io_detail::read_setup(document);
}

std::optional<std::filesystem::path> find_lens(const std::string& name) {
  std::error_code error;
  for (const std::filesystem::path& file :
       {std::filesystem::path(name), data_directory() / "lenses" / (name + ".json")}) {
    if (!name.empty() && std::filesystem::exists(file, error)) return file;
  }
  return {};
}

Lens prepared(const CameraSetup& setup, const Lens& compiled) {
  Lens lens = setup.coating ? with_coating(compiled, *setup.coating) : compiled;
  lens = with_iris(lens, setup.iris);
  if (setup.f_number && setup.lens.thin_mm == 0) lens = with_f_number(lens, *setup.f_number);
  return setup.focus_mm ? with_focus(lens, *setup.focus_mm, setup.focus) : lens;
}

Camera camera(const CameraSetup& setup, const Lens& lens) {
  if (!setup.iris_map.empty() && setup.camera.bokeh.weight_map.empty()) {
    throw Error("iris_map = " + setup.iris_map + "; must be read into camera.bokeh.weight_map");
  }
  CameraOptions options = setup.camera;
  if (!setup.focal_points.empty()) {
    Film film = setup.film;
    film.z_mm = film.z_mm.value_or(lens.film_z());
    options.focal_surface.emplace(thick_lens(lens), film, setup.focal_points, setup.focal_surface);
  }
  return {lens, setup.film, options};
}

}  // namespace petzval
