// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::testing {

inline const Film wide{.width_mm = 36, .height_mm = 24};
inline const Film shifted{.width_mm = 36, .height_mm = 24, .shift_x_mm = -3, .shift_y_mm = 6};

inline Film tilted_by(Film film, double tilt_deg, double swing_deg) {
  film.tilt_rad = radians(tilt_deg);
  film.swing_rad = radians(swing_deg);
  return film;
}

inline Film pose_of(const Lens& lens, Film film) {
  film.z_mm = lens.film_z();
  return film;
}

}  // namespace petzval::testing
