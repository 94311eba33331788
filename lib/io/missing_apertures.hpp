// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::io_detail {

/// The lens with the apertures that are missing in its file (with_apertures). Unchanged if a medium has no index at the
/// lens's wavelength, which compile() refuses.
PETZVAL_API Prescription with_missing_apertures(Prescription lens, const GlassCatalogue* glasses = nullptr);

}  // namespace petzval::io_detail
