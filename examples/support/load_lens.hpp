// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "petzval/lens/lens.hpp"
#include "petzval/media/catalogue.hpp"
#include "petzval/prescription/prescription.hpp"

namespace examples {

/// A lens file as the programs use it.
struct LoadedLens {
  std::string id;  ///< the file's name without .json; names of outputs begin with it
  petzval::Prescription prescription;
  petzval::GlassCatalogue glasses;
  petzval::Lens lens;  ///< for the wavelengths asked for
};

/// Reads and compiles a lens with the glass tables that came with petzval. Where a medium is in none of them, the
/// n_d/V_d model stands in (without V_d only the reference wavelength is left), and one line on standard error says so;
/// another says which surface serves as the stop where none is marked.
LoadedLens load_lens(const std::filesystem::path& file, std::span<const double> wavelengths_nm);

/// The prescription compiled for other wavelengths, in the same way.
petzval::Lens compiled_for(const LoadedLens& loaded, std::span<const double> wavelengths_nm);

}  // namespace examples
