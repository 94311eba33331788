// SPDX-License-Identifier: Apache-2.0
#include "written_lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/text.hpp"
#include "import.hpp"
#include "petzval/core/error.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "text_file.hpp"

namespace petzval::formats_detail {

namespace {

/// The rows in the first configuration. Its changes are undone in the other configurations.
Prescription first_rows(const Prescription& lens) {
  if (lens.configurations.empty()) return lens;
  Prescription rows = configured(lens, 0);
  rows.name = lens.name;
  rows.configurations = lens.configurations;
  for (const SurfaceChange& first : lens.configurations.front().changes) {
    const SurfaceRow& row = lens.surfaces[static_cast<std::size_t>(first.surface)];
    for (Configuration& other : rows.configurations) {
      SurfaceChange& change = change_of(other, first.surface);
      const auto as_in_the_row = [&](auto member, const auto& value) {
        if (first.*member && !(change.*member)) change.*member = value;
      };
      as_in_the_row(&SurfaceChange::thickness, row.thickness);
      as_in_the_row(&SurfaceChange::radius, row.radius);
      as_in_the_row(&SurfaceChange::conic, row.conic);
      as_in_the_row(&SurfaceChange::semi_diameter, row.semi_diameter.value_or(HUGE_VAL));
      as_in_the_row(&SurfaceChange::medium, row.medium);
    }
  }
  return rows;
}

}  // namespace

Writer::Writer(const Prescription& lens, const GlassCatalogue* glasses)
    : where_(lens.name.empty() ? std::string("lens") : lens.name), glasses_(glasses) {
  validate(lens, where_);
  lens_ = first_rows(lens);
  mark_the_stop();
  lose_the_coatings();
}

/// Marks the stop, because other programs use the first surface if no stop is marked.
void Writer::mark_the_stop() {
  const auto marked = std::ranges::find_if(lens_.surfaces, &SurfaceRow::stop);
  if (marked != lens_.surfaces.end()) {
    if (!std::isfinite(marked->semi_diameter.value_or(HUGE_VAL)))
      lose("stop", "has no rim; other programs give it the rim of the aperture");
    return;
  }
  Prescription rows = lens_;
  rows.configurations.clear();
  const Lens lens = compiled(rows);
  if (!has_pupils(lens)) return lose("stop", "is not marked, and no rim limits the beam");
  const std::size_t stop = pupils(lens, {}, main_meridian(lens)).stop;
  lens_.surfaces[stop].stop = true;
  lose("stop", "is not marked; surface " + std::to_string(stop) + ", whose rim limits the beam, becomes the stop");
}

void Writer::lose_the_coatings() {
  std::string surfaces;
  for (std::size_t i = 0; i < lens_.surfaces.size(); ++i) {
    if (lens_.surfaces[i].coating) append(surfaces, ", ", std::to_string(i));
  }
  if (!surfaces.empty()) lose("coating", "cannot be stored in this format; lost for surface " + surfaces);
}

void Writer::lose_the_wider_stop() {
  const auto& aperture = lens_.design.aperture;
  const std::size_t stop = stop_of(lens_);
  if (!aperture || aperture->setting == ApertureSetting::stop_size || !(aperture->value > 0) ||
      stop == lens_.surfaces.size()) {
    return;
  }
  const double rim = lens_.surfaces[stop].semi_diameter.value_or(HUGE_VAL);
  const double height = marginal_height_at_the_stop(at_primary_wavelength(without_rims(lens_)), stop,
                                                    lens_.design.object_distance_mm, *aperture);
  if (!std::isfinite(rim) || !(height > 0) || !std::isfinite(height) || rim <= 1.01 * height) return;
  lose("stop", "its rim of " + to_text(rim, 6) + " mm is wider than the declared " +
                   std::string(name(aperture->setting)) + " of " + to_text(aperture->value, 6) +
                   ", which other programs use: " + to_text(height, 6) + " mm");
}

void Writer::refuse_closed_rims(const std::string& format) const {
  const auto check = [&](std::size_t surface, const std::optional<double>& semi_diameter) {
    if (semi_diameter == 0.0) refuse(surface, "semi_diameter = 0 mm", "positive for a " + format);
  };
  for (std::size_t i = 0; i < lens_.surfaces.size(); ++i) check(i, lens_.surfaces[i].semi_diameter);
  for (const Configuration& c : lens_.configurations) {
    for (const SurfaceChange& change : c.changes) check(static_cast<std::size_t>(change.surface), change.semi_diameter);
  }
}

void Writer::state_indices_at_d() {
  const double reference = lens_.reference_wavelength_nm;
  double rounding = 0;
  const auto restate = [&](Medium& medium) {
    if (!medium.nd) return;
    double& nd = *medium.nd;
    if (const Glass* found = glass(medium)) {
      // If the index equals the formula or the printed table, the medium is the glass itself.
      const bool printed = reference == d_line_nm && nd == found->nd;
      const double off = std::abs(nd - index_at(*found, reference).value_or(HUGE_VAL));
      if (printed || off <= 1e-10) {
        if (std::isfinite(off)) rounding = std::max(rounding, off);
        medium.nd.reset();
        medium.catalogue = found->catalogue;  // the name may be ambiguous
      } else if (reference != d_line_nm) {
        nd += refractive_index(*found, d_line_nm) - refractive_index(*found, reference);
      }
    } else if (medium.vd && *medium.vd > 0 && reference != d_line_nm) {
      nd += abbe_index(nd, *medium.vd, d_line_nm) - abbe_index(nd, *medium.vd, reference);
    }
  };
  restate(lens_.object_space);
  for (SurfaceRow& row : lens_.surfaces) restate(row.medium);
  for (Configuration& configuration : lens_.configurations) {
    for (SurfaceChange& change : configuration.changes) {
      if (change.medium) restate(*change.medium);
    }
  }
  if (rounding > 1e-10) {
    lose("nd",
         "indices printed in the glass tables are replaced by the formulas, up to " + to_text(rounding, 2) + " away");
  }
  if (reference == d_line_nm) return;
  if (lens_.design.wavelengths.empty()) lens_.design.wavelengths = {{reference, 1}};
  lens_.reference_wavelength_nm = d_line_nm;
}

void Writer::refuse(std::size_t surface, const std::string& found, const std::string& rule) const {
  throw Error(where_ + ": surface " + std::to_string(surface) + ": " + found + "; must be " + rule);
}

void Writer::lose_nominal_data(bool design_data, std::initializer_list<std::string_view> kept) {
  const DesignData& d = lens_.design;
  const bool aperture = design_data && d.aperture && d.aperture->setting == ApertureSetting::f_number;
  const bool fields = design_data && !d.fields.empty(), angles = d.field_kind == FieldKind::angle_deg;
  const bool image = d.field_kind == FieldKind::paraxial_image || d.field_kind == FieldKind::real_image_height;
  const std::pair<std::string_view, bool> all[] = {
      {"focal_length_mm", lens_.focal_length_mm.has_value()},
      {"f_number", lens_.f_number && !aperture},
      {"half_field_deg", lens_.half_field_deg && !(fields && angles)},
      {"image_diagonal_mm", lens_.image_diagonal_mm && !(fields && image)},
      {"source_design", !lens_.source_design.empty()},
      {"source_numbers", !lens_.source_numbers.empty()},
      {"notes", lens_.notes.has_value()},
  };
  std::string lost;
  for (const auto& [name, given] : all) {
    if (given && std::ranges::find(kept, name) == kept.end()) append(lost, ", ", name);
  }
  if (!lost.empty()) lose("nominal data", "and sources cannot be stored in this format: " + lost);
}

const GlassCatalogue& Writer::glasses() {
  if (!glasses_) glasses_ = &glass_tables();
  return *glasses_;
}

const Glass* Writer::glass(const Medium& medium) { return medium.glass ? glass_of(medium, glasses()) : nullptr; }

double Writer::index(const Medium& medium) {
  if (medium.nd || medium.is_air()) return medium.nd.value_or(1);
  const Glass* found = glass(medium);
  if (!found) throw Error(where_ + ": glass = \"" + *medium.glass + "\" without nd; must be in the glass tables");
  return refractive_index(*found, lens_.reference_wavelength_nm);
}

}  // namespace petzval::formats_detail
