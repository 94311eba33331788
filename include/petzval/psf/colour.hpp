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

/// Linear RGB weights of a set of wavelengths, in its order.
///
/// The weight of a wavelength is the integral of the matching functions over the band of wavelengths nearest to it,
/// within 420 to 680 nm, in sRGB primaries. Weights are balanced so that they sum to white (1, 1, 1); a single
/// wavelength is white. A weight is negative where the colour is purer than the primaries. Throws Error for an empty
/// set, duplicates, and several wavelengths of which one lies outside 420 to 680 nm.
PETZVAL_API std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm,
                                                           const ColourMatching& table);

}  // namespace petzval::inline v0
