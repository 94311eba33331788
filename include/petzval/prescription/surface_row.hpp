// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "petzval/core/version.hpp"

namespace petzval::inline v0 {

/// The medium behind a surface. nd is the printed index; the glass, if known, gives the dispersion.
struct Medium {
  std::optional<std::string> glass{};         ///< "N-BK7"
  std::optional<std::string> catalogue{};     ///< of the glass; absent: any
  std::optional<std::string> glass_origin{};  ///< "matched": found by nd and vd, not printed in the source
  double nd = 1;
  std::optional<double> vd{};

  bool operator==(const Medium&) const = default;
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
  std::optional<double> semi_diameter{};              ///< of the clear aperture; absent: unlimited
  std::optional<double> obscuration_semi_diameter{};  ///< of a central obscuration; rays inside it are lost
  double conic = 0;                                   ///< k in c r^2 / (1 + sqrt(1 - (1+k) c^2 r^2))
  std::vector<AsphereTerm> aspheric{};
  bool stop = false;
  bool mirror = false;
  Section curved_in = Section::both;
  std::optional<std::string> comment{};  ///< a word of the source about the surface

  bool operator==(const SurfaceRow&) const = default;
};

}  // namespace petzval::inline v0
