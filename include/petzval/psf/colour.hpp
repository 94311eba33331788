// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <vector>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// The CIE 1931 2 degree colour matching functions, sampled.
struct ColourMatching {
  std::vector<double> wavelengths_nm;
  std::vector<std::array<double, 3>> xyz;

  /// Reads cie1931_2deg_5nm.csv. Throws Error with file and line.
  PETZVAL_API static ColourMatching load(const std::filesystem::path& file);
};

/// Linear RGB weight of each wavelength of a set, in its order: the functions integrated from 420 to 680 nm over the
/// band of wavelengths nearest to it, turned to sRGB primaries and balanced so that the weights of the whole set sum to
/// white (1, 1, 1). One wavelength alone is white, then, wherever it lies. A weight may be negative: a colour purer
/// than the primaries. Throws Error for an empty set, duplicates, and several wavelengths of which one lies outside 420
/// to 680 nm.
PETZVAL_API std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm,
                                                           const ColourMatching& table);

}  // namespace petzval::inline v0
