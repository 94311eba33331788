// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tilted_film.hpp"

/// A pinhole in front of a tilted film: each film point has one ray, that of the upright film's point `chief` through
/// the centre of the thick lens's exit pupil, and the weights of the whole pupil. The chief is the virtual point times
/// `part`, which is 1 / (1 + slope . virtual_point shift), with shift as ParaxialModel::pinhole_shifts(), or 1 - slope
/// . place, place where the ray passes the plane of the pupils.
namespace petzval::inline v0::camera_detail {

inline double part_of_virtual(const TiltedPlane& plane, const FilmPoint& virtual_point, double shift) noexcept {
  return 1 / (1 + plane.slope_along(virtual_point) * shift);
}
inline double part_of_place(const TiltedPlane& plane, const FilmPoint& place) noexcept {
  return 1 - plane.slope_along(place);
}

/// The image-space ray of a film point, with its derivatives by film x and y.
TwoPlaneRayDerivatives pinhole_line(const TiltedFilm& tilted, const FilmPoint& film, double shift) noexcept;

}  // namespace petzval::inline v0::camera_detail
