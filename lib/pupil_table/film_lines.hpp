// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "pupil/boundary_search.hpp"

namespace petzval::pupil_table_detail {

/// The clearances of the rays of some film points through a lens, which has to outlive the result. Places lie in the
/// plane of the pupil.
pupil_detail::PlaceClearances traced_lines(const Lens& lens, const TwoPlanes& space, std::vector<FilmPoint> points,
                                           std::size_t wavelength);

/// Where the pupils of film points are expected to first order. Rays pass the last surface: a pupil is no larger than
/// what is seen through it.
std::vector<pupil_detail::PupilGuess> first_order_guesses(const Lens& lens, const TwoPlanes& space,
                                                          std::span<const FilmPoint> points, std::size_t wavelength);

}  // namespace petzval::pupil_table_detail
