// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "configured_row.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval {
namespace {

// The squared curvature of a smaller radius overflows in float. File formats use longer thicknesses for infinity.
constexpr double smallest_radius = 1e-12;
constexpr double smallest_bend = 1e-15;
constexpr double longest_thickness = 1e10;
constexpr std::size_t most_surfaces = 10'000;
constexpr std::size_t most_configurations = 1'000;

[[noreturn]] void refuse(const std::string& where, const std::string& what, double found, const std::string& rule) {
  throw Error(where + ": " + what + " = " + to_text(found) + "; must be " + rule);
}

void check_finite(const std::string& where, const char* what, double value, const std::string& rule) {
  if (!std::isfinite(value)) refuse(where, what, value, rule);
}

void check_nominal(const std::string& where, const char* what, const std::optional<double>& value) {
  if (value) check_finite(where, what, *value, "finite or absent");
}

void check_medium(const std::string& where, const Medium& medium) {
  if (medium.nd && !(*medium.nd >= 0.1 && *medium.nd <= 5)) refuse(where, "nd", *medium.nd, "0.1 to 5");
  if (medium.vd && !medium.nd && !medium.glass) {
    throw Error(where + ": vd = " + to_text(*medium.vd) + " without nd; must be given with nd or a glass");
  }
  if (medium.vd && !(*medium.vd >= 0 && std::isfinite(*medium.vd))) {
    throw Error(where + ": vd = " + to_text(*medium.vd) +
                "; must be finite and positive, or 0 for an index that does not depend on the wavelength");
  }
}

/// Text for messages: "nd 1.5168", "glass N-BK7".
std::string describe(const Medium& medium) {
  if (medium.nd || !medium.glass) return "nd " + to_text(medium.nd.value_or(1));
  return "glass " + *medium.glass;
}

void check_surface(const std::string& where, const SurfaceRow& row, const Medium& before) {
  if (!std::isfinite(row.radius) || (row.radius != 0 && std::abs(row.radius) < smallest_radius)) {
    refuse(where, "radius", row.radius, "finite and at least 1e-12 mm, or 0 for a plane");
  }
  if (!(std::abs(row.thickness) < longest_thickness))
    refuse(where, "thickness", row.thickness, "finite and below 1e10 mm");
  check_medium(where, row.medium);
  if (row.mirror && row.medium != before) {
    throw Error(where + ": medium of the mirror = " + describe(row.medium) +
                "; must equal the medium in front of it, " + describe(before));
  }

  if (row.semi_diameter && !(*row.semi_diameter >= 0))
    refuse(where, "semi_diameter", *row.semi_diameter, "at least 0 mm");
  if (row.obscuration_semi_diameter) {
    const double inner = *row.obscuration_semi_diameter;
    if (!(inner >= 0 && std::isfinite(inner))) refuse(where, "inner_semi_diameter", inner, "finite and at least 0 mm");
    if (inner > 0 && row.semi_diameter && inner >= *row.semi_diameter) {
      refuse(where, "inner_semi_diameter", inner,
             "less than the semi_diameter of " + to_text(*row.semi_diameter) + " mm");
    }
  }

  if (row.coating) validate(*row.coating, where);

  check_finite(where, "conic", row.conic, "a finite number");
  // Transverse semi-axis of the conic: the square of a smaller length underflows in float.
  if (row.radius != 0 && std::abs(row.radius) / std::sqrt(std::abs(1 + row.conic)) < smallest_bend)
    refuse(where, "conic", row.conic, "such that radius / sqrt|1 + conic| is at least 1e-15 mm");
  std::set<int> orders;
  for (const auto& [order, coefficient] : row.aspheric) {
    if (order < 2 || order > 40) refuse(where, "aspheric order", order, "2 to 40");
    const std::string term = "aspheric coefficient of order " + std::to_string(order);
    check_finite(where, term.c_str(), coefficient, "a finite number");
    // Terms have the limit of radii, because a term of order 2 is a curvature.
    if (std::pow(order * std::abs(coefficient), 1.0 / (order - 1)) > 1 / smallest_radius) {
      refuse(where, term, coefficient, "such that the slope is below 1 up to 1e-12 mm");
    }
    if (!orders.insert(order).second) throw Error(where + ": " + term + " is given twice; must be given once");
  }
}

void check_design(const std::string& where, const DesignData& design) {
  if (design.aperture && !(design.aperture->value >= 0 && std::isfinite(design.aperture->value))) {
    refuse(where, "aperture", design.aperture->value, "finite and at least 0");
  }
  if (std::isnan(design.object_distance_mm)) refuse(where, "object distance", design.object_distance_mm, "a length");
  for (std::size_t i = 0; i < design.fields.size(); ++i) {
    const std::string here = where + ": field " + std::to_string(i);
    const DesignField& f = design.fields[i];
    for (const double value : {f.x, f.y, f.weight, f.decentre_x, f.decentre_y, f.compress_x, f.compress_y, f.angle_deg})
      check_finite(here, "a value", value, "a finite number");
  }
  for (std::size_t i = 0; i < design.wavelengths.size(); ++i) {
    const auto& [nm, weight] = design.wavelengths[i];
    const std::string here = where + ": wavelength " + std::to_string(i);
    if (!(nm >= 10 && nm <= 1e5)) refuse(here, "nm", nm, "10 to 100000 nm");
    check_finite(here, "weight", weight, "a finite number");
  }
  if (design.primary_wavelength > 0 && design.primary_wavelength >= design.wavelengths.size()) {
    refuse(where, "primary wavelength", static_cast<double>(design.primary_wavelength),
           "below " + std::to_string(design.wavelengths.size()));
  }
}

template <class Declared>
void check_nominal_data(const std::string& where, const Declared& declared) {
  check_nominal(where, "focal_length_mm", declared.focal_length_mm);
  if (declared.f_number && !(*declared.f_number > 0 && std::isfinite(*declared.f_number))) {
    refuse(where, "f_number", *declared.f_number, "finite and positive, or absent");
  }
  check_nominal(where, "half_field_deg", declared.half_field_deg);
  check_nominal(where, "image_diagonal_mm", declared.image_diagonal_mm);
}

/// Checks configurations of rows that are already validated. Work and memory are proportional to the number of changes.
class ConfigurationCheck {
 public:
  ConfigurationCheck(const std::string& where, const Prescription& p)
      : where_(where), p_(p), change_of_(p.surfaces.size()) {}

  void run();

 private:
  void check(const std::string& here, const Configuration& c);
  void check_rows(const std::string& here, const Configuration& c);
  void check_row(const std::string& here, std::size_t surface);
  /// The medium behind a surface in the configuration being checked.
  const Medium& medium(std::size_t surface) const {
    const SurfaceChange* change = change_of_[surface];
    return change && change->medium ? *change->medium : p_.surfaces[surface].medium;
  }

  const std::string& where_;
  const Prescription& p_;
  std::set<std::string_view> zoom_positions_;
  std::vector<const SurfaceChange*> change_of_;  ///< by surface; null outside check_rows()
  SurfaceRow row_;                               ///< scratch
};

void ConfigurationCheck::run() {
  const auto& list = p_.configurations;
  if (list.size() > most_configurations) {
    throw Error(where_ + ": " + std::to_string(list.size()) + " configurations; must be at most " +
                std::to_string(most_configurations));
  }
  for (const Configuration& c : list) {
    if (!c.focus_of) zoom_positions_.insert(c.name);
  }
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Configuration& c = list[i];
    const std::string here = where_ + ": configuration " + std::to_string(i);
    if (c.name.empty()) throw Error(here + ": name is empty; must not be");
    if (!names.insert(c.name).second) throw Error(here + ": name \"" + c.name + "\" is given twice; must be unique");
    if (i == 0 && c.focus_of) throw Error(here + " focuses another; must be a zoom position");
    check(here, c);
  }
}

void ConfigurationCheck::check(const std::string& here, const Configuration& c) {
  const auto check_index = [&](const char* what, int surface) {
    if (surface < 0 || static_cast<std::size_t>(surface) >= p_.surfaces.size()) {
      refuse(here, what, surface, "0 or more and below " + std::to_string(p_.surfaces.size()));
    }
  };
  if (c.stop) check_index("stop", *c.stop);
  if (c.subject_distance_mm && !(*c.subject_distance_mm > 0)) {
    refuse(here, "subject_distance_mm", *c.subject_distance_mm, "positive or inf");
  }
  for (const SurfaceChange& change : c.changes) check_index("changed surface", change.surface);
  if (c.focus_of && !zoom_positions_.contains(*c.focus_of)) {
    throw Error(here + " focuses \"" + *c.focus_of + "\"; must be the name of a zoom position");
  }
  check_nominal_data(here, c);
  check_rows(here, c);
}

void ConfigurationCheck::check_rows(const std::string& here, const Configuration& c) {
  for (const SurfaceChange& change : c.changes) {
    const SurfaceChange*& known = change_of_[static_cast<std::size_t>(change.surface)];
    if (known) throw Error(here + ": surface " + std::to_string(change.surface) + " is changed twice; must be unique");
    known = &change;
  }
  for (const SurfaceChange& change : c.changes) {
    const auto surface = static_cast<std::size_t>(change.surface);
    check_row(here, surface);
    // If a surface changes its medium, check the next surface too: a mirror must have the medium of the surface in
    // front.
    if (change.medium && surface + 1 < p_.surfaces.size()) check_row(here, surface + 1);
  }
  for (const SurfaceChange& change : c.changes) change_of_[static_cast<std::size_t>(change.surface)] = nullptr;
}

void ConfigurationCheck::check_row(const std::string& here, std::size_t surface) {
  row_ = p_.surfaces[surface];
  if (change_of_[surface]) prescription_detail::apply(*change_of_[surface], row_);
  check_surface(here + ": surface " + std::to_string(surface), row_,
                surface > 0 ? medium(surface - 1) : p_.object_space);
}

}  // namespace

void validate(const Prescription& p, const std::string& where) {
  check_nominal_data(where, p);
  if (!(p.reference_wavelength_nm >= 10 && p.reference_wavelength_nm <= 1e5)) {
    refuse(where, "reference_wavelength_nm", p.reference_wavelength_nm, "10 to 100000 nm");
  }
  check_medium(where + ": object_space", p.object_space);
  if (p.surfaces.empty()) throw Error(where + ": no surfaces; must be at least one");

  if (p.surfaces.size() > most_surfaces) {
    throw Error(where + ": " + std::to_string(p.surfaces.size()) + " surfaces; must be at most " +
                std::to_string(most_surfaces));
  }

  const Medium* before = &p.object_space;
  for (std::size_t i = 0; i < p.surfaces.size(); ++i) {
    check_surface(where + ": surface " + std::to_string(i), p.surfaces[i], *before);
    before = &p.surfaces[i].medium;
  }
  check_design(where + ": design", p.design);
  ConfigurationCheck(where, p).run();
}

}  // namespace petzval
