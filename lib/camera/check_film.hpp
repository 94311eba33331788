// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::camera_detail {

/// True if the rays that meet a film can differ from the rays that meet the upright film at its position.
inline bool tilted_or_moving(const Film& film) noexcept { return film.tilted() || film.travel_mm != 0; }

/// @throws Error  as core_detail::check_rectangle(), and if the film reaches into the last surface or is tilted into
/// the lens at any time
void check_film(const Lens& lens, const Film& film);
/// @throws Error  as check_film(), and if the film is tilted or travels
PETZVAL_API void check_upright_film(const Lens& lens, const Film& film);

/// A lens with its film at the position of a Film, and that film with its position set.
struct FilmBehindLens {
  Lens lens;
  Film film;
};
/// @throws Error  as with_film(), also if the film has no position of its own
PETZVAL_API FilmBehindLens placed(const Lens& lens, const Film& film);

}  // namespace petzval::camera_detail
