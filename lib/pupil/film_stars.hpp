// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/pupil/film_lines.hpp"
#include "petzval/pupil/pupil_map.hpp"
#include "petzval/pupil/pupil_star.hpp"

namespace petzval::detail {

inline constexpr std::size_t film_strips = 64;  ///< between the heights of stars

/// Up to where the film gets light: film_radius, or where it is dark at last.
double lit_radius(const Lens& lens, const FilmSpace& space, double film_radius, std::size_t wavelength);

/// The pupils of film points on +y at 65 heights up to film_radius, traced; `covering`: with what lies between
/// contained, else of their area.
std::vector<PupilStar> film_stars(const Lens& lens, const FilmSpace& space, double film_radius, bool covering,
                                  std::size_t wavelength);

/// One star that contains the pupils of all film points, for a lens without symmetry of revolution.
PupilStar star_for_all(const Lens& lens, const FilmSpace& space, double film_radius, std::size_t wavelength);

/// What lies within all of some discs, for film points on +y at 65 heights.
std::vector<PupilStar> disc_stars(std::span<const PupilDisc> discs, double film_radius);

}  // namespace petzval::detail
