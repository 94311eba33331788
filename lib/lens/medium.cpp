// SPDX-License-Identifier: Apache-2.0
#include "petzval/lens/lens.hpp"

namespace petzval {

const Glass* glass_of(const Medium& medium, const GlassCatalogue& glasses) {
  if (!medium.glass) return nullptr;
  if (medium.catalogue) return glasses.find(*medium.glass, *medium.catalogue);
  return medium.nd ? glasses.find(*medium.glass, *medium.nd) : glasses.find(*medium.glass);
}

std::optional<double> reference_index(const Medium& medium, const GlassCatalogue& glasses,
                                      double reference_wavelength_nm) {
  if (medium.nd) return medium.nd;
  if (medium.is_air()) return 1;
  const Glass* glass = glass_of(medium, glasses);
  if (!glass) return {};
  return refractive_index(*glass, reference_wavelength_nm);
}

}  // namespace petzval
