// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "petzval/blur/layers.hpp"
#include "petzval/core/config.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/exports/lens_metadata.hpp"
#include "petzval/image/image.hpp"

namespace petzval {

/// The samples of a deep image, with counts of unusual samples.
struct DeepPicture {
  FragmentLists lists;  ///< the display window
  /// Number of samples left out because their depth is NaN, negative or 0 (in the pinhole).
  std::size_t without_depth = 0;
  /// Number of volume samples (ZBack beyond Z).
  std::size_t volumes = 0;
  /// Number of samples left out because they are outside the display window.
  std::size_t outside = 0;
};

/// Reads a deep part of an EXR file, with scan lines or tiles (the largest level).
///
/// The channels are Z, R, G and B, or Y instead of colours, of type half or float. A defaults to 1, ZBack to Z. Colours
/// are premultiplied by alpha, as usual in EXR. Samples keep their order and, with a unit of 1, their exact values. The
/// result has the pixels of the display window; pixels outside the data window are empty.
///
/// @param file     the EXR file
/// @param unit_mm  unit of Z in mm (metres: 1000)
/// @param part     name of the part; empty: the first deep part
/// @throws Error   if the file is damaged, has no such deep part, no channel Z or no colours, or has more than 2^27
///                 pixels or samples; also if the unit is not positive and finite
///
/// Memory: 24 bytes a sample and 16 bytes a pixel; twice as much if a file has more samples than bytes.
///
/// Limitations: files do not state if Z is the depth along the axis or the distance from the pinhole. axial_depths()
/// converts distances to depths.
PETZVAL_API DeepPicture read_deep_exr(const std::filesystem::path& file, double unit_mm = 1,
                                      const std::string& part = {});

/// Writes deep scan lines of 32-bit floats with write_file(), lossless. Volumes have a channel ZBack.
///
/// @throws Error if the lists are empty or inconsistent, or the file cannot be written
PETZVAL_API void write_deep_exr(const FragmentLists& lists, const std::filesystem::path& file);

/// Adds lens metadata to the attributes of an image.
///
/// Uses the standard names of OpenEXR 3.2, which all versions can read: lensMake, lensModel, lensSerialNumber;
/// nominalFocalLength, pinholeFocalLength, effectiveFocalLength and entrancePupilOffset (mm); aperture (f-number);
/// tStop (only if the lens states a coating, LensState::t_number); focus (m, from the film; infinite at infinity);
/// sensorOverallDimensions (mm).
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
/// @param overscan  as in st_maps()
/// @param threads   as in st_maps()
/// @throws Error    if the file cannot be written; also under the conditions of LensDistortion and st_maps()
PETZVAL_API void write_st_map(const Lens& lens, const Film& film, const LensIdentity& identity,
                              const std::filesystem::path& file, std::optional<double> overscan = {}, int threads = 1);

}  // namespace petzval
