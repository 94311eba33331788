// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "core/text.hpp"
#include "io/json.hpp"
#include "json_object.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// Measurements on refractiveindex.info that the table "misc" contains.
struct Measurement {
  std::string_view material, source, glass;
};
constexpr std::array<Measurement, 6> measurements = {{{"CaF2", "Malitson", "CAF2"},
                                                      {"BaF2", "Malitson", "BAF2"},
                                                      {"SiO2", "Malitson", "F_SILICA"},
                                                      {"MgF2", "Dodge-o", "MGF2_O"},
                                                      {"Al2O3", "Malitson-o", "SAPPHIRE_O"},
                                                      {"H2O", "Daimon-20.0C", "WATER"}}};

class OptilandReader {
 public:
  explicit OptilandReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  void aperture(const JsonObject& o);
  void fields(const JsonObject& o);
  void wavelengths(const JsonObject& o);
  void surfaces(const JsonObject& group);
  double z_of(const JsonObject& surface) const;
  void shape(const JsonObject& geometry, SurfaceRow& row);
  Medium medium(const JsonObject& material);
  void rim(const JsonObject& surface, SurfaceRow& row);

  Import& in_;
};

void OptilandReader::aperture(const JsonObject& o) {
  static constexpr std::array<std::pair<std::string_view, ApertureSetting>, 4> settings = {
      {{"EPD", ApertureSetting::entrance_pupil_diameter},
       {"imageFNO", ApertureSetting::f_number},
       {"objectNA", ApertureSetting::object_na},
       {"float_by_stop_size", ApertureSetting::stop_size}}};
  const std::string type = o.text("type").empty() ? o.text("ap_type") : o.text("type");
  const auto found = std::ranges::find(settings, std::string_view(type), [](const auto& s) { return s.first; });
  if (found == settings.end())
    o.refuse("type", io_detail::in_quotes(type), "EPD, imageFNO, objectNA or float_by_stop_size");
  in_.lens.design.aperture = DesignAperture{found->second, o.needed("value")};
  if (o.flag("object_space_telecentric")) in_.warn(0, o.path + ".object_space_telecentric", "is left out");
  o.name_others({"type", "ap_type", "value", "object_space_telecentric"});
}

void OptilandReader::fields(const JsonObject& o) {
  const nlohmann::json& all = o.list("fields");
  std::string kind = o.find("field_type") && o.find("field_type")->is_string() ? o.text("field_type") : "";
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 1000); ++i) {
    const JsonObject f = o.entry("fields", i);
    if (kind.empty()) kind = f.text("field_type");
    // Vignetting factors compress the pupil.
    in_.lens.design.fields.push_back({.x = f.number("x").value_or(0),
                                      .y = f.number("y").value_or(0),
                                      .compress_x = f.number("vx").value_or(0),
                                      .compress_y = f.number("vy").value_or(0)});
  }
  FieldKind& field_kind = in_.lens.design.field_kind;
  if (kind.empty() || kind == "angle") {
    field_kind = FieldKind::angle_deg;
  } else if (kind == "object_height") {
    field_kind = FieldKind::object_height;
  } else if (kind == "paraxial_image_height") {
    field_kind = FieldKind::paraxial_image;
  } else if (kind == "real_image_height") {
    field_kind = FieldKind::real_image_height;
  } else {
    in_.warn(0, o.path + ".field_type", io_detail::in_quotes(kind) + " is not known; the fields are left out");
    in_.lens.design.fields.clear();
  }
}

struct LengthUnit {
  std::string_view name;
  double nm;
};
constexpr LengthUnit lengths_in_nm[] = {{"", 1e3}, {"um", 1e3}, {"nm", 1}, {"mm", 1e6}, {"cm", 1e7}, {"m", 1e9}};

void OptilandReader::wavelengths(const JsonObject& o) {
  const nlohmann::json& all = o.list("wavelengths");
  int primaries = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 1000); ++i) {
    const JsonObject w = o.entry("wavelengths", i);
    const std::string unit = w.text("unit");
    const auto known = std::ranges::find(lengths_in_nm, unit, &LengthUnit::name);
    if (known == std::end(lengths_in_nm)) w.refuse("unit", io_detail::in_quotes(unit), "nm, um, mm, cm or m");
    const double nm = *formats_detail::number(to_text(w.needed("value") * known->nm, 12));
    in_.lens.design.wavelengths.push_back({nm, w.number("weight").value_or(1)});
    if (!w.flag("is_primary")) continue;
    if (primaries++ == 0) in_.lens.design.primary_wavelength = i;
  }
  if (primaries > 1) {
    in_.warn(0, o.path + ".wavelengths", std::to_string(primaries) + " are primary; the first is taken");
  }
}

double OptilandReader::z_of(const JsonObject& surface) const {
  const JsonObject cs = surface.object("geometry").object("cs");
  for (const char* key : {"x", "y", "rx", "ry", "rz"}) {
    if (cs.number(key).value_or(0) != 0) cs.refuse(key, to_text(*cs.number(key)), "0 (a centred lens)");
  }
  if (cs.find("reference_cs")) cs.refuse("reference_cs", "another system of coordinates", "absent");
  return cs.needed("z");
}

void OptilandReader::shape(const JsonObject& geometry, SurfaceRow& row) {
  const std::string type = geometry.text("type");
  const double radius = geometry.number("radius").value_or(std::numeric_limits<double>::infinity());
  row.radius = std::isinf(radius) ? 0 : radius;
  row.conic = geometry.number("conic").value_or(0);
  if (type == "EvenAsphere") {
    row.aspheric = geometry.terms("coefficients", 2, 2);
  } else if (type == "OddAsphere") {
    row.aspheric = geometry.terms("coefficients", 1, 1);
  } else if (type != "Plane" && type != "StandardGeometry") {
    geometry.refuse("type", io_detail::in_quotes(type), "Plane, StandardGeometry, EvenAsphere or OddAsphere");
  }
  geometry.name_others({"type", "cs", "radius", "conic", "coefficients", "tol", "max_iter"});
}

Medium OptilandReader::medium(const JsonObject& material) {
  const std::string type = material.text("type");
  if (type == "IdealMaterial") {
    const nlohmann::json* index = material.find("index");
    // Newer versions write a list with a single entry.
    const double n = index && index->is_array() && index->size() == 1 && index->front().is_number()
                         ? index->front().get<double>()
                         : material.needed("index");
    return n == 1 ? Medium{} : Medium{.nd = n, .vd = 0};
  }
  if (type == "AbbeMaterial" || type == "AbbeMaterialE") {
    const auto value = [&](const char* key) {
      const nlohmann::json* number = material.find(key);
      return number && number->is_array() && number->size() == 1 && number->front().is_number()
                 ? number->front().get<double>()
                 : material.needed(key);
    };
    return {.nd = value("index"), .vd = value("abbe")};
  }
  if (type == "Material" || type == "MaterialFile") {
    // The path of the data: ".../glass/schott/N-SK10.yml" for the catalogue schott, or ".../main/CaF2/Daimon-20.yml"
    // for the measurement Daimon-20 of the material CaF2.
    std::string path = material.text("filename");
    std::ranges::replace(path, '\\', '/');
    const std::filesystem::path file = path;
    const std::string folder = file.parent_path().filename().string(), stem = file.stem().string();
    const bool of_a_catalogue = path.find("/glass/") != std::string::npos || path.find("main/") == std::string::npos;
    std::string name = material.text("name"), source = material.text("reference");
    if (!path.empty()) {
      if (name.empty()) name = of_a_catalogue ? stem : folder;
      source = of_a_catalogue ? folder : stem;
    }
    const auto measured = std::ranges::find_if(
        measurements, [&](const auto& m) { return same(m.material, name) && same(m.source, source); });
    if (measured != measurements.end())
      return in_.glass(0, measured->glass, std::array<std::string, 1>{"misc"}, {}, {});
    return in_.glass(0, name, std::vector<std::string>(source.empty() ? 0 : 1, source), {}, {});
  }
  material.refuse("type", io_detail::in_quotes(type), "IdealMaterial, AbbeMaterial, Material, MaterialFile or Mirror");
}

void OptilandReader::rim(const JsonObject& surface, SurfaceRow& row) {
  if (!surface.find("aperture")) return;
  const JsonObject aperture = surface.object("aperture");
  const std::string type = aperture.text("type");
  if (type != "RadialAperture") {
    in_.warn(0, aperture.path, io_detail::in_quotes(type) + " is left out: it is not round");
    return;
  }
  const double most = aperture.needed("r_max"), least = aperture.number("r_min").value_or(0);
  if (std::isfinite(most)) row.semi_diameter = most;
  if (least > 0) row.obscuration_semi_diameter = least;
}

void OptilandReader::surfaces(const JsonObject& group) {
  const nlohmann::json& all = group.list("surfaces");
  in_.limit(all.size(), "surfaces", 2);
  if (all.size() < 3)
    group.refuse("surfaces", std::to_string(all.size()) + " surfaces", "an object, a lens and an image");
  const JsonObject object = group.entry("surfaces", 0);
  double z = z_of(object);
  in_.lens.object_space = medium(object.object("material_post"));
  const double first_z = z_of(group.entry("surfaces", 1));
  in_.lens.design.object_distance_mm = std::isinf(z) ? std::numeric_limits<double>::infinity() : first_z - z;
  Medium before = in_.lens.object_space;
  z = first_z;
  for (std::size_t i = 1; i + 1 < all.size(); ++i) {
    const JsonObject s = group.entry("surfaces", i);
    SurfaceRow row;
    shape(s.object("geometry"), row);
    const double next = z_of(group.entry("surfaces", i + 1));
    row.thickness = next - z;
    z = next;
    row.stop = s.flag("is_stop");
    const JsonObject material = s.object("material_post");
    const bool reflects = s.flag("is_reflective") || material.text("type") == "Mirror" ||
                          (s.find("interaction_model") && s.object("interaction_model").flag("is_reflective"));
    row.mirror = reflects;
    row.medium = reflects ? before : medium(material);
    rim(s, row);
    if (const std::string comment = s.text("comment"); !comment.empty()) row.comment = comment;
    s.name_others({"type", "surface_type", "geometry", "material_pre", "material_post", "is_stop", "aperture",
                   "coating", "is_reflective", "interaction_model", "comment", "thickness"});
    before = row.medium;
    in_.lens.surfaces.push_back(std::move(row));
  }
}

void OptilandReader::read(std::string_view text) {
  const io_detail::JsonTree tree(text, in_.where(), words_of_path);
  const JsonObject root{tree.root(), "file", in_, tree};
  if (root.find("name") && root.find("name")->is_string()) in_.lens.imported->title = root.text("name");
  if (root.find("aperture")) aperture(root.object("aperture"));
  if (root.find("fields")) fields(root.object("fields"));
  if (root.find("wavelengths")) wavelengths(root.object("wavelengths"));
  surfaces(root.object("surface_group"));
  for (const char* key : {"pickups", "solves"}) {
    const nlohmann::json* value = root.find(key);
    const nlohmann::json* entries = value && value->is_object() && value->contains(key) ? &(*value)[key] : value;
    if (entries && entries->is_structured() && !entries->empty()) {
      in_.warn(0, std::string("file.") + key, "are not evaluated; the values that the file states are taken");
    }
  }
  root.name_others({"version", "name", "aperture", "fields", "wavelengths", "pickups", "solves", "surface_group"});
}

}  // namespace

bool is_optiland(std::string_view text) {
  return trimmed(text).starts_with('{') && text.find("\"surface_group\"") != std::string_view::npos;
}

void read_optiland(std::string_view text, Import& in) { OptilandReader(in).read(text); }

}  // namespace petzval::formats_detail
