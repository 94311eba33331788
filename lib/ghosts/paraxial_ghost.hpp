// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "footprint.hpp"

namespace petzval::ghosts_detail {

/// The light of a path to first order: one polygon of uniform irradiance on the film.
///
/// The matrices of the path map the rays of the light to heights at every surface, about the axis. The polygon is the
/// part of the entrance plane within all rims and the iris, with 64 corners; obscurations are left out. The power is
/// that of one ray through its middle.
///
/// @param path  passages of the surfaces
/// @param along  the lens of these passages
Footprint paraxial_footprint(std::span<const lens_detail::Passage> path, const Lens& along, const Entrance& entrance,
                             const Surfaces& surfaces, Wavelength wavelength, const Film& film);

}  // namespace petzval::ghosts_detail
