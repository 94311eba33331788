// SPDX-License-Identifier: Apache-2.0
// DeepLens JSON: surfaces in front of a sensor, each with its distance d_next to the next surface or the sensor.
#include <array>
#include <cmath>
#include <map>

#include "core/text.hpp"
#include "io/json.hpp"
#include "json_object.hpp"
#include "petzval/core/error.hpp"
#include "readers.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

/// Plastics of DeepLens (materials_data.json) that no glass table has, with their n_d and V_d.
const std::map<std::string, Medium> plastics = {{"coc", {.nd = 1.5337, .vd = 56.22}},
                                                {"apl5014cl", {.nd = 1.5445, .vd = 55.99}},
                                                {"okp4", {.nd = 1.6328, .vd = 23.34}},
                                                {"okp4ht", {.nd = 1.6328, .vd = 23.34}}};

class DeeplensReader {
 public:
  explicit DeeplensReader(Import& in) : in_(in) {}
  void read(std::string_view text);

 private:
  SurfaceRow row(const JsonObject& s, const Medium& before);
  Medium medium(const JsonObject& s);

  Import& in_;
};

/// A name, or n_d and V_d: "1.5168/64.17".
Medium DeeplensReader::medium(const JsonObject& s) {
  const std::string name = s.text("mat2");
  if (same(name, "air") || same(name, "vacuum") || same(name, "occluder")) return {};
  if (const std::size_t slash = name.find('/'); slash != std::string::npos) {
    const auto nd = number(name.substr(0, slash)), vd = number(name.substr(slash + 1));
    if (!nd || !vd) s.refuse("mat2", shown(*s.find("mat2")), "a name, or n_d/V_d");
    return {.nd = nd, .vd = vd};
  }
  if (name.empty()) s.refuse("mat2", "missing", "a material");
  if (const auto plastic = plastics.find(lower(name)); plastic != plastics.end()) return plastic->second;
  // The program searches its catalogues in this order.
  static const std::array<std::string, 3> catalogues = {"schott", "cdgm", "misc"};
  return in_.glass(0, name, catalogues, {}, {});
}

SurfaceRow DeeplensReader::row(const JsonObject& s, const Medium& before) {
  const std::string type = s.text("type");
  SurfaceRow row{.thickness = s.needed("d_next"), .medium = before, .stop = type == "Aperture" || type == "Stop"};
  if (!row.stop && type != "Plane" && type != "Spheric" && type != "Aspheric") {
    s.refuse("type", io_detail::in_quotes(type), "Aperture, Stop, Plane, Spheric or Aspheric");
  }
  if (type == "Spheric" || type == "Aspheric") {
    const auto radius = s.number("roc");
    const double curvature = radius ? 0 : s.needed("c");
    row.radius = radius && std::isfinite(*radius) ? *radius : curvature == 0 ? 0 : 1 / curvature;
  }
  if (type == "Aspheric") {
    row.conic = s.number("k").value_or(0);
    row.aspheric = s.terms("ai", 2, 2);
  }
  if (!row.stop) row.medium = medium(s);
  if (s.flag("is_square")) {
    in_.warn(0, s.path + ".is_square", "the square rim is left out");
  } else if (const auto rim = s.number("r")) {
    row.semi_diameter = rim;
  }
  return row;
}

void DeeplensReader::read(std::string_view text) {
  const io_detail::JsonTree tree(text, in_.where(), words_of_path);
  const JsonObject root{tree.root(), "file", in_, tree};
  if (const std::string title = root.text("info"); title != "None") in_.lens.imported->title = title;
  in_.lens.focal_length_mm = root.number("foclen");
  in_.lens.f_number = root.number("fnum");
  if (const auto corner = root.number("r_sensor")) in_.lens.image_diagonal_mm = 2 * *corner;
  const std::size_t count = root.list("surfaces").size();
  in_.limit(count);
  if (count == 0) root.refuse("surfaces", "no surfaces", "at least one");
  Medium before;
  double film = 0;
  for (std::size_t i = 0; i < count; ++i) {
    in_.lens.surfaces.push_back(row(root.entry("surfaces", i), before));
    before = in_.lens.surfaces.back().medium;
    film += in_.lens.surfaces.back().thickness;
  }
  in_.lens.semi_diameters = "of the file";
  if (const auto sensor = root.number("d_sensor"); sensor && std::abs(*sensor - film) > 1e-2) {
    in_.warn(0, "file.d_sensor",
             to_text(*sensor, 6) + " mm is left out; the values of d_next end at " + to_text(film, 6) + " mm");
  }
  root.name_others({"info", "foclen", "fnum", "enpd", "r_sensor", "r_last", "d_sensor", "(d_sensor)", "sensor_size",
                    "(sensor_size)", "sensor_res", "surfaces"});
}

}  // namespace

bool is_deeplens(std::string_view text) {
  return trimmed(text).starts_with('{') && text.find("\"d_next\"") != std::string_view::npos &&
         text.find("\"surfaces\"") != std::string_view::npos;
}

void read_deeplens(std::string_view text, Import& in) { DeeplensReader(in).read(text); }

}  // namespace petzval::formats_detail
