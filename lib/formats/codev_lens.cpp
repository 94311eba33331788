// SPDX-License-Identifier: Apache-2.0
#include "codev_lens.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

class CodevBuilder {
 public:
  CodevBuilder(CodevLens& codev, Import& in) : lens_(codev), in_(in) {}
  void build();

 private:
  static double* member(CodevSurface& s, std::string_view what);
  void evaluate_pickups();
  void choose_shapes();
  Medium medium(const CodevSurface& s);
  std::optional<ApertureSetting> aperture_setting(std::string_view what) const;
  void build_zooms();

  CodevLens& lens_;
  Import& in_;
};

double* CodevBuilder::member(CodevSurface& s, std::string_view what) {
  if (what == "rdy" || what == "cuy") return &s.shape;
  if (what == "thi") return &s.thickness;
  if (what == "k") return &s.conic;
  return nullptr;
}

void CodevBuilder::evaluate_pickups() {
  for (const CodevPickup& p : lens_.pickups) {
    const auto inside = [&](int at) { return at >= 0 && static_cast<std::size_t>(at) < lens_.surfaces.size(); };
    if (!inside(p.surface) || !inside(p.from)) {
      in_.refuse(p.line, "PIK", "a surface that does not exist", "a surface of the file");
    }
    CodevSurface& to = lens_.surfaces[static_cast<std::size_t>(p.surface)];
    CodevSurface& from = lens_.surfaces[static_cast<std::size_t>(p.from)];
    if (p.what == "gla") {
      to.glass = from.glass;
      continue;
    }
    double* value = member(to, p.what);
    const double* source = member(from, p.of.empty() ? p.what : p.of);
    if (!value || !source) {
      in_.warn(p.line, "PIK", "of " + p.what + " is not evaluated; the value in the file is taken");
      continue;
    }
    const double scale = value == &to.shape && !*lens_.curvatures && p.scale != 0 ? 1 / p.scale : p.scale;
    const double expected = *source * scale;
    if (std::abs(*value - expected) > 1e-9 * std::abs(expected)) {
      in_.warn(p.line, "PIK",
               "the file states " + to_text(*value, 12) + ", the pickup gives " + to_text(expected, 12) +
                   ", which is taken");
      *value = expected;
    }
  }
}

/// Without RDM, CODE V reads curvatures, but other programs write radii without RDM. The numbers are taken as radii if
/// a surface would be impossibly steep with these numbers as curvatures.
void CodevBuilder::choose_shapes() {
  if (lens_.curvatures) return;
  const auto& aperture = in_.lens.design.aperture;
  const bool has_pupil = aperture && aperture->setting == ApertureSetting::entrance_pupil_diameter;
  bool impossible = false;
  for (const CodevSurface& s : lens_.surfaces) {
    const double height = s.aperture.value_or(has_pupil ? aperture->value / 4 : 0);
    impossible = impossible || std::abs(s.shape) * height >= 1 || std::abs(s.shape * s.thickness) > 50;
  }
  lens_.curvatures = !impossible;
  in_.warn(0, "RDM",
           impossible ? "is missing; the first number of a surface is taken as its radius, as it would be too "
                        "steep as a curvature"
                      : "is missing; the first number of a surface is taken as its curvature");
}

Medium CodevBuilder::medium(const CodevSurface& s) {
  std::string_view name = s.glass;
  if (name.empty() || same(name, "AIR")) return {};
  const auto own =
      std::ranges::find_if(lens_.private_glasses, [&](const PrivateGlass& g) { return same(g.name, name); });
  if (own != lens_.private_glasses.end()) {
    // n_d is the index nearest to the d line; V_d comes from the indices nearest to F and C.
    const auto at = [&](double nm) -> std::optional<double> {
      std::optional<double> best;
      double distance = 3;
      for (std::size_t i = 0; i < std::min(lens_.private_nm.size(), own->indices.size()); ++i) {
        if (std::abs(lens_.private_nm[i] - nm) < distance)
          distance = std::abs(lens_.private_nm[i] - nm), best = own->indices[i];
      }
      return best;
    };
    const auto nd = at(587.5618), nf = at(486.1327), nc = at(656.2725);
    if (!nd) {
      in_.refuse(s.line, s.glass, "a private glass without an index at the d line",
                 "a glass with an index near 587.56 nm (PWL)");
    }
    Medium medium{.glass = own->name, .nd = *nd};
    if (nf && nc) medium.vd = *nf == *nc ? 0 : (*nd - 1) / (*nf - *nc);
    in_.warn(s.line, s.glass,
             medium.vd ? "has n_d and V_d from its private indices" : "has only n_d, from its private indices");
    return medium;
  }
  // 1.5168:64.17, n_d and V_d
  if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) {
    const auto nd = number(name.substr(0, colon)), vd = number(name.substr(colon + 1));
    if (nd && vd && *nd >= 1 && *vd > 0) return {.nd = *nd, .vd = *vd};
  }
  if (const auto code = medium_of_code(name)) return *code;
  if (const auto nd = number(name); nd && *nd >= 1 && *nd <= 5) return {.nd = *nd};
  std::vector<std::string> catalogues;
  if (const std::size_t maker = name.find_last_of('_'); maker != std::string_view::npos) {
    catalogues.emplace_back(name.substr(maker + 1));
    return in_.glass(s.line, name.substr(0, maker), catalogues, {}, {});
  }
  return in_.glass(s.line, name, catalogues, {}, {});
}

void CodevBuilder::build() {
  if (lens_.surfaces.size() < 3 || !lens_.ended) {
    throw Error(in_.where() + ": " + std::to_string(lens_.surfaces.size()) + " surfaces" +
                (lens_.ended ? "" : " without SI") + "; must be SO, at least one S, and SI");
  }
  if (!lens_.unit_given) in_.warn(0, "DIM", "is missing; lengths are taken as millimetres");
  choose_shapes();
  evaluate_pickups();
  DesignData& design = in_.lens.design;
  if (design.aperture && design.aperture->setting == ApertureSetting::entrance_pupil_diameter)
    design.aperture->value *= lens_.unit;
  if (design.field_kind != FieldKind::angle_deg) {
    for (DesignField& f : design.fields) f.x *= lens_.unit, f.y *= lens_.unit;
  }
  for (std::size_t i = 0; i < std::min(lens_.vignetting.size(), design.fields.size()); ++i) {
    const auto [upper, lower_y, right, left] = lens_.vignetting[i];
    design.fields[i].compress_y = (upper + lower_y) / 2;
    design.fields[i].decentre_y = (lower_y - upper) / 2;
    design.fields[i].compress_x = (right + left) / 2;
    design.fields[i].decentre_x = (left - right) / 2;
  }
  const double object = lens_.surfaces.front().thickness;
  design.object_distance_mm =
      std::abs(object) >= codev_endless ? std::numeric_limits<double>::infinity() : object * lens_.unit;
  if (design.aperture && design.aperture->setting == ApertureSetting::working_f_number &&
      !std::isfinite(design.object_distance_mm)) {
    design.aperture->setting = ApertureSetting::f_number;
  }
  in_.lens.object_space = medium(lens_.surfaces.front());
  if (lens_.surfaces.back().shape != 0)
    in_.warn(lens_.surfaces.back().line, "SI", "the image is curved; a flat film is taken");

  Medium before = in_.lens.object_space;
  for (const CodevSurface& s : std::span(lens_.surfaces).subspan(1, lens_.surfaces.size() - 2)) {
    SurfaceRow& row = in_.lens.surfaces.emplace_back();
    row.radius = s.shape == 0 ? 0 : *lens_.curvatures ? lens_.unit / s.shape : s.shape * lens_.unit;
    row.thickness = s.thickness * lens_.unit;
    row.conic = s.conic;
    for (const AsphereTerm& t : s.aspheric)
      row.aspheric.push_back({t.order, t.coefficient * std::pow(lens_.unit, 1 - t.order)});
    row.stop = s.stop;
    row.mirror = s.mirror;
    row.medium = s.mirror ? before : medium(s);
    if (s.aperture || s.edge) row.semi_diameter = (s.aperture ? *s.aperture : *s.edge) * lens_.unit;
    if (s.obscuration) row.obscuration_semi_diameter = *s.obscuration * lens_.unit;
    if (!s.label.empty()) row.comment = s.label;
    // CYL without RDX is curved in y. If the surface is a plane in y, RDX is the radius in x.
    if (s.shape != 0 && (s.cylinder_x || s.cylinder_y)) row.curved_in = s.cylinder_x ? Section::x : Section::y;
    before = row.medium;
  }
  // The thickness of the image surface moves the film away from the position that the last surface gives.
  in_.lens.surfaces.back().thickness += lens_.surfaces.back().thickness * lens_.unit;
  // PIM puts the film at the paraxial image. The file states its distance if CODE V saved the solution.
  if (lens_.paraxial_image > 0) {
    in_.requests.solves.push_back({.line = lens_.paraxial_image,
                                   .command = "PIM",
                                   .surface = in_.lens.surfaces.size() - 1,
                                   .offset = lens_.surfaces.back().thickness * lens_.unit,
                                   .is_taken = true});
  }
  build_zooms();
}

/// The setting of the design's aperture if `what` is its command.
std::optional<ApertureSetting> CodevBuilder::aperture_setting(std::string_view what) const {
  using enum ApertureSetting;
  const auto& aperture = in_.lens.design.aperture;
  if (!aperture) return {};
  const ApertureSetting setting = aperture->setting;
  const bool same = (what == "epd" && setting == entrance_pupil_diameter) ||
                    (what == "fno" && (setting == f_number || setting == working_f_number)) ||
                    (what == "na" && setting == image_na) || (what == "nao" && setting == object_na);
  return same ? std::optional(setting) : std::nullopt;
}

void CodevBuilder::build_zooms() {
  if (lens_.zoom_positions < 2) return;
  auto& list = in_.lens.configurations;
  list.resize(lens_.zoom_positions);
  for (std::size_t i = 0; i < list.size(); ++i) list[i].name = "position " + std::to_string(i + 1);
  std::map<int, std::size_t> change_of;  // surface to index of its change; the same in all positions
  for (const CodevZoom& z : lens_.zooms) {
    const bool lens_value = z.what == "thi" || z.what == "rdy" || z.what == "cuy";
    const auto setting = aperture_setting(z.what);
    if (!lens_value && !setting && z.what != "fno" && z.what != "tit") {
      in_.warn(z.line, "ZOO", "of " + z.what + " is left out; all positions have the value of the first one");
      continue;
    }
    if (z.values.size() != lens_.zoom_positions) {
      in_.refuse(z.line, "ZOO", "a list of " + std::to_string(z.values.size()) + " values",
                 std::to_string(lens_.zoom_positions) + " values, one per position");
    }
    const int last = static_cast<int>(in_.lens.surfaces.size()) - 1, surface = z.surface - 1;
    const bool of_object = z.what == "thi" && z.surface == 0;
    if (lens_value && !of_object && (surface < 0 || surface > last)) {
      in_.refuse(z.line, "ZOO", "surface " + std::to_string(z.surface), "a surface of the lens");
    }
    if (setting) in_.requests.position_apertures.resize(list.size());
    std::size_t changed = 0;
    if (lens_value && !of_object) {
      const auto [entry, first] = change_of.try_emplace(surface, change_of.size());
      changed = entry->second;
      for (std::size_t i = 0; first && i < list.size(); ++i) list[i].changes.emplace_back().surface = surface;
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (z.what == "tit") {
        if (!z.values[i].empty()) list[i].name = z.values[i];
        continue;
      }
      const double value = is_infinite(z.values[i]) ? codev_endless : in_.number(z.line, "ZOO", z.values[i]);
      if (z.what == "fno") list[i].f_number = value;
      if (setting) {
        const bool length = *setting == ApertureSetting::entrance_pupil_diameter;
        if (value > 0) in_.requests.position_apertures[i] = length ? value * lens_.unit : value;
      } else if (!lens_value) {
        continue;
      } else if (of_object) {
        if (value < codev_endless) list[i].subject_distance_mm = value * lens_.unit;
      } else {
        SurfaceChange& change = list[i].changes[changed];
        if (z.what == "thi") {
          const double defocus = surface == last ? lens_.surfaces.back().thickness : 0;
          change.thickness = (value + defocus) * lens_.unit;
        } else {
          const bool curvature = z.what == "cuy";
          change.radius = value == 0 ? 0 : curvature ? lens_.unit / value : value * lens_.unit;
        }
      }
    }
  }
}

}  // namespace

void build_codev(CodevLens codev, Import& in) { CodevBuilder(codev, in).build(); }

}  // namespace petzval::formats_detail
