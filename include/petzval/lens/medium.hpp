// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/surface_row.hpp"

namespace petzval {

/// The glass of a medium; nullptr if the medium names no glass or the tables do not contain the name.
///
/// The glass is looked up by name and catalogue, else by name and n_d, else by name (GlassCatalogue::find).
///
/// @throws Error if the medium states neither catalogue nor n_d and the name is ambiguous
PETZVAL_API const Glass* glass_of(const Medium& medium, const GlassCatalogue& glasses);

/// The index of a medium at the reference wavelength of its prescription; nullopt if its glass is in no table.
///
/// The result is 1 for air, the stated index, or the index of the glass.
///
/// @throws Error if the name of the glass is ambiguous, or if its range does not include the wavelength
PETZVAL_API std::optional<double> reference_index(const Medium& medium, const GlassCatalogue& glasses,
                                                  double reference_wavelength_nm);

}  // namespace petzval
