// SPDX-License-Identifier: Apache-2.0
#include "written_lens.hpp"

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

const Glass* Writer::glass(const Medium& medium) {
  if (!medium.glass) return nullptr;
  if (!glasses_) {
    own_ = std::make_shared<const GlassCatalogue>(GlassCatalogue::load(data_directory() / "glass"));
    glasses_ = own_.get();
  }
  return medium.catalogue ? glasses_->find(*medium.glass, *medium.catalogue) : glasses_->find(*medium.glass, medium.nd);
}

}  // namespace petzval::inline v0::files_detail
