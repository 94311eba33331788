// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.hpp"
#include "oslo_surface.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval::formats_detail {
namespace {

// OSLO treats thicknesses of 1e8 and more as infinite, and writes 1e10 or 1e20.
constexpr double endless = 1e8;

class Builder {
 public:
  Builder(OsloLens& oslo, Import& in) : oslo_(oslo), in_(in) {}
  void build();

 private:
  void pick_up();
  SurfaceRow row(const OsloSurface& s, const Medium& before);
  Medium medium(const OsloMedium& m, const Medium& before);
  Medium medium_of_indices(const OsloMedium& m);
  void solve(std::size_t i);
  double defocus() const;
  void place_film();
  void declare();
  double object_distance() const;

  OsloLens& oslo_;
  Import& in_;
};

double Builder::object_distance() const {
  const double thickness = oslo_.surfaces.front().thickness.value_or(endless);
  return std::abs(thickness) >= endless ? std::numeric_limits<double>::infinity() : thickness * oslo_.unit;
}

/// Evaluates pickups in the order of surfaces, as the source of a pickup may be picked up itself.
void Builder::pick_up() {
  for (OsloSurface& s : oslo_.surfaces) {
    for (const OsloPickup& p : s.pickups) {
      const OsloSurface& from = oslo_.surfaces[static_cast<std::size_t>(p.surface)];
      if (p.what == "CV" || p.what == "CVM") {
        const double sign = p.what == "CV" ? 1 : -1;
        s.curvature = sign * from.curvature + p.constant;
        // The rest of the shape is picked up too, unless the surface has a shape of its own.
        if (s.conic == 0) s.conic = from.conic;
        if (s.terms.empty()) {
          for (const auto& [order, coefficient] : from.terms) s.terms[order] = sign * coefficient;
        }
      } else if (p.what == "TH" || p.what == "THM") {
        s.thickness = (p.what == "TH" ? 1 : -1) * from.thickness.value_or(0) + p.constant;
      } else if (p.what == "GLA") {
        s.medium = from.medium;
        s.medium.line = p.line;
      } else if (p.what == "AP") {
        s.aperture = from.aperture;
      } else {
        s.conic = from.conic + p.constant;
      }
    }
  }
}

/// n_d and V_d from indices at wavelengths: n = A + B / l^2 through the shortest and the longest.
Medium Builder::medium_of_indices(const OsloMedium& m) {
  auto wavelengths = m.wavelengths.empty() ? oslo_.wavelengths : m.wavelengths;
  if (wavelengths.empty()) wavelengths = {0.58756, 0.48613, 0.65627};
  const std::size_t count = std::min(wavelengths.size(), m.indices.size());
  const double first = m.indices.front();
  if (!(first > 0)) in_.refuse(m.line, "GLA", "an index of " + to_text(first), "positive");
  const auto weight = [&](std::size_t i) { return 1 / (wavelengths[i] * wavelengths[i]); };
  std::size_t low = 0, high = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (wavelengths[i] < wavelengths[low]) low = i;
    if (wavelengths[i] > wavelengths[high]) high = i;
  }
  const double change = m.indices[low] - m.indices[high];
  double nd = first;
  if (low == high) return {.nd = nd};
  if (change == 0) return {.nd = nd, .vd = 0};
  const double slope = change / (weight(low) - weight(high));
  const auto inverse_square = [](double nm) { return 1e6 / (nm * nm); };
  if (std::abs(wavelengths[0] * 1000 - d_line_nm) >= 0.1) nd += slope * (inverse_square(d_line_nm) - weight(0));
  Medium result{.nd = nd};
  const double f_minus_c = slope * (inverse_square(spectral_line_nm("F")) - inverse_square(spectral_line_nm("C")));
  if ((nd - 1) / f_minus_c > 0) result.vd = (nd - 1) / f_minus_c;
  in_.warn(m.line, "GLA",
           "indices at wavelengths are taken as n_d " + to_text(nd, 7) +
               (result.vd ? " and V_d " + to_text(*result.vd, 5) : std::string()));
  return result;
}

Medium Builder::medium(const OsloMedium& m, const Medium& before) {
  switch (m.kind) {
    case OsloMedium::Kind::air: return {};
    case OsloMedium::Kind::mirror: return before;
    case OsloMedium::Kind::indices: return medium_of_indices(m);
    case OsloMedium::Kind::glass: break;
  }
  if (const auto code = medium_of_code(m.name)) return *code;
  // A name without a prefix is a glass of Schott if Schott has the name. "H_LAF2" is LAF2 of Hoya, "O_PBH1" is PBH1 of
  // Ohara; other letters stand for other makers.
  std::vector<std::string> catalogues = {"schott", "ohara", "hoya"};
  std::string name = m.name;
  if (name.size() > 2 && name[1] == '_') {
    if (name[0] == 'H') catalogues = {"hoya"};
    if (name[0] == 'O') catalogues = {"ohara"};
    name.erase(0, 2);
  }
  return in_.glass(m.line, name, catalogues, {}, {});
}

SurfaceRow Builder::row(const OsloSurface& s, const Medium& before) {
  const double unit = oslo_.unit;
  SurfaceRow row;
  row.radius = s.curvature == 0 ? 0 : unit / s.curvature;
  row.thickness = s.thickness.value_or(0) * unit;
  if (std::abs(row.thickness) >= endless) in_.refuse(s.line, "TH", to_text(row.thickness), "finite");
  row.conic = s.conic;
  for (const auto& [order, coefficient] : s.terms) {
    if (coefficient != 0) row.aspheric.push_back({order, coefficient * std::pow(unit, 1 - order)});
  }
  row.mirror = s.medium.kind == OsloMedium::Kind::mirror;
  row.medium = medium(s.medium, before);
  row.stop = s.stop;
  // AP is the width of the beams of the design. At elements it becomes a rim; at the stop and at dummy surfaces it
  // becomes a rim only if rays are checked there.
  const bool dummy = !row.mirror && row.medium == before;
  const bool counts = s.checked || !(dummy || s.stop);
  if (counts && s.aperture && *s.aperture > 0 && *s.aperture < 1e6) row.semi_diameter = *s.aperture * unit;
  return row;
}

/// PY: the thickness that brings the axial ray to a height on the next surface.
/// @param i index in the file
void Builder::solve(std::size_t i) {
  const OsloSurface& s = oslo_.surfaces[i];
  if (*s.height != 0 && !oslo_.beam_radius) {
    in_.warn(s.line, "PY", "without EBR it is not evaluated; the thickness in the file is taken");
    return;
  }
  ThicknessSolve solve{.line = s.line, .command = "PY", .surface = i - 1, .height = *s.height * oslo_.unit};
  if (oslo_.beam_radius) solve.beam_radius = *oslo_.beam_radius * oslo_.unit;
  if (i + 2 == oslo_.surfaces.size()) solve.offset = defocus();
  solve.is_stated = s.thickness.has_value();
  in_.requests.solves.push_back(std::move(solve));
}

/// The thickness of the image (mm), which moves the film.
double Builder::defocus() const {
  const double defocus = oslo_.surfaces.back().thickness.value_or(0) * oslo_.unit;
  return std::abs(defocus) < endless ? defocus : 0;
}

/// The last surface is the film. Its thickness moves the film; its shape is left out with a warning.
void Builder::place_film() {
  const OsloSurface& film = oslo_.surfaces.back();
  if (defocus() != 0) {
    in_.lens.surfaces.back().thickness += defocus();
    in_.warn(film.line, "TH", "of the image, " + to_text(defocus()) + " mm, moves the film");
  }
  if (film.curvature != 0 || film.conic != 0 || !film.terms.empty()) {
    in_.warn(film.line, "RD", "the image is curved; the film is a plane at its vertex");
  }
  if (film.aperture && *film.aperture > 0 && *film.aperture < 1e6) {
    in_.lens.image_diagonal_mm = 2 * *film.aperture * oslo_.unit;
  }
}

void Builder::declare() {
  Prescription& lens = in_.lens;
  DesignData& design = lens.design;
  const double unit = oslo_.unit, object = object_distance();
  design.object_distance_mm = object;
  if (oslo_.object_na) {
    design.aperture = {ApertureSetting::object_na, *oslo_.object_na};
  } else if (oslo_.image_na) {
    design.aperture = {ApertureSetting::image_na, *oslo_.image_na};
  } else if (oslo_.f_number) {
    design.aperture = {ApertureSetting::f_number, *oslo_.f_number};
  } else if (oslo_.beam_radius && std::isfinite(object)) {
    // beam_radius is the radius of the beam on the first surface.
    design.aperture = {ApertureSetting::object_na, std::sin(std::atan(*oslo_.beam_radius * unit / std::abs(object)))};
  } else if (oslo_.beam_radius) {
    design.aperture = {ApertureSetting::entrance_pupil_diameter, 2 * *oslo_.beam_radius * unit};
  }
  if (oslo_.angle) {
    design.field_kind = FieldKind::angle_deg;
    design.fields = {{.y = *oslo_.angle}};
  } else if (oslo_.image_height) {
    design.field_kind = FieldKind::paraxial_image;
    design.fields = {{.y = *oslo_.image_height * unit}};
  } else if (oslo_.object_height && std::isfinite(object)) {
    design.field_kind = FieldKind::object_height;
    design.fields = {{.y = *oslo_.object_height * unit}};
  }
  for (std::size_t i = 0; i < oslo_.wavelengths.size(); ++i) {
    const double um = oslo_.wavelengths[i];
    if (!(um > 0)) in_.refuse(oslo_.line, "WV", to_text(um), "positive (micrometres)");
    design.wavelengths.push_back({um * 1000, i < oslo_.weights.size() ? oslo_.weights[i] : 1});
  }
  // OSLO writes the focal length after the name, or 100, the default of a new lens.
  if (oslo_.scale && *oslo_.scale > 0) {
    in_.requests.focal_length = {oslo_.line, "LEN", *oslo_.scale * unit, *oslo_.scale == 100};
  }
}

void Builder::build() {
  if (oslo_.surfaces.size() < 3) {
    in_.refuse(oslo_.line, "LEN", "a lens of " + std::to_string(oslo_.surfaces.size()) + " surfaces",
               "an object, at least one surface and an image");
  }
  pick_up();
  Prescription& lens = in_.lens;
  lens.object_space = medium(oslo_.surfaces.front().medium, {});
  Medium before = lens.object_space;
  for (std::size_t i = 1; i + 1 < oslo_.surfaces.size(); ++i) {
    lens.surfaces.push_back(row(oslo_.surfaces[i], before));
    before = lens.surfaces.back().medium;
    if (oslo_.surfaces[i].height) solve(i);
  }
  place_film();
  declare();
}

}  // namespace

void build_oslo(OsloLens& oslo, Import& in) { Builder(oslo, in).build(); }

}  // namespace petzval::formats_detail
