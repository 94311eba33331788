// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"

namespace petzval {

/// The CIE 1931 2 degree colour matching functions, linear between their samples.
struct ColourMatching {
  std::vector<double> wavelengths_nm;
  std::vector<std::array<double, 3>> xyz;

  /// Reads cie1931_2deg_5nm.csv.
  ///
  /// @throws Error with file and line, if the table is invalid
  PETZVAL_API static ColourMatching load(const std::filesystem::path& file);
};

/// The spectral power of a light source per nm, in any unit: linear between the samples and 0 outside their range.
struct Spectrum {
  std::vector<double> wavelengths_nm;  ///< increasing
  std::vector<double> power;

  /// Reads a CSV file with the header "wavelength_nm,power".
  ///
  /// @throws Error with file and line, unless there are two rows or more, the wavelengths are positive and increasing,
  ///               and the powers are finite and not negative
  PETZVAL_API static Spectrum load(const std::filesystem::path& file);
};

/// Spectrum of a CIE standard illuminant from 300 to 830 nm.
///
/// @param name                 "D65" or "D50": daylight of nominally 6500 and 5000 K; "A": tungsten lamp, a black body
///                             of 2856 K; "E": equal power at all wavelengths
/// @param daylight_components  the table cie_daylight_10nm.csv, used for D65 and D50
/// @throws Error               if the name is unknown; with file and line if the table is invalid
///
/// Source: CIE 15, Colorimetry: S0 + M1 S1 + M2 S2 with M1 and M2 to three decimals; A in closed form.
PETZVAL_API Spectrum illuminant(std::string_view name, const std::filesystem::path& daylight_components);

/// CIE XYZ of a light, in the light's unit of power.
///
/// The product of the two piecewise linear functions is integrated exactly over the range of the table.
///
/// @throws Error if load() would reject the spectrum, or unless the table has two finite wavelengths or more, positive
///               and increasing, each with a finite triple
PETZVAL_API std::array<double, 3> tristimulus(const Spectrum& light, const ColourMatching& table);

/// Correlated colour temperature of a light (K): the temperature of the black body with the nearest chromaticity in the
/// CIE 1960 diagram.
///
/// @param xy     CIE 1931 chromaticity of the light
/// @param table  the colour matching functions, for the chromaticities of black bodies
/// @return       nullopt if the distance exceeds 0.05, or the temperature is outside 1000 to 100 000 K
/// @throws Error under the conditions of tristimulus()
///
/// Source: CIE 15, Colorimetry, section 9.5; Planck's law with c2 = 1.4388 cm K.
/// Accuracy: 0.02 % for black bodies from 2000 to 15 000 K (tests/analysis/colour_test.cpp).
PETZVAL_API std::optional<double> correlated_colour_temperature(const std::array<double, 2>& xy,
                                                                const ColourMatching& table);

/// Linear RGB weights of a set of wavelengths. Their sum is the colour of the light at the luminance of white.
///
/// A weight is the tristimulus() of the light over the band of wavelengths nearest to its wavelength, in sRGB
/// primaries; the first and the last band extend to the ends of the table. A weight has negative components if its
/// colour is outside the sRGB gamut. A single wavelength has the weight (1, 1, 1) in any light.
///
/// @param wavelengths_nm  the wavelengths (nm), in any order
/// @param table           the colour matching functions
/// @param light           the spectrum of the light
/// @param white           the light that appears white: its weights sum to (1, 1, 1). Colours are adapted from it to
///                        the white of sRGB (D65) by the Bradford transform, as in ICC profiles
/// @return                one weight per wavelength, in the same order
/// @throws Error          if the set is empty or has duplicates, one of several wavelengths lies outside 420 to 680 nm,
///                        the light has no luminance, or tristimulus() throws
PETZVAL_API std::vector<std::array<double, 3>> rgb_weights(std::span<const double> wavelengths_nm,
                                                           const ColourMatching& table, const Spectrum& light,
                                                           const Spectrum& white);

/// The cheapest wavelengths for a renderer with three channels: one wavelength per channel.
///
/// White light stays white; a colour fringe contains only the colours of the three images.
/// Source: Lee, Eisemann, Seidel, Real-time lens blur effects and focus control, 2010, section 4.
inline constexpr std::array<double, 3> rgb_triple_nm{650, 510, 475};
inline constexpr std::array<std::array<double, 3>, 3> rgb_triple_weights{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

}  // namespace petzval
