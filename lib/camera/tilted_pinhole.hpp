// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tilted_film.hpp"

/// A pinhole in front of a tilted film.
namespace petzval::camera_detail {

/// Proportional to chief_scale() of a film point, as a function of the position at which the ray passes the pupil
/// plane.
inline double depth_ratio_at(const TiltedPlane& plane, const FilmPoint& position) noexcept {
  return 1 + plane.travel - (plane.slope_x * position.x + plane.slope_y * position.y);
}

/// Image-space ray of a film point, with derivatives with respect to film x and y.
TwoPlaneRayDerivatives pinhole_line(const TiltedPlane& plane, const FilmPoint& film, double shift) noexcept;

}  // namespace petzval::camera_detail
