// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/core/vec.hpp"
#include "petzval/movement/plane.hpp"
#include "petzval/pupil/field_point.hpp"

namespace petzval::inline v0 {

/// Where a film stands: through the axis at film_z, its normal Ry(swing) Rx(tilt) e_z (tilt about +x first). Film
/// points count from the axis along what +x and +y of the lens frame become. Lens frame, mm.
struct PETZVAL_API FilmPose {
  double film_z = 0;
  double tilt_rad = 0, swing_rad = 0;

  bool upright() const noexcept { return tilt_rad == 0 && swing_rad == 0; }
  Vec3<double> right() const noexcept;   ///< what +x becomes
  Vec3<double> up() const noexcept;      ///< what +y becomes
  Vec3<double> normal() const noexcept;  ///< what +z becomes
  /// Between film and the plane across the axis, 0 to pi.
  double angle() const noexcept;
  Plane plane() const noexcept;
  /// The place of a film point.
  Vec3<double> at(const FilmPoint& point) const noexcept;
  /// The film point at a place on the film; of one beside it the foot of the perpendicular.
  FilmPoint point(const Vec3<double>& place) const noexcept;
};

/// The rectangle that is exposed, in the coordinates of film points, mm.
struct FilmFrame {
  double width_mm = 36, height_mm = 24;
  double centre_x_mm = 0, centre_y_mm = 0;
};

/// The pose of a film in a plane, upright where it may be: swing within a quarter turn. Throws Error for a plane along
/// the axis and numbers that are not finite.
PETZVAL_API FilmPose film_pose(const Plane& plane);

}  // namespace petzval::inline v0
