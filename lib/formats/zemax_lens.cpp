// SPDX-License-Identifier: Apache-2.0
#include "zemax_lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/glass/glass.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {
namespace {

using Surfaces = std::vector<ZemaxSurface>;

// Thicknesses of 1e10 and more mean infinity.
constexpr double endless = 1e10;

/// True if two values agree within the digits of files, which store at least 12.
bool agree(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)) + 1e-15; }

double radius_of(double curvature) { return curvature == 0 ? 0 : 1 / curvature; }

// --- pickups --------------------------------------------------------------------------------------------------------

class Pickups {
 public:
  Pickups(Surfaces& surfaces, Import& in) : surfaces_(surfaces), in_(in) {}

  /// Evaluates pickups in the order of surfaces, as the source of a pickup may be picked up itself.
  void evaluate() {
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      ZemaxSurface& s = surfaces_[i];
      if (s.curvature_pickup) take(i, *s.curvature_pickup, "CURV", &ZemaxSurface::curvature);
      if (s.thickness_pickup) take(i, *s.thickness_pickup, "DISZ", &ZemaxSurface::thickness);
      if (s.thickness_sum) complete(i, *s.thickness_sum, "TCOM", false);
      if (s.position) complete(i, *s.position, "TOLE", true);
      if (s.glass && s.glass->pickup) take_glass(i);
    }
  }

 private:
  const ZemaxSurface& source(std::size_t i, int line, const char* command, int surface) const {
    const auto found = std::ranges::find(surfaces_, surface, &ZemaxSurface::number);
    if (found < surfaces_.begin() + static_cast<std::ptrdiff_t>(i)) return *found;
    in_.refuse(line, command, "a pickup from surface " + std::to_string(surface), "a pickup from an earlier surface");
  }

  /// Sets the value of a pickup or solve. If both agree, the digits of the file are kept.
  void set(int line, const char* command, double& value, double expected) const {
    if (agree(value, expected)) return;
    in_.warn(line, command,
             "the file states " + to_text(value, 12) + ", its pickup or solve gives " + to_text(expected, 12) +
                 ", which is taken");
    value = expected;
  }

  void take(std::size_t i, const ZemaxPickup& pickup, const char* command, double ZemaxSurface::*member) {
    const double picked = source(i, pickup.line, command, pickup.surface).*member;
    set(pickup.line, command, surfaces_[i].*member, picked * pickup.scale + pickup.offset);
  }

  /// Sets a thickness so that its sum with one other thickness, or with all thicknesses from a surface on, equals the
  /// total.
  void complete(std::size_t i, const ZemaxPickup& sum, const char* command, bool all) {
    double rest = sum.offset;
    for (const ZemaxSurface* k = &source(i, sum.line, command, sum.surface); k != &surfaces_[i]; ++k) {
      if (all || k->number == sum.surface) rest -= k->thickness;
    }
    set(sum.line, command, surfaces_[i].thickness, rest);
  }

  void take_glass(std::size_t i) {
    ZemaxGlass& glass = *surfaces_[i].glass;
    const ZemaxSurface& from = source(i, glass.line, "GLAS", *glass.pickup);
    if (!from.glass) {
      surfaces_[i].glass.reset();
      return;
    }
    const int line = glass.line;
    glass = *from.glass;
    glass.line = line;
  }

  Surfaces& surfaces_;
  Import& in_;
};

// --- rows -----------------------------------------------------------------------------------------------------------

class Rows {
 public:
  Rows(const ZemaxLens& zemax, double unit, Import& in) : zemax_(zemax), unit_(unit), in_(in) {}

  SurfaceRow row(const ZemaxSurface& s, const Medium& before);
  Medium medium(const ZemaxGlass& glass);
  /// Warns once for each name of a coating that row() does not know.
  void name_unknown_coatings() const;

 private:
  void asphere(const ZemaxSurface& s, SurfaceRow& row) const;
  void rims(const ZemaxSurface& s, const Medium& before, SurfaceRow& row) const;
  void clip_by_ring(const ZemaxSurface& s, SurfaceRow& row) const;
  void term(const ZemaxSurface& s, int order, double coefficient, SurfaceRow& row) const;
  std::optional<Coating> coating(const std::string& name, bool mirror) const;

  const ZemaxLens& zemax_;
  double unit_;
  Import& in_;
  struct UnknownCoating {
    int line = 0;          ///< first line
    std::string surfaces;  ///< numbers
  };
  std::map<std::string, UnknownCoating> unknown_coatings_;  ///< by name
};

Medium Rows::medium(const ZemaxGlass& glass) {
  if (same(glass.name, "AIR") || same(glass.name, "VACUUM")) return {};
  if (glass.model) {
    if (!glass.nd) in_.refuse(glass.line, "GLAS", "a model without n_d", "a model with n_d");
    return {.nd = *glass.nd, .vd = glass.vd};
  }
  // OpticStudio searches the catalogues of GCAT, or Schott if the file has no GCAT.
  static const std::vector<std::string> by_default{"SCHOTT"};
  const auto code = medium_of_code(glass.name);
  Medium result = code ? *code
                       : in_.glass(glass.line, glass.name, zemax_.catalogues.empty() ? by_default : zemax_.catalogues,
                                   glass.nd, glass.vd, Numbers::leftovers);
  if (glass.vd_offset != 0) {
    in_.warn(
        glass.line, "GLAS",
        "V_d is offset by " + to_text(glass.vd_offset) + "; the dispersion of " + glass.name + " is taken unchanged");
  }
  if (glass.nd_offset == 0) return result;
  if (!result.nd) {
    in_.refuse(glass.line, "GLAS", "an offset of " + glass.name + ", which has no index at the d line",
               "an offset of 0");
  }
  *result.nd += glass.nd_offset;
  return result;
}

void Rows::term(const ZemaxSurface& s, int order, double coefficient, SurfaceRow& row) const {
  if (coefficient == 0) return;
  if (order < 2) {
    in_.refuse(s.line, s.type, "a term of order " + std::to_string(order) + ", a cone", "of order 2 or higher");
  }
  if (order > 40) in_.refuse(s.line, s.type, "a term of order " + std::to_string(order), "of order 40 or less");
  row.aspheric.push_back({order, coefficient});
}

void Rows::asphere(const ZemaxSurface& s, SurfaceRow& row) const {
  if (s.type == "STANDARD") return;
  if (s.type == "EVENASPH" || s.type == "ODDASPHE") {
    // EVENASPH has even powers up to r^20, ODDASPHE all powers up to r^8.
    const int step = s.type == "EVENASPH" ? 2 : 1, last = s.type == "EVENASPH" ? 10 : 8;
    for (const auto& [number, value] : s.parameters) {
      if (value == 0) continue;
      if (number < 1 || number > last) {
        in_.refuse(s.line, s.type, "PARM " + std::to_string(number) + " of " + to_text(value),
                   "PARM 1 to " + std::to_string(last));
      }
      const int order = step * number;
      term(s, order, value * std::pow(unit_, 1 - order), row);
    }
    return;
  }
  if (s.type == "XASPHERE" || s.type == "XOSPHERE") {
    // The terms are powers of (r / r0); the first number is the number of terms.
    const auto extra = [&](int i) {
      const auto found = s.extra.find(i);
      return found == s.extra.end() ? 0.0 : found->second;
    };
    const int step = s.type == "XASPHERE" ? 2 : 1;
    const double r0 = extra(2) * unit_;
    const double count = extra(1);
    if (!(count >= 0 && count <= 1000)) in_.refuse(s.line, s.type, to_text(count) + " terms", "0 to 1000");
    for (int i = 1; i <= static_cast<int>(count); ++i) {
      const int order = step * i;
      if (extra(i + 2) == 0) continue;
      if (!(r0 > 0)) in_.refuse(s.line, s.type, "a normalisation radius of " + to_text(r0), "positive");
      term(s, order, extra(i + 2) * unit_ * std::pow(r0, -order), row);
    }
    return;
  }
  if (s.type == "TOROIDAL") {
    const bool only_a_cylinder =
        s.conic == 0 && std::ranges::all_of(s.parameters, [](const auto& p) { return p.second == 0; });
    if (only_a_cylinder) {
      row.curved_in = Section::y;
      return;
    }
  }
  in_.refuse(s.line, "TYPE", s.type,
             "STANDARD, EVENASPH, ODDASPHE, XASPHERE, XOSPHERE, COORDBRK, or a TOROIDAL that is a cylinder");
}

/// Sets the rim and the obscuration of a surface. Clear apertures (CLAP, FLAP) clip at any surface. Semi-diameters
/// (DIAM), set by the user or computed from the beams of the design, clip at elements. At the stop they clip if they
/// were set by the user or if the aperture of the design is the size of the stop. At dummy surfaces, with the same
/// medium on both sides, they do not clip.
void Rows::rims(const ZemaxSurface& s, const Medium& before, SurfaceRow& row) const {
  row.obscuration_semi_diameter = s.obscuration;
  const bool dummy = !row.mirror && row.medium == before;
  const auto& aperture = in_.lens.design.aperture;
  const bool floats = aperture && aperture->setting == ApertureSetting::stop_size;
  if (s.semi_diameter > 0 && (s.stop ? s.fixed_semi_diameter || floats : !dummy)) row.semi_diameter = s.semi_diameter;
  if (s.aperture) {
    // If the size of the stop defines the beam, a clear aperture at the stop clips that beam.
    row.semi_diameter = s.stop && floats ? std::min(*s.aperture, row.semi_diameter.value_or(*s.aperture)) : *s.aperture;
  }
  if (s.ring) clip_by_ring(s, row);
  if (row.obscuration_semi_diameter && row.semi_diameter && *row.semi_diameter <= *row.obscuration_semi_diameter) {
    row.semi_diameter.reset();  // here DIAM is the width of the beam that passes outside the ring
  }
}

/// A ring that blocks light up to the rim leaves an opening of its inner radius.
void Rows::clip_by_ring(const ZemaxSurface& s, SurfaceRow& row) const {
  const double rim = s.aperture.value_or(s.semi_diameter);
  if (!(rim > 0) || s.ring->outer < rim * (1 - 1e-9)) {
    in_.refuse(s.ring->line, "OBSC",
               "an opaque ring from " + to_text(s.ring->inner, 6) + " to " + to_text(s.ring->outer, 6) +
                   " mm that light passes inside and outside" +
                   (rim > 0 ? ": the rim is at " + to_text(rim, 6) + " mm" : std::string()),
               "a disc (OBSC 0 " + to_text(s.ring->outer, 6) + ") or a ring up to the rim");
  }
  row.semi_diameter = std::min(s.ring->inner, row.semi_diameter.value_or(s.ring->inner));
}

/// The coating of a name in the file COATING.DAT that OpticStudio supplies, if its definition is published: AR is a
/// quarter wave of MgF2 at the primary wavelength, and I.99 transmits 0.99 of the light and reflects the rest
/// (OpticStudio help, "Defining Coatings"). COATING.DAT tabulates indices of MgF2 from 1.384 at 400 nm to 1.376 at 700
/// nm; 1.38 is taken for all. OpticStudio takes the last layer on a mirror as the substrate, so AR is no coating of a
/// mirror.
std::optional<Coating> Rows::coating(const std::string& name, bool mirror) const {
  if (same(name, "AR") && !mirror) {
    const DesignData& design = in_.lens.design;
    const double nm = design.primary_wavelength < design.wavelengths.size()
                          ? design.wavelengths[design.primary_wavelength].nm
                          : in_.lens.reference_wavelength_nm;
    return Coating::quarter_wave(1.38, nm);
  }
  if (name.size() < 3 || !same(name.substr(0, 2), "I.") ||
      name.find_first_not_of("0123456789", 2) != std::string::npos) {
    return {};
  }
  const double reflectance = std::round((1 - number(name.substr(1)).value_or(0)) * 1e12) / 1e12;
  return Coating{.table = {{1, reflectance}, {1e6, reflectance}}};  // every wavelength
}

void Rows::name_unknown_coatings() const {
  for (const auto& [name, unknown] : unknown_coatings_) {
    in_.warn(unknown.line, "COAT",
             name + " on surface " + unknown.surfaces +
                 " has no known definition and is left out; known: AR (not on a mirror) and I.nn");
  }
}

SurfaceRow Rows::row(const ZemaxSurface& s, const Medium& before) {
  SurfaceRow row{.radius = radius_of(s.curvature), .thickness = s.thickness};
  if (std::abs(row.thickness) >= endless) {
    in_.refuse(s.line, "DISZ", "infinite behind a surface of the lens", "finite");
  }
  row.conic = s.conic;
  row.stop = s.stop;
  if (!s.comment.empty()) row.comment = s.comment;
  row.mirror = s.glass && same(s.glass->name, "MIRROR");
  if (!s.coating.empty()) {
    row.coating = coating(s.coating, row.mirror);
    if (!row.coating) {
      UnknownCoating& unknown =
          unknown_coatings_.try_emplace(s.coating, UnknownCoating{s.coating_line, {}}).first->second;
      append(unknown.surfaces, ", ", std::to_string(in_.lens.surfaces.size()));
    }
  }
  if (row.mirror) {
    row.medium = before;
  } else if (s.glass) {
    row.medium = medium(*s.glass);
  }
  asphere(s, row);
  rims(s, before, row);
  return row;
}

// --- configurations ---------------------------------------------------------------------------------------------

/// Operands that do not change the lens: weights, comments, drawing.
constexpr std::string_view silent_operands = "MOFF FLWT WLWT CWGT GCRS NCOM MCOM SDRW";

class Configurations {
 public:
  Configurations(const ZemaxLens& zemax, double unit, Rows& rows, Import& in)
      : zemax_(zemax), unit_(unit), rows_(rows), in_(in) {}

  void build();

 private:
  void take(const ZemaxOperand& operand);
  void aperture(const ZemaxOperand& operand, double value);
  SurfaceChange& change(Configuration& c, const ZemaxOperand& operand);

  const ZemaxLens& zemax_;
  double unit_;
  Rows& rows_;
  Import& in_;
  std::map<std::pair<std::string, int>, std::pair<std::string, bool>> left_out_;  ///< first value; true if varied
};

void Configurations::aperture(const ZemaxOperand& operand, double value) {
  const auto position = static_cast<std::size_t>(operand.configuration) - 1;
  const ApertureSetting setting = in_.lens.design.aperture->setting;
  if (setting == ApertureSetting::f_number) in_.lens.configurations[position].f_number = value;
  if (!(value > 0)) return;
  in_.requests.position_apertures.resize(in_.lens.configurations.size());
  in_.requests.position_apertures[position] =
      setting == ApertureSetting::entrance_pupil_diameter ? value * unit_ : value;
}

/// The change of the operand's surface.
/// @throws Error if the surface is not a row of the lens
SurfaceChange& Configurations::change(Configuration& c, const ZemaxOperand& operand) {
  const auto rows = std::span(zemax_.surfaces).subspan(1, zemax_.surfaces.size() - 2);
  const auto found = std::ranges::find(rows, operand.surface, &ZemaxSurface::number);
  if (found == rows.end()) {
    in_.refuse(operand.line, operand.name, "surface " + std::to_string(operand.surface), "a surface of the lens");
  }
  return change_of(c, static_cast<int>(found - rows.begin()));
}

void Configurations::take(const ZemaxOperand& operand) {
  auto& list = in_.lens.configurations;
  if (operand.configuration < 1 || static_cast<std::size_t>(operand.configuration) > list.size()) {
    in_.refuse(operand.line, operand.name, "configuration " + std::to_string(operand.configuration),
               "1 to " + std::to_string(list.size()));
  }
  Configuration& c = list[static_cast<std::size_t>(operand.configuration) - 1];
  const auto value = [&] { return in_.number(operand.line, operand.name, operand.value); };
  if (entry_of(silent_operands, operand.name) == operand.name) return;
  if (operand.name == "LTTL") {
    if (!operand.value.empty()) c.name = operand.value;
  } else if (operand.name == "THIC" && operand.surface == 0) {
    const double distance = same(operand.value, "INFINITY") ? endless : value() * unit_;
    if (distance > 0 && distance < endless) c.subject_distance_mm = distance;
  } else if (operand.name == "THIC") {
    change(c, operand).thickness = value() * unit_;
  } else if (operand.name == "CRVT") {
    change(c, operand).radius = radius_of(value() / unit_);
  } else if (operand.name == "CONN") {
    change(c, operand).conic = value();
  } else if (operand.name == "SDIA") {
    // 0 means no rim, as for DIAM.
    if (const double rim = std::abs(value() * unit_); rim > 0) change(c, operand).semi_diameter = rim;
  } else if (operand.name == "GLSS") {
    change(c, operand).medium = rows_.medium({.line = operand.line, .name = operand.value});
  } else if (operand.name == "APER" && in_.lens.design.aperture &&
             in_.lens.design.aperture->setting != ApertureSetting::stop_size) {
    aperture(operand, value());
  } else {
    const auto [entry, first] = left_out_.try_emplace({operand.name, operand.surface}, std::pair{operand.value, false});
    if (first || entry->second.second || entry->second.first == operand.value) return;
    entry->second.second = true;
    in_.warn(operand.line, operand.name, "its values differ among the configurations; it is left out");
  }
}

void Configurations::build() {
  if (zemax_.configurations < 2) return;
  auto& list = in_.lens.configurations;
  list.resize(static_cast<std::size_t>(zemax_.configurations));
  for (std::size_t i = 0; i < list.size(); ++i) list[i].name = "position " + std::to_string(i + 1);
  for (const ZemaxOperand& operand : zemax_.operands) take(operand);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto earlier = std::ranges::find(list, list[i].name, &Configuration::name);
    if (earlier != list.begin() + static_cast<std::ptrdiff_t>(i)) list[i].name += " (" + std::to_string(i + 1) + ")";
  }
  // If exactly one position is at infinity, the others are focus positions of it.
  const auto far = [](const Configuration& c) { return !c.subject_distance_mm; };
  if (std::ranges::count_if(list, far) != 1 || !far(list[0])) return;
  for (Configuration& c : list) {
    if (!far(c)) c.focus_of = list[0].name;
  }
}

// --- solves ---------------------------------------------------------------------------------------------------------

/// MAZH behind the last surface: the film is at the axial crossing of the marginal ray, and the file states its
/// distance. If the distance is missing, it is computed. If it differs from the rays of this lens, it is kept and a
/// warning is added.
void solve_the_film(const ZemaxSurface& last, Import& in) {
  const auto [height, zone] = *last.marginal_height;
  const DesignData& design = in.lens.design;
  const bool missing = in.lens.surfaces.back().thickness == 0;
  using enum ApertureSetting;
  const bool has_pupil = design.aperture && std::isinf(design.object_distance_mm) && design.aperture->value != 0 &&
                         (design.aperture->setting == entrance_pupil_diameter || design.aperture->setting == f_number);
  if (height == 0 && (zone == 0 || has_pupil)) {
    in.requests.solves.push_back({.line = last.solve_line,
                                  .command = "MAZH",
                                  .surface = in.lens.surfaces.size() - 1,
                                  .zone = zone,
                                  .is_taken = missing});
  } else if (missing) {
    in.warn(last.solve_line, "MAZH",
            "the file states a thickness of 0, and its solve is not evaluated; the film is at the last surface");
  }
}

/// Checks that object and film are planes perpendicular to the axis.
void check_ends(const ZemaxSurface& object, const ZemaxSurface& image, Import& in) {
  const bool near = std::isfinite(in.lens.design.object_distance_mm);
  const auto refuse_tilt = [&](const ZemaxSurface& s, const std::string& location, const std::string& instead) {
    if (s.type != "TILTSURF") return;
    // PARM 1 and 2: tangents of the tilts in x and y.
    for (const int axis : {1, 2}) {
      const auto tangent = s.parameters.find(axis);
      if (tangent == s.parameters.end() || tangent->second == 0) continue;
      in.refuse(s.line, "TYPE",
                "a TILTSURF at the " + location + ", tilted by " +
                    to_text(std::atan(tangent->second) * 180 / std::acos(-1.0), 4) + " degrees in " +
                    (axis == 1 ? "x" : "y"),
                "an upright " + location + ": set PARM 1 and 2 to 0" + instead);
    }
  };
  if (near) refuse_tilt(object, "object", " and focus on the tilted plane with a tilted film");
  refuse_tilt(image, "image", " and tilt the film of the camera instead");
  const auto curved = [](const ZemaxSurface& s) {
    const bool terms = s.type == "EVENASPH" || s.type == "ODDASPHE";
    return s.curvature != 0 ||
           (terms && std::ranges::any_of(s.parameters, [](const auto& p) { return p.second != 0; }));
  };
  if (near && curved(object)) in.warn(object.line, "SURF", "the object is curved; a flat object is taken");
  if (curved(image)) in.warn(image.line, "SURF", "the image is curved; a flat film is taken");
}

}  // namespace

void build_lens(ZemaxLens zemax, double unit, Import& in) {
  Pickups(zemax.surfaces, in).evaluate();
  fold_breaks(zemax.surfaces, in);
  if (zemax.surfaces.size() < 3) throw Error(in.where() + ": no surface of a lens; must be at least one");

  const ZemaxSurface &object = zemax.surfaces.front(), &image = zemax.surfaces.back();
  DesignData& design = in.lens.design;
  design.object_distance_mm =
      std::abs(object.thickness) >= endless ? std::numeric_limits<double>::infinity() : object.thickness;
  Rows rows(zemax, unit, in);
  if (object.glass) in.lens.object_space = rows.medium(*object.glass);
  if (object.stop) in.refuse(object.line, "STOP", "the object", "a surface of the lens");
  for (const ZemaxSurface& s : zemax.surfaces) {
    if (s.has_thickness || &s == &image) continue;
    in.warn(s.line, "DISZ", "is missing for this surface; 0 is taken");
  }
  if (image.glass)
    in.refuse(image.line, "SURF", "a last surface with a glass", "followed by an image: the file is cut off");
  if (!image.has_thickness) in.warn(image.line, "SURF", "the image is incomplete; the file may be cut off");
  const auto stops = std::ranges::count_if(zemax.surfaces, &ZemaxSurface::stop);
  if (stops > 1) in.warn(0, "STOP", "is marked on " + std::to_string(stops) + " surfaces; the first one is taken");
  check_ends(object, image, in);

  // If light leaves as a parallel beam, there is no film.
  ZemaxSurface& last = zemax.surfaces[zemax.surfaces.size() - 2];
  const bool image_at_infinity = std::abs(last.thickness) >= endless;
  if (image_at_infinity) last.thickness = 0;
  Medium before = in.lens.object_space;
  for (const ZemaxSurface& s : std::span(zemax.surfaces).subspan(1, zemax.surfaces.size() - 2)) {
    in.lens.surfaces.push_back(rows.row(s, before));
    before = in.lens.surfaces.back().medium;
  }
  rows.name_unknown_coatings();
  if (image_at_infinity)
    in.requests.film_at_focus = {.line = last.line, .command = "DISZ", .reason = "the image is at infinity"};
  if (image.stop) in.refuse(image.line, "STOP", "the image", "a surface of the lens");
  in.requests.telecentric_line = zemax.telecentric;
  in.requests.telecentric_command = "FTYP";
  in.lens.semi_diameters = "of the file: clear apertures, else the widths of the design's beams";
  Configurations(zemax, unit, rows, in).build();
  if (last.marginal_height && !image_at_infinity) solve_the_film(last, in);
}

}  // namespace petzval::formats_detail
