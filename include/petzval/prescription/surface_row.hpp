// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval {

/// The medium behind a surface: air, a glass of a catalogue, or numbers. A stated index counts at the reference
/// wavelength of the prescription, and the glass gives the dispersion; without a stated index the formula of the glass
/// gives both.
///
///     petzval::Medium{}                                    // air
///     petzval::Medium{.glass = "N-BK7"}                    // n_d and V_d of the glass tables
///     petzval::Medium{.glass = "N-BK7", .nd = 1.5168}      // a printed index, the dispersion of the glass
///     petzval::Medium{.nd = 1.62, .vd = 60.3}              // an unknown glass
struct Medium {
  std::optional<std::string> glass{};         ///< "N-BK7"
  std::optional<std::string> catalogue{};     ///< of the glass; absent: any
  std::optional<std::string> glass_origin{};  ///< "matched": found by nd and vd, not printed in the source
  std::optional<double> nd{};                 ///< absent: of the glass; without a glass: air
  std::optional<double> vd{};                 ///< 0: without a known glass the index is nd at all wavelengths

  /// True if no glass is named and the index is 1 or absent.
  bool is_air() const noexcept { return !glass && nd.value_or(1) == 1; }
  /// True if all members are equal, or if both media are air.
  bool operator==(const Medium& other) const {
    if (is_air() || other.is_air()) return is_air() && other.is_air();
    return std::tie(glass, catalogue, glass_origin, nd, vd) ==
           std::tie(other.glass, other.catalogue, other.glass_origin, other.nd, other.vd);
  }
};

/// coefficient * r^order added to the sag; order 2 or more, even or odd; coefficient in mm^(1 - order).
struct AsphereTerm {
  int order = 4;
  double coefficient = 0;

  bool operator==(const AsphereTerm&) const = default;
};

/// The section in which a surface is curved: both, or one of them for a cylinder.
enum class Section { both, x, y };

/// One row of a lens table: a surface and what follows it. Millimetres.
struct SurfaceRow {
  double radius = 0;     ///< at the vertex; positive if the centre lies on the +z side; 0 is a plane
  double thickness = 0;  ///< to the next vertex (the last: to the film); negative where light runs backwards
  Medium medium{};       ///< behind the surface; of a mirror: the medium in front of it
  std::optional<double> semi_diameter{};  ///< of the clear aperture; absent: compile() computes it; infinite: unlimited
  bool semi_diameter_computed = false;    ///< true if with_apertures() has computed it, false if the source states it
  std::optional<double> obscuration_semi_diameter{};  ///< of a central obscuration; rays inside it are lost
  double conic = 0;                                   ///< k in c r^2 / (1 + sqrt(1 - (1+k) c^2 r^2))
  std::vector<AsphereTerm> aspheric{};
  bool stop = false;
  bool mirror = false;
  Section curved_in = Section::both;
  std::optional<std::string> comment{};  ///< a word of the source about the surface

  bool operator==(const SurfaceRow&) const = default;
};

}  // namespace petzval
