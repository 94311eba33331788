// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// Whether a film meets other rays than an upright one at its place.
inline bool tilted_or_moving(const Film& film) noexcept { return film.tilted() || film.travel_mm != 0; }

/// Throws Error where core_detail::check_rectangle() does, and for a film that reaches into the last surface or is
/// tilted into the lens at any time.
void check_film(const Lens& lens, const Film& film);
/// The same, and for any film that is tilted or travels.
PETZVAL_API void check_upright_film(const Lens& lens, const Film& film);

/// A lens whose film lies where a Film says, and that film with its place set.
struct FilmBehindLens {
  Lens lens;
  Film film;
};
/// Throws Error where with_film() does, also for the lens's own film.
PETZVAL_API FilmBehindLens placed(const Lens& lens, const Film& film);

}  // namespace petzval::camera_detail
