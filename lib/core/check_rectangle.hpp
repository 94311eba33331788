// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"

namespace petzval::core_detail {

/// Checks the size, pixels, position and tilt of a film.
/// @throws Error, prefixed with `where`, if the film has no area or no pixels, if a length exceeds 1e9 mm, or if it is
/// tilted by a quarter turn or more
PETZVAL_API void check_rectangle(const std::string& where, const Film& film);

}  // namespace petzval::core_detail
