// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/prescription/prescription.hpp"

namespace petzval::prescription_detail {

inline void apply(const SurfaceChange& change, SurfaceRow& row) {
  row.thickness = change.thickness.value_or(row.thickness);
  row.radius = change.radius.value_or(row.radius);
  row.conic = change.conic.value_or(row.conic);
  if (change.semi_diameter) row.semi_diameter = change.semi_diameter;
  if (change.medium) row.medium = *change.medium;
}

}  // namespace petzval::prescription_detail
