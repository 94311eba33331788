// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace petzval::inline v0 {

/// A point of the scene, seen from the centre of the paraxial entrance pupil: `field_rad` away from the axis, in the
/// direction `azimuth_rad` turned from +y to +x. So a field of +10 degrees lies towards +y and is imaged at negative y
/// by a lens that turns its image upside down.
///
/// The pupil is that of the compiled wavelength nearest to the d line and the meridian y, so that a point is the same
/// for every wavelength. Fields of 90 degrees and more look past the lens: at a finite place their plane lies behind
/// the pupil.
struct FieldPoint {
  double field_rad = 0;    ///< within 180 degrees
  double z = 0;            ///< lens frame, mm; the plane the point lies in; -inf at infinity
  double azimuth_rad = 0;  ///< 0: towards +y; a quarter turn: towards +x
};

}  // namespace petzval::inline v0
