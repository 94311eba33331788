// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval {

/// The medium behind a surface: air, a glass of a catalogue, or an index and an Abbe number.
///
/// A stated index applies at the reference wavelength of the prescription, and the glass supplies the dispersion.
/// Without a stated index the formula of the glass supplies both.
///
///     petzval::Medium{}                                    // air
///     petzval::Medium{.glass = "N-BK7"}                    // index and dispersion of the glass tables
///     petzval::Medium{.glass = "N-BK7", .nd = 1.5168}      // a printed index, the dispersion of the glass
///     petzval::Medium{.nd = 1.62, .vd = 60.3}              // an unknown glass
struct Medium {
  std::optional<std::string> glass{};         ///< "N-BK7"
  std::optional<std::string> catalogue{};     ///< catalogue of the glass; nullopt: any
  std::optional<std::string> glass_origin{};  ///< "matched": found by nd and vd, not printed in the source
  std::optional<double> nd{};                 ///< nullopt: index of the glass, or air without a glass
  std::optional<double> vd{};                 ///< 0: the index is nd at all wavelengths, unless the glass is known

  /// True if no glass is named and the index is 1 or absent.
  bool is_air() const noexcept { return !glass && nd.value_or(1) == 1; }
  /// True if all members are equal, or if both media are air.
  bool operator==(const Medium& other) const {
    if (is_air() || other.is_air()) return is_air() && other.is_air();
    return std::tie(glass, catalogue, glass_origin, nd, vd) ==
           std::tie(other.glass, other.catalogue, other.glass_origin, other.nd, other.vd);
  }
};

/// An aspheric term: adds coefficient * r^order to the sag.
struct AsphereTerm {
  int order = 4;           ///< 2 to 40, even or odd
  double coefficient = 0;  ///< mm^(1 - order)

  bool operator==(const AsphereTerm&) const = default;
};

/// The sections in which a surface is curved: both, or x or y for a cylinder.
enum class Section { both, x, y };

/// One row of a lens table: a surface and the space after that surface. Lengths in mm.
struct SurfaceRow {
  double radius = 0;                      ///< vertex radius; positive if the centre lies on the +z side; 0 for a plane
  double thickness = 0;                   ///< distance to the next vertex or the film; negative if light runs backwards
  Medium medium{};                        ///< medium behind the surface; for a mirror, the medium in front
  std::optional<double> semi_diameter{};  ///< clear aperture; nullopt: compile() computes it; infinite: unlimited
  bool semi_diameter_computed = false;    ///< true if with_apertures() computed the aperture, false if stated
  std::optional<double> obscuration_semi_diameter{};  ///< central obscuration, which blocks rays
  double conic = 0;                                   ///< k in c r^2 / (1 + sqrt(1 - (1+k) c^2 r^2))
  std::vector<AsphereTerm> aspheric{};
  bool stop = false;
  bool mirror = false;
  Section curved_in = Section::both;
  std::optional<std::string> comment{};  ///< comment of the source on the surface

  bool operator==(const SurfaceRow&) const = default;
};

}  // namespace petzval
