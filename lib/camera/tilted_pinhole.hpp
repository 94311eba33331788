// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tilted_film.hpp"

/// A pinhole in front of a tilted film. Each film point has one ray, and the weights of the complete pupil. It is the
/// ray of a point `chief` of the upright film, through the centre of the exit pupil of the thick lens. This point is
/// the virtual point times 1 / (1 + distance_excess(virtual_point) shift), with shift from
/// ParaxialModel::pinhole_shifts(). As a function of the position at which the ray passes the pupil plane, the factor
/// is proportional to 1 + travel - slope . position.
namespace petzval::camera_detail {

inline double virtual_scale(const TiltedPlane& plane, const FilmPoint& virtual_point, double shift) noexcept {
  return 1 / (1 + plane.distance_excess(virtual_point) * shift);
}
inline double depth_ratio_at(const TiltedPlane& plane, const FilmPoint& position) noexcept {
  return 1 + plane.travel - (plane.slope_x * position.x + plane.slope_y * position.y);
}

/// Image-space ray of a film point, with derivatives with respect to film x and y.
TwoPlaneRayDerivatives pinhole_line(const TiltedPlane& plane, const FilmPoint& film, double shift) noexcept;

}  // namespace petzval::camera_detail
