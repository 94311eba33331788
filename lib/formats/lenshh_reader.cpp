// SPDX-License-Identifier: Apache-2.0
// LensHH's .lhlt: JSON with a list of surfaces from the object to the image. Keys with their default may be absent.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.hpp"
#include "io/json.hpp"
#include "json_object.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class LenshhReader {
 public:
  explicit LenshhReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  void design(const JsonObject& root);
  void surfaces(const JsonObject& root);
  SurfaceRow row(const JsonObject& s, const Medium& before);
  Medium medium(const JsonObject& s);

  Import& in_;
  std::vector<std::string> catalogues_;
};

/// A word of a list; the first if the key is absent.
std::string word_of(const JsonObject& o, const char* key, std::string_view list, const char* rule) {
  const std::string word = o.text(key);
  if (!word.empty() && !is_one_of(word, list)) o.refuse(key, shown(*o.find(key)), rule);
  return word.empty() ? std::string(list.substr(0, list.find(' '))) : word;
}

/// The distance to the next surface; infinite above 1e18, as in the program.
double thickness_of(const JsonObject& s) {
  const double thickness = s.number("Thickness").value_or(0);
  return std::abs(thickness) > 1e18 ? infinity : thickness;
}

void LenshhReader::design(const JsonObject& root) {
  DesignData& design = in_.lens.design;
  const JsonObject aperture = root.object("Aperture");
  design.aperture = DesignAperture{word_of(aperture, "Type", "EPD FNumber", "EPD or FNumber") == "EPD"
                                       ? ApertureSetting::entrance_pupil_diameter
                                       : ApertureSetting::f_number,
                                   aperture.needed("Value")};
  const bool angles =
      word_of(root, "FieldType", "ObjectAngle ObjectHeight", "ObjectAngle or ObjectHeight") == "ObjectAngle";
  design.field_kind = angles ? FieldKind::angle_deg : FieldKind::object_height;
  for (std::size_t i = 0; i < std::min<std::size_t>(root.list("Fields").size(), 1000); ++i) {
    const JsonObject f = root.entry("Fields", i);
    design.fields.push_back({.y = f.number("Y").value_or(0), .weight = f.number("Weight").value_or(1)});
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(root.list("Wavelengths").size(), 1000); ++i) {
    const JsonObject w = root.entry("Wavelengths", i);
    design.wavelengths.push_back({*number(to_text(w.needed("Value") * 1e3, 12)), w.number("Weight").value_or(1)});
    if (w.flag("IsPrimary")) design.primary_wavelength = i;
  }
}

Medium LenshhReader::medium(const JsonObject& s) {
  const std::string name = s.text("Material");
  if (name.empty() || same(name, "AIR") || same(name, "VACUUM")) return {};
  if (const auto code = medium_of_code(name)) return *code;
  return in_.glass(0, name, catalogues_, {}, {});
}

SurfaceRow LenshhReader::row(const JsonObject& s, const Medium& before) {
  const std::string type = word_of(s, "Type", "Standard EvenAsphere", "Standard or EvenAsphere");
  SurfaceRow row{.radius = s.number("Radius").value_or(infinity), .thickness = thickness_of(s)};
  if (std::isinf(row.radius)) row.radius = 0;
  if (std::isinf(row.thickness)) s.refuse("Thickness", shown(*s.find("Thickness")), "finite behind a surface");
  row.conic = s.number("Conic").value_or(0);
  if (type == "EvenAsphere") row.aspheric = s.terms("AsphericCoefficients", 2, 2);
  row.stop = s.flag("IsStop");
  row.mirror = same(s.text("Material"), "MIRROR");
  row.medium = row.mirror ? before : medium(s);
  // A floating aperture and a fixed semi-diameter at the stop clip. Other semi-diameters clip at elements only.
  const double rim = s.number("SemiDiameter").value_or(0), floating = s.number("FloatingApertureRadius").value_or(0);
  const bool fixed = s.text("SemiDiameterMode") == "Fixed", element = row.mirror || !(row.medium == before);
  if (rim > 0 && (row.stop ? fixed : element)) row.semi_diameter = rim;
  if (floating > 0) row.semi_diameter = floating;
  const double hole = std::max(s.number("InnerRadius").value_or(0), s.number("ObscurationRadius").value_or(0));
  if (hole > 0) row.obscuration_semi_diameter = hole;
  if (const std::string comment = s.text("Comment"); !comment.empty()) row.comment = comment;
  // Flags and bounds of the optimiser do not change the lens.
  s.name_others({"Index",
                 "Type",
                 "Comment",
                 "Radius",
                 "Thickness",
                 "Material",
                 "SemiDiameter",
                 "SemiDiameterMode",
                 "ClearAperturePercent",
                 "Conic",
                 "IsStop",
                 "InnerRadius",
                 "ObscurationRadius",
                 "FloatingApertureRadius",
                 "AsphericCoefficients",
                 "CurvatureVariable",
                 "ThicknessVariable",
                 "ConicVariable",
                 "AsphericVariable",
                 "HasMarginalRaySolve",
                 "CurvatureMin",
                 "CurvatureMax",
                 "ThicknessMin",
                 "ThicknessMax",
                 "ConicMin",
                 "ConicMax",
                 "AsphericMin",
                 "AsphericMax"});
  return row;
}

void LenshhReader::surfaces(const JsonObject& root) {
  const std::size_t count = root.list("Surfaces").size();
  in_.limit(count, "surfaces", 2);
  if (count < 3) root.refuse("Surfaces", std::to_string(count) + " surfaces", "an object, a lens and an image");
  Medium before = in_.lens.object_space = medium(root.entry("Surfaces", 0));
  in_.lens.design.object_distance_mm = thickness_of(root.entry("Surfaces", 0));
  for (std::size_t i = 1; i + 1 < count; ++i) {
    in_.lens.surfaces.push_back(row(root.entry("Surfaces", i), before));
    before = in_.lens.surfaces.back().medium;
  }
  in_.lens.semi_diameters = "of the file: apertures, else the widths of the design's beams";
}

void LenshhReader::read(std::string_view text) {
  const io_detail::JsonTree tree(text, in_.where(), words_of_path);
  const JsonObject root{tree.root(), "file", in_, tree};
  if (root.needed("FormatVersion") != 1) root.refuse("FormatVersion", shown(*root.find("FormatVersion")), "1");
  in_.lens.imported->title = root.text("Title");
  for (const char* key : {"Designer", "Notes"}) in_.note(root.text(key));
  design(root);
  if (root.find("GlassCatalogs")) {
    for (const nlohmann::json& name : root.list("GlassCatalogs")) {
      if (!name.is_string()) root.refuse("GlassCatalogs", shown(name), "names");
      catalogues_.push_back(name.get<std::string>());
    }
  }
  surfaces(root);
  if (root.find("Pickups") && !root.list("Pickups").empty()) {
    in_.warn(0, "file.Pickups", "are not evaluated; the values that the file states are taken");
  }
  root.name_others({"FormatVersion", "Title", "Notes", "Designer", "Aperture", "FieldType", "Surfaces", "Wavelengths",
                    "Fields", "Pickups", "RayAiming", "IsAfocal", "PenalizeVignetting", "GlassCatalogs",
                    "GlassSubstitutions", "MeritFunction"});
}

}  // namespace

bool is_lenshh(std::string_view text) {
  return trimmed(text).starts_with('{') && text.find("\"FormatVersion\"") != std::string_view::npos &&
         text.find("\"Surfaces\"") != std::string_view::npos;
}

void read_lenshh(std::string_view text, Import& in) { LenshhReader(in).read(text); }

}  // namespace petzval::formats_detail
