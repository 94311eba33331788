// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>

#include "petzval/analysis/lens_metadata.hpp"
#include "petzval/analysis/st_map.hpp"
#include "petzval/core/export.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// Adds what a picture's lens was to its attributes, by the standard names of OpenEXR 3.2 (any version reads them):
/// lensMake, lensModel, lensSerialNumber; nominalFocalLength, pinholeFocalLength, effectiveFocalLength and
/// entrancePupilOffset (mm), aperture (the f-number), tStop, focus (m, from the film; infinite at infinity), and
/// sensorOverallDimensions (mm).
PETZVAL_API void add_lens_attributes(ExrPart& part, const LensDistortion& distortion,
                                     const LensIdentity& identity = {});

/// The maps as two parts, "undistort" and "redistort", with s in channel R and t in G, and the lens's attributes.
///
/// The display window is the film's picture. The margin of "undistort" lies around it, as overscan does in Nuke: its
/// STMap takes a part as it is. The attribute overscan tells the size of the pinhole's picture over the film's.
PETZVAL_API std::array<ExrPart, 2> to_exr_parts(const StMaps& maps, const LensDistortion& distortion,
                                                const LensIdentity& identity = {});

/// Writes the maps of exact chief rays of a lens as such a file, as write_file does. The lens has the film where it is
/// focused. Throws Error where LensDistortion and st_maps() do, and one that names the file.
PETZVAL_API void write_st_map(const Lens& lens, const Film& film, const LensIdentity& identity,
                              const std::filesystem::path& file, const StMapOptions& options = {});

}  // namespace petzval
