// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/camera/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::detail {

/// Throws Error, naming the lens, for a film without area, pixels or place, and for a tilted one.
void check_film(const Lens& lens, const Film& film);

}  // namespace petzval::detail
