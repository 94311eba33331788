// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"

namespace petzval {

/// The CIE 1931 2 degree colour matching functions, linear between their samples.
struct ColourMatching {
  std::vector<double> wavelengths_nm;
  std::vector<std::array<double, 3>> xyz;

  /// Reads cie1931_2deg_5nm.csv. Throws Error with file and line.
  PETZVAL_API static ColourMatching load(const std::filesystem::path& file);
};

/// The light of a source: its power per nm in any unit, linear between the samples and 0 outside them.
struct Spectrum {
  std::vector<double> wavelengths_nm;  ///< increasing
  std::vector<double> power;

  /// Reads "wavelength_nm,power": two rows or more, wavelengths above 0 and increasing, powers finite and not negative.
  /// Throws Error with file and line.
  PETZVAL_API static Spectrum load(const std::filesystem::path& file);
};

/// A CIE standard illuminant by name, from 300 to 830 nm: "D65" or "D50", daylight of 6500 and 5000 K (nominal); "A", a
/// tungsten lamp, a black body of 2856 K; "E", equal power at all wavelengths. daylight_components: the table
/// cie_daylight_10nm.csv, of which daylight is made. Throws Error for another name, and with file and line for an
/// invalid table.
/// Source: CIE 15, Colorimetry: S0 + M1 S1 + M2 S2 with M1 and M2 to three decimals; A in closed form.
PETZVAL_API Spectrum illuminant(std::string_view name, const std::filesystem::path& daylight_components);

/// CIE XYZ of a light, in its unit of power; linear in the light. Exact integrals of both piecewise linear functions
/// over the range of the table. Throws Error for a spectrum that load() would refuse, and for a table that has not two
/// wavelengths or more, above 0 and increasing, with a triple each, all finite.
PETZVAL_API std::array<double, 3> tristimulus(const Spectrum& light, const ColourMatching& table);

/// Linear RGB weights of a set of wavelengths, in its order; they sum to the colour of the light at the luminance of
/// white.
///
/// The weight of a wavelength is the light's tristimulus() over the band of wavelengths nearest to it (the first and
/// the last band reach to the ends of the table), in sRGB primaries. `white` is the light that looks white: its weights
/// sum to (1, 1, 1). Colours are adapted from it to the white of sRGB by the Bradford transform, as ICC profiles adapt
/// them; for D65 that leaves them as they are. A single wavelength is white, (1, 1, 1), in any light. A weight is
/// negative where the colour is purer than the primaries.
///
/// Throws Error for an empty set, duplicates, several wavelengths of which one lies outside 420 to 680 nm, and where
/// tristimulus() does; also for a light without luminance.
PETZVAL_API std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm,
                                                           const ColourMatching& table, const Spectrum& light,
                                                           const Spectrum& white);

/// The cheapest set for a renderer with three channels: one wavelength stands for each, and each channel takes its own.
/// The light is white, but a fringe has only the colours of the three images.
/// Source: Lee, Eisemann, Seidel, Real-time lens blur effects and focus control, 2010, section 4.
inline constexpr std::array<double, 3> rgb_triple_nm{650, 510, 475};
inline constexpr std::array<std::array<double, 3>, 3> rgb_triple_weights{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

}  // namespace petzval
