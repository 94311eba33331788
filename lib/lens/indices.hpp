// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "spectrum.hpp"

namespace petzval::lens_detail {

/// Indices of every medium at every wavelength, and the source of the dispersion.
struct Indices {
  std::vector<double> values;  ///< [wavelength * (surfaces + 1) + space], space 0 before the first surface
  Spectrum spectrum;           ///< the same media at any wavelength in the range
  std::vector<std::vector<AbsorptionEntry>> absorption;  ///< [space]; empty tables for air and unknown absorption
  Dispersion dispersion = Dispersion::none;
  std::vector<std::string> missing_glasses, clamped_glasses;
};

Indices indices(const Prescription& prescription, std::span<const double> wavelengths_nm, const CompileOptions& options,
                const std::string& where);

}  // namespace petzval::lens_detail
