// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "petzval/lens/lens.hpp"
#include "petzval/media/glass.hpp"
#include "petzval/prescription/prescription.hpp"

namespace examples {

/// A lens file, read and compiled.
struct LoadedLens {
  std::string id;  ///< the name of the file without .json; output files begin with it
  petzval::Prescription prescription;
  petzval::GlassCatalogue glasses;
  petzval::Lens lens;  ///< for the given wavelengths
};

/// Reads and compiles a lens with the glass tables of petzval. The n_d/V_d model replaces glasses that are in no table
/// (without V_d only the reference wavelength is left). Notes on standard error report this, and the surface that
/// serves as the stop if none is marked.
LoadedLens load_lens(const std::filesystem::path& file, std::span<const double> wavelengths_nm);

/// As declared, or by the diagonal of the image, or 10 degrees if the source has neither.
double half_field_deg(const LoadedLens& loaded);

/// The prescription compiled for other wavelengths, in the same way.
petzval::Lens compiled_for(const LoadedLens& loaded, std::span<const double> wavelengths_nm);

}  // namespace examples
