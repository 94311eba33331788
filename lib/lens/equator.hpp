// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {

/// Height of the equator of a surface's base conic, mm; infinite for a paraboloid, a hyperboloid and a plane.
inline double equator(const LensSurface& surface) noexcept {
  const double bend = 1 + surface.conic;
  if (!(bend > 0) || surface.curvature == 0) return std::numeric_limits<double>::infinity();
  return 1 / (std::abs(surface.curvature) * std::sqrt(bend));
}

}  // namespace petzval::lens_detail
