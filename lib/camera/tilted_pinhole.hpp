// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tilted_film.hpp"

/// A pinhole in front of a tilted film: each film point has one ray, that of the upright film's point `chief` through
/// the centre of the thick lens's exit pupil, and the weights of the whole pupil. The chief is the virtual point times
/// 1 / (1 + nearer_by(virtual_point) shift), with shift as ParaxialModel::pinhole_shifts(). By the place where the ray
/// passes the plane of the pupils it is proportional to 1 + travel - slope . place.
namespace petzval::camera_detail {

inline double part_of_virtual(const TiltedPlane& plane, const FilmPoint& virtual_point, double shift) noexcept {
  return 1 / (1 + plane.nearer_by(virtual_point) * shift);
}
inline double part_by_place(const TiltedPlane& plane, const FilmPoint& place) noexcept {
  return 1 + plane.travel - (plane.slope_x * place.x + plane.slope_y * place.y);
}

/// The image-space ray of a film point, with its derivatives by film x and y.
TwoPlaneRayDerivatives pinhole_line(const TiltedPlane& plane, const FilmPoint& film, double shift) noexcept;

}  // namespace petzval::camera_detail
