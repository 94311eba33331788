// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/glass/glass.hpp"

namespace petzval::glass_detail {

/// The coefficient of a table (1/mm) at a wavelength, like absorption(); 0 if the table is empty.
double absorption_at(std::span<const AbsorptionEntry> table, double wavelength_nm) noexcept;

}  // namespace petzval::glass_detail
