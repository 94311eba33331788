// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/prescription/prescription.hpp"

namespace petzval::io_detail {

/// The lens with the apertures that its file lacks (with_apertures); unchanged if it has no index at its own
/// wavelength, which compile() refuses.
PETZVAL_API Prescription with_missing_apertures(Prescription lens, const GlassCatalogue* glasses = nullptr);

}  // namespace petzval::io_detail
