// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>

#include "petzval/analysis/lens_metadata.hpp"
#include "petzval/analysis/st_map.hpp"
#include "petzval/core/export.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// Adds lens metadata to the attributes of an image.
///
/// Uses the standard names of OpenEXR 3.2, which all versions can read: lensMake, lensModel, lensSerialNumber;
/// nominalFocalLength, pinholeFocalLength, effectiveFocalLength and entrancePupilOffset (mm); aperture (f-number);
/// tStop; focus (m, from the film; infinite at infinity); sensorOverallDimensions (mm).
///
/// @throws Error under the conditions of lens_state()
PETZVAL_API void add_lens_attributes(ExrPart& part, const LensDistortion& distortion,
                                     const LensIdentity& identity = {});

/// Converts ST maps to two EXR parts, "undistort" and "redistort", with s in channel R, t in G, and lens metadata.
///
/// The display window is the film image. The margin of "undistort" surrounds it like overscan in Nuke, so that Nuke's
/// STMap accepts a part directly. The attribute `overscan` is the size of the pinhole image relative to the film image.
PETZVAL_API std::array<ExrPart, 2> to_exr_parts(const StMaps& maps, const LensDistortion& distortion,
                                                const LensIdentity& identity = {});

/// Writes the ST maps of exact chief rays to an EXR file with the parts of to_exr_parts().
///
/// @param lens      the focused lens
/// @param film      the film, at the focus of the lens
/// @param identity  names for the metadata
/// @param file      the EXR file, written with write_file()
/// @param options   overscan and threads
/// @throws Error    if the file cannot be written; also under the conditions of LensDistortion and st_maps()
PETZVAL_API void write_st_map(const Lens& lens, const Film& film, const LensIdentity& identity,
                              const std::filesystem::path& file, const StMapOptions& options = {});

}  // namespace petzval
