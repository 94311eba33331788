// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/boundary_search.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::pupil_table_detail {

/// Clearances of rays from film points through positions in the pupil plane. The lens must outlive the result.
pupil_detail::PositionClearances traced_lines(const Lens& lens, const TwoPlanes& space, std::vector<FilmPoint> points,
                                              std::size_t wavelength);

/// First-order predictions of the pupils of film points. The last surface, which all rays pass, limits the size of a
/// pupil.
std::vector<pupil_detail::PupilGuess> first_order_guesses(const Lens& lens, const TwoPlanes& space,
                                                          std::span<const FilmPoint> points, std::size_t wavelength);

}  // namespace petzval::pupil_table_detail
