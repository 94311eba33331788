// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/prescription/prescription.hpp"

namespace examples {

/// Adds LENS with --glasses and --configuration. LENS is required if `remark` is empty.
Option* add_lens(App& app, petzval::LensSource& input, const std::string& name = "LENS",
                 const std::string& remark = "");

/// Adds LENS... and the options of add_lens() for all of them; sets `lenses` instead of input.file.
Option* add_lenses(App& app, petzval::LensSource& input, std::vector<std::string>& lenses);

/// Adds --thin-lens: the focal length of a thin lens (mm) instead of LENS; 0 if the option is not given.
Option* add_thin_lens(App& app, double& focal_length_mm);

/// The glass tables of petzval and the catalogues of --glasses.
petzval::GlassCatalogue glasses_of(const petzval::LensSource& input);

/// The lens file with all its configurations. @throws petzval::Error with similar names if there is no such file
petzval::Prescription read_whole(const petzval::LensSource& input, const petzval::GlassCatalogue& glasses);

/// Names media after the nearest glasses if --match-glasses is given. Notes on standard error give each medium with its
/// glass, or the reason why no glass matches.
petzval::Prescription with_matched_glasses(const petzval::LensSource& input, petzval::Prescription lens,
                                           const petzval::GlassCatalogue& glasses);

/// An uncompiled lens file in the configuration of the command line.
struct LensFile {
  std::string id;  ///< file name without extension, and configuration; prefix of output files
  petzval::Prescription prescription;
  petzval::GlassCatalogue glasses;
  int first_surface_number = 0;   ///< 1 for formats in which the first surface is number 1
  petzval::Prescription whole{};  ///< with all configurations
  petzval::LensSource source{};   ///< the source of the lens
};

/// A lens file and its compiled lens.
struct LoadedLens : LensFile {
  petzval::Lens lens;  ///< for the given wavelengths
};

/// Reads a lens file.
LensFile read_lens(const petzval::LensSource& input);

/// Compiles a lens file. primary_nm: Lens::primary_wavelength.
///
/// Notes on standard error report the assumptions of the import, and the surface that serves as the stop if no stop is
/// marked. The n_d/V_d model replaces glasses that are in no table (without V_d only the reference wavelength can be
/// used); a note reports this if a wavelength other than the reference is used.
LoadedLens compiled(LensFile file, std::span<const double> wavelengths_nm, std::optional<double> primary_nm = {});

/// The primary wavelength of a set-up; none if a command uses wavelengths without it.
std::optional<double> primary_among(std::span<const double> wavelengths_nm, std::optional<double> primary_nm);

/// Reads and compiles a lens file.
LoadedLens load_lens(const petzval::LensSource& input, std::span<const double> wavelengths_nm);
/// The same for the lens of a set-up, also a thin lens.
LoadedLens load_lens(const petzval::CameraSetup& setup, std::span<const double> wavelengths_nm);

/// The largest field that the source declares, or 10 degrees if it declares no field. lens: compiled from the file.
double half_field_deg(const LensFile& file, const petzval::Lens& lens);

/// Options with the glasses of the file. The n_d/V_d model replaces glasses that are in no table.
petzval::CompileOptions compile_options(const LensFile& file, std::optional<double> primary_nm = {});

/// The prescription compiled for other wavelengths with compile_options().
petzval::Lens compiled_for(const LensFile& file, std::span<const double> wavelengths_nm,
                           std::optional<double> primary_nm = {});

}  // namespace examples
