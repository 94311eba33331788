// SPDX-License-Identifier: Apache-2.0
#include "written_lens.hpp"

#include <algorithm>
#include <utility>

#include "petzval/core/error.hpp"

namespace petzval::inline v0::files_detail {

namespace {

/// The rows in the first configuration.
Prescription first_rows(const Prescription& lens) {
  if (lens.configurations.empty()) return lens;
  Prescription rows = configured(lens, 0);
  rows.name = lens.name;
  rows.configurations = lens.configurations;
  return rows;
}

}  // namespace

Writer::Writer(const Prescription& lens, const GlassCatalogue* glasses)
    : where_(lens.name.empty() ? std::string("lens") : lens.name), glasses_(glasses) {
  validate(lens, where_);
  lens_ = first_rows(lens);
}

void Writer::refuse(std::size_t surface, const std::string& found, const std::string& wanted) const {
  throw Error(where_ + ": surface " + std::to_string(surface) + ": " + found + ", wanted " + wanted);
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
    if (given && std::ranges::find(kept, name) == kept.end()) lost += (lost.empty() ? "" : ", ") + std::string(name);
  }
  if (!lost.empty()) lose("nominal data", "and sources have no place in this format: " + lost);
}

const Glass* Writer::glass(const Medium& medium) {
  if (!medium.glass) return nullptr;
  if (!glasses_) {
    own_ = std::make_shared<const GlassCatalogue>(GlassCatalogue::load(data_directory() / "glass"));
    glasses_ = own_.get();
  }
  return medium.catalogue ? glasses_->find(*medium.glass, *medium.catalogue) : glasses_->find(*medium.glass, medium.nd);
}

}  // namespace petzval::inline v0::files_detail
