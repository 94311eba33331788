// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace petzval::focus_detail {

/// The diameter of a blur with its sign, negative in front of the plane of focus. defocus: the signed part of the
/// diameter due to defocus. If that is less than a tenth, the blur is made of aberrations, and the sign would depend on
/// single rays: it is positive then.
inline double signed_diameter(double diameter, double defocus) noexcept {
  constexpr double least = 0.1;
  return defocus < -least * diameter ? -diameter : diameter;
}

}  // namespace petzval::focus_detail
