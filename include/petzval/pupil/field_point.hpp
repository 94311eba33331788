// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/version.hpp"

namespace petzval::inline v0 {

/// A point of the scene, seen from the centre of the paraxial entrance pupil: `field_rad` away from the axis, in the
/// direction `azimuth_rad` turned from +y to +x. A field of +10 degrees lies towards +y, and a lens that turns its
/// image upside down images it at negative y.
///
/// The pupil is that of the primary wavelength in the meridian y, so that a point is the same for every wavelength.
/// Points at 90 degrees and more lie beside the lens: at a finite distance their plane is behind the pupil.
struct FieldPoint {
  double field_rad = 0;    ///< within 180 degrees
  double z = 0;            ///< lens frame, mm; the plane the point lies in; -inf at infinity
  double azimuth_rad = 0;  ///< 0: towards +y; a quarter turn: towards +x
};

}  // namespace petzval::inline v0
