// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace petzval::focus_detail {

/// The blur diameter with its sign, negative for points nearer than the plane of focus. The sign is positive if the
/// absolute value of defocus is less than a tenth of the diameter: aberrations then dominate, and the sign would depend
/// on single rays.
/// @param defocus the signed diameter due to defocus
inline double signed_diameter(double diameter, double defocus) noexcept {
  constexpr double min_relative_defocus = 0.1;
  return defocus < -min_relative_defocus * diameter ? -diameter : diameter;
}

}  // namespace petzval::focus_detail
