// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/camera/tilted_film.hpp"

/// A pinhole before a tilted film: one ray for each film point, that of the upright film's point `chief` through the
/// middle of the thick lens's exit pupil, and the weights of all that pupil. As the pupil lies beside the plane of
/// samples, a tilted point sees it there in another size than its chief does, by the factor `part`, about the ray's own
/// place: by 1 / (1 + slope . key shift), shift as ParaxialModel::pinhole_shifts(), or 1 - slope . place.
namespace petzval::inline v0::camera_detail {

inline double part_of_key(const TiltedPlane& plane, const FilmPoint& key, double shift) noexcept {
  return 1 / (1 + plane.slope_along(key) * shift);
}
inline double part_of_place(const TiltedPlane& plane, const FilmPoint& place) noexcept {
  return 1 - plane.slope_along(place);
}

/// The upright line of a film point's ray, with its derivatives by film x and y.
TwoPlaneRayDerivatives pinhole_line(const TiltedFilm& tilted, const FilmPoint& film, double shift) noexcept;

}  // namespace petzval::inline v0::camera_detail
