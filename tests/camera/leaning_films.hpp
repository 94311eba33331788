// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/camera/film.hpp"
#include "petzval/core/units.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/movement/film_pose.hpp"

namespace petzval::testing {

inline const Film wide{.width_mm = 36, .height_mm = 24};
inline const Film shifted{.width_mm = 36, .height_mm = 24, .centre_x_mm = -3, .centre_y_mm = 6};

inline Film leaning(Film film, double tilt_deg, double swing_deg) {
  film.tilt_rad = radians(tilt_deg);
  film.swing_rad = radians(swing_deg);
  return film;
}

inline FilmPose pose_of(const Lens& lens, const Film& film) { return {lens.film_z(), film.tilt_rad, film.swing_rad}; }

}  // namespace petzval::testing
