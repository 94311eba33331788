// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

#include "petzval/core/export.hpp"
#include "petzval/core/fragment_lists.hpp"

namespace petzval {

/// The samples of a deep picture, and what was made of them.
struct DeepPicture {
  FragmentLists lists;
  /// Samples with a depth that is negative or not a number, which are left out. (0 too: it lies in the pinhole.)
  std::size_t without_depth = 0;
  /// Samples of volumes (ZBack beyond Z), which count as surfaces at Z with their alpha.
  std::size_t volumes = 0;
};

/// Reads the deep scan lines of an EXR file: the first part that has some. Channels Z, R, G and B, or Y instead of
/// colours; A is 1 where it is missing; half or float. Colours are multiplied with alpha, as EXR has them. Z is the
/// depth along the axis or the distance: files do not say which (axial_depths() turns distances into depths). It is
/// taken for mm; `unit_mm` is the unit of other files (m: 1000).
///
/// Samples keep the file's order, and their numbers to the bit for a unit of 1. Throws Error that names the file: for
/// one that is no deep picture, that lacks Z or colours, that is damaged, and for more than 2^27 pixels or samples.
PETZVAL_API DeepPicture read_deep_exr(const std::filesystem::path& file, double unit_mm = 1);

/// Writes deep scan lines, 32-bit floats, without loss, as write_file does. Throws Error that names the file.
PETZVAL_API void write_deep_exr(const FragmentLists& lists, const std::filesystem::path& file);

}  // namespace petzval
