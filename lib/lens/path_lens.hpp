// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {

/// A surface on a path of light.
struct Passage {
  std::size_t surface = 0;  ///< surface_count(): the film, upright at Lens::film_z()
  bool reflects = false;  ///< true: light turns back here; false: it is refracted, or reflected by a mirror of the lens
};

/// The lens whose surfaces are the surfaces of a path, in the order in which light meets them.
///
/// Surfaces that reflect become mirrors. A surface that light meets several times appears as often, and its rim and
/// obscuration clip each time; so does the iris, except in kernel::trace(), where it clips once. Surfaces have no
/// coatings.
///
/// @param path  surfaces from the first surface of the lens on; each lies next to the surface before, in the direction
///              of travel
PETZVAL_API Lens along(const Lens& lens, std::span<const Passage> path);

/// The path to the film with reflections at the surface `second`, then at `first`; second is surface_count() for the
/// film.
PETZVAL_API std::vector<Passage> path_of_pair(const Lens& lens, std::size_t first, std::size_t second);

}  // namespace petzval::lens_detail
