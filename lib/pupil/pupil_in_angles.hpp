// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval::pupil_detail {

/// The region of exit_pupil_boundary() in angles at the film point: a direction at the angle t from the film normal has
/// the distance t from (0, 0). Unlike a plane, these coordinates include directions parallel to the film.
PupilRegion pupil_in_angles(const Lens& lens, const FilmPoint& point, Wavelength wavelength, std::size_t directions);

}  // namespace petzval::pupil_detail
