// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "petzval/camera/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0::camera_detail {

/// Throws Error for a film without area, pixels or place, and for one that is tilted by a quarter turn or more.
void check_rectangle(const std::string& where, const Film& film);
/// And, naming the lens, for one that leans into it.
void check_film(const Lens& lens, const Film& film);
/// Or for a tilted one.
void check_upright_film(const Lens& lens, const Film& film);

inline std::array<FilmPoint, 4> corners_of(const Film& film) noexcept {
  const auto [x, y] = std::array{film.centre_x_mm, film.centre_y_mm};
  const double half_width = film.width_mm / 2, half_height = film.height_mm / 2;
  return {FilmPoint{x - half_width, y - half_height}, FilmPoint{x + half_width, y - half_height},
          FilmPoint{x - half_width, y + half_height}, FilmPoint{x + half_width, y + half_height}};
}

}  // namespace petzval::inline v0::camera_detail
