// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// The marginal ray of an axial point, behind the lens.
struct MarginalRay {
  double height = 0;  ///< height in the rear focal plane, mm
  double slope = 0;   ///< slope per mm of z
};

/// The marginal ray of an axial object at distance p in front of the front focal point.
///
/// p may be infinite if the entrance pupil is at a finite position.
PETZVAL_API MarginalRay marginal_ray(const IdealLens& lens, double p) noexcept;

}  // namespace petzval
