// SPDX-License-Identifier: Apache-2.0
#include "petzval/prescription/prescription.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval::inline v0 {
namespace {

std::string name_of(const Prescription& p) { return p.name.empty() ? std::string("lens") : p.name; }

/// value * factor. Refuses a product outside the normal range of double: a radius that became 0 would be a plane.
double times(double value, double factor, const std::string& where) {
  const double product = value * factor;
  if (value == 0 || !std::isfinite(value) || std::isnormal(product)) return product;
  throw Error(where + ": " + to_text(value) + " scaled by " + to_text(factor) + " is " + to_text(product) +
              ", wanted a number in the normal range of double");
}

}  // namespace

Prescription scale(const Prescription& prescription, double factor) {
  Prescription p = prescription;
  const std::string where = name_of(p);
  if (!(factor > 0 && std::isfinite(factor))) {
    throw Error(where + ": scale factor is " + to_text(factor) + ", wanted a finite number above 0");
  }
  const auto enlarge = [&](std::optional<double>& length) {
    if (length) length = times(*length, factor, where);
  };
  enlarge(p.focal_length_mm);
  enlarge(p.image_diagonal_mm);
  if (p.zoom) {
    for (auto& [surface, gap] : p.zoom->variable_gaps) gap = times(gap, factor, where);
  }
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    SurfaceRow& row = p.surfaces[i];
    const std::string here = where + ": surface " + std::to_string(i);
    row.radius = times(row.radius, factor, here);
    row.thickness = times(row.thickness, factor, here);
    enlarge(row.semi_diameter);
    enlarge(row.obscuration_semi_diameter);
    for (auto& [order, coefficient] : row.aspheric) coefficient = times(coefficient, std::pow(factor, 1 - order), here);
  }
  return p;
}

Prescription reverse(const Prescription& prescription) {
  Prescription p = prescription;
  if (p.surfaces.empty()) throw Error(name_of(p) + ": no surfaces to reverse, wanted at least one");

  // Light must enter towards +z. With an even number of mirrors it left the lens towards +z, so the reversed lens is a
  // mirror image in z: sags change sign, thicknesses keep theirs (the ends of each are exchanged and mirrored). With an
  // odd number it left towards -z and the way back runs towards +z: sags stay, thicknesses change sign.
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
  }

  p.f_number.reset();
  p.half_field_deg.reset();
  p.image_diagonal_mm.reset();
  p.image_distance.reset();
  if (p.zoom) {
    p.zoom->variable_gaps.clear();
    for (const auto& [surface, gap] : prescription.zoom->variable_gaps) {
      const int last = static_cast<int>(count) - 1;
      if (surface < last) p.zoom->variable_gaps[last - 1 - surface] = opposite_if(!turned, gap);
    }
  }
  return p;
}

}  // namespace petzval::inline v0
