// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/pupil/pupil_boundary.hpp"

namespace petzval::pupil_detail {

/// The same region as exit_pupil_boundary()'s, by the angles under which the film point sees it: a direction at the
/// angle t from the normal of the film lies t from (0, 0), towards where it points. It holds directions along the film
/// too, which no plane does.
PupilRegion directions_seen(const Lens& lens, const FilmPoint& point, Wavelength wavelength, std::size_t directions);

}  // namespace petzval::pupil_detail
