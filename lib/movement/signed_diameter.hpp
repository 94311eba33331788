// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace petzval::inline v0::movement_detail {

/// A blur's diameter with its sign: negative in front of the plane of focus. defocus: the part of it that defocus
/// makes, signed. Where that is less than a tenth of it, aberrations are all there is, and few rays would decide by
/// chance: such a blur counts as positive.
inline double signed_diameter(double diameter, double defocus) noexcept {
  constexpr double told = 0.1;
  return defocus < -told * diameter ? -diameter : diameter;
}

}  // namespace petzval::inline v0::movement_detail
