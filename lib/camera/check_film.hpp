// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0::camera_detail {

/// Throws Error for a film without area, pixels or place, and for one that is tilted by a quarter turn or more.
void check_rectangle(const std::string& where, const Film& film);
/// And, naming the lens, for one that is tilted into it.
void check_film(const Lens& lens, const Film& film);
/// Or for a tilted one.
void check_upright_film(const Lens& lens, const Film& film);

/// A lens and a film in one place: the film's where that is set, else the lens's.
struct FilmBehindLens {
  Lens lens;
  Film film;  ///< z_mm is set, to the lens's film_z()
};
/// Throws Error where with_film() does.
PETZVAL_API FilmBehindLens placed(const Lens& lens, const Film& film);

}  // namespace petzval::inline v0::camera_detail
