// SPDX-License-Identifier: Apache-2.0
#include "absorption.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {

double glass_detail::absorption_at(std::span<const AbsorptionEntry> table, double wavelength_nm) noexcept {
  if (table.empty()) return 0;
  const auto after = std::ranges::lower_bound(table, wavelength_nm, {}, &AbsorptionEntry::wavelength_nm);
  if (after == table.begin()) return table.front().per_mm;
  if (after == table.end()) return table.back().per_mm;
  const AbsorptionEntry& before = *(after - 1);
  return std::lerp(before.per_mm, after->per_mm,
                   (wavelength_nm - before.wavelength_nm) / (after->wavelength_nm - before.wavelength_nm));
}

std::optional<double> absorption(const Glass& glass, double wavelength_nm) {
  if (!(wavelength_nm > 0 && std::isfinite(wavelength_nm))) {
    throw Error(glass.catalogue + " " + glass.name + ": wavelength = " + to_text(wavelength_nm) +
                " nm; must be finite and positive");
  }
  if (glass.absorption.empty()) return std::nullopt;
  return glass_detail::absorption_at(glass.absorption, wavelength_nm);
}

}  // namespace petzval
