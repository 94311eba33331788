// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

#include "petzval/core/export.hpp"
#include "petzval/core/fragment_lists.hpp"

namespace petzval {

/// The samples of a deep image, with counts of unusual samples.
struct DeepPicture {
  FragmentLists lists;
  /// Number of samples left out because their depth is NaN, negative or 0 (in the pinhole).
  std::size_t without_depth = 0;
  /// Number of volume samples (ZBack beyond Z), which are read as surfaces at Z with their alpha.
  std::size_t volumes = 0;
};

/// Reads the first part with deep scan lines of an EXR file.
///
/// The channels are Z, R, G and B, or Y instead of colours, of type half or float. A defaults to 1. Colours are
/// premultiplied by alpha, as usual in EXR. Samples keep their order and, with a unit of 1, their exact values.
///
/// @param file     the EXR file
/// @param unit_mm  unit of Z in mm (metres: 1000)
/// @throws Error   if the file is damaged, has no deep part, no channel Z or no colours, or has more than 2^27 pixels
///                 or samples; also if the unit is not positive and finite
///
/// Limitations: files do not state if Z is the depth along the axis or the distance from the pinhole. axial_depths()
/// converts distances to depths.
PETZVAL_API DeepPicture read_deep_exr(const std::filesystem::path& file, double unit_mm = 1);

/// Writes deep scan lines of 32-bit floats with write_file(), lossless.
///
/// @throws Error if the lists are empty or inconsistent, or the file cannot be written
PETZVAL_API void write_deep_exr(const FragmentLists& lists, const std::filesystem::path& file);

}  // namespace petzval
