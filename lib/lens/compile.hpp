// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {

/// Compiles a prescription like compile(), but leaves surfaces without a clear aperture unlimited.
Lens compile_as_given(const Prescription& prescription, std::span<const double> wavelengths_nm,
                      const CompileOptions& options);

/// A copy of the lens with other semi-diameters (mm), in the order of the surfaces.
Lens with_rims(const Lens& lens, std::vector<double> rims);

}  // namespace petzval::lens_detail
