// SPDX-License-Identifier: Apache-2.0
#include "petzval/prescription/prescription.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace {

std::string name_of(const Prescription& p) { return p.name.empty() ? std::string("lens") : p.name; }

/// value * factor.
/// @throws Error if the product is outside the normal range of double: a radius that became 0 would be a plane
double times(double value, double factor, const std::string& where) {
  const double product = value * factor;
  if (value == 0 || !std::isfinite(value) || std::isnormal(product)) return product;
  throw Error(where + ": " + to_text(value) + " scaled by " + to_text(factor) + " = " + to_text(product) +
              "; must be in the normal range of double");
}

void enlarge(std::optional<double>& length, double factor, const std::string& where) {
  if (length) length = times(*length, factor, where);
}

void scale(DesignData& design, double factor, const std::string& where) {
  using enum ApertureSetting;
  if (design.aperture && design.aperture->setting == entrance_pupil_diameter) {
    design.aperture->value = times(design.aperture->value, factor, where);
  }
  design.object_distance_mm = times(design.object_distance_mm, factor, where);
  if (design.field_kind == FieldKind::angle_deg) return;
  for (DesignField& field : design.fields) {
    field.x = times(field.x, factor, where);
    field.y = times(field.y, factor, where);
  }
}

void scale(Configuration& configuration, double factor, const std::string& where) {
  enlarge(configuration.subject_distance_mm, factor, where);
  enlarge(configuration.focal_length_mm, factor, where);
  enlarge(configuration.image_diagonal_mm, factor, where);
  for (SurfaceChange& change : configuration.changes) {
    enlarge(change.thickness, factor, where);
    enlarge(change.radius, factor, where);
    enlarge(change.semi_diameter, factor, where);
  }
}

}  // namespace

Prescription scale(const Prescription& prescription, double factor) {
  Prescription p = prescription;
  const std::string where = name_of(p);
  if (!(factor > 0 && std::isfinite(factor))) {
    throw Error(where + ": scale factor = " + to_text(factor) + "; must be finite and positive");
  }
  enlarge(p.focal_length_mm, factor, where);
  enlarge(p.image_diagonal_mm, factor, where);
  scale(p.design, factor, where);
  for (Configuration& c : p.configurations) scale(c, factor, where + ": configuration \"" + c.name + '"');
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    SurfaceRow& row = p.surfaces[i];
    const std::string here = where + ": surface " + std::to_string(i);
    row.radius = times(row.radius, factor, here);
    row.thickness = times(row.thickness, factor, here);
    enlarge(row.semi_diameter, factor, here);
    enlarge(row.obscuration_semi_diameter, factor, here);
    for (auto& [order, coefficient] : row.aspheric) coefficient = times(coefficient, std::pow(factor, 1 - order), here);
  }
  return p;
}

Prescription reverse(const Prescription& prescription) {
  Prescription p = prescription;
  if (p.surfaces.empty()) throw Error(name_of(p) + ": no surfaces; must be at least one to reverse");

  // Light must enter towards +z. With an even number of mirrors, light leaves the lens towards +z, and the reversed
  // lens is a mirror image in z: sags change sign; thicknesses keep their sign, because both ends of a thickness are
  // exchanged and mirrored. With an odd number, light leaves the lens towards -z, and the reversed light travels
  // towards +z: sags keep their sign, and thicknesses change sign.
  const auto mirrors =
      std::count_if(p.surfaces.begin(), p.surfaces.end(), [](const SurfaceRow& row) { return row.mirror; });
  const bool turned = mirrors % 2 == 0;
  const auto opposite_if = [](bool change, double value) { return change ? 0.0 - value : value; };  // no -0 for a plane

  const std::size_t count = p.surfaces.size();
  p.object_space = prescription.surfaces.back().medium;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t old = count - 1 - i;
    SurfaceRow& row = p.surfaces[i];
    row = prescription.surfaces[old];
    row.medium = old > 0 ? prescription.surfaces[old - 1].medium : prescription.object_space;
    row.thickness = old > 0 ? opposite_if(!turned, prescription.surfaces[old - 1].thickness) : 0;
    row.radius = opposite_if(turned, row.radius);
    for (auto& [order, coefficient] : row.aspheric) coefficient = opposite_if(turned, coefficient);
    if (row.coating && !row.mirror) row.coating = reversed(*std::move(row.coating));
  }

  p.f_number.reset();
  p.half_field_deg.reset();
  p.image_diagonal_mm.reset();
  p.image_distance.reset();
  p.design = {};
  std::erase_if(p.configurations, [](const Configuration& c) { return c.focus_of.has_value(); });
  for (Configuration& c : p.configurations) {
    const int last = static_cast<int>(count) - 1;
    c.f_number.reset();
    c.half_field_deg.reset();
    c.image_diagonal_mm.reset();
    c.subject_distance_mm.reset();
    if (c.stop) c.stop = last - *c.stop;
    std::map<int, SurfaceChange> changes;
    for (const SurfaceChange& old : c.changes) {
      // The space behind a surface becomes the space behind the previous surface of the reversed lens.
      if (old.surface < last && (old.thickness || old.medium)) {
        SurfaceChange& gap = changes[last - 1 - old.surface];
        gap.medium = old.medium;
        if (old.thickness) gap.thickness = opposite_if(!turned, *old.thickness);
      }
      if (!old.radius && !old.conic && !old.semi_diameter) continue;
      SurfaceChange& surface = changes[last - old.surface];
      surface.conic = old.conic;
      surface.semi_diameter = old.semi_diameter;
      if (old.radius) surface.radius = opposite_if(turned, *old.radius);
    }
    c.changes.clear();
    for (auto& [surface, change] : changes) {
      change.surface = surface;
      c.changes.push_back(change);
    }
  }
  return p;
}

}  // namespace petzval
