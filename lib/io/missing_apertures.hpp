// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/config.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::io_detail {

/// Adds the apertures that are missing in the file of a lens (with_apertures). The lens stays unchanged if a medium has
/// no index at the wavelength of the lens; compile() refuses such a lens.
PETZVAL_API Prescription with_missing_apertures(Prescription lens, const GlassCatalogue* glasses = nullptr);

}  // namespace petzval::io_detail
