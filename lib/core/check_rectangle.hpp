// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"

namespace petzval::core_detail {

/// Throws Error, which begins with `where`, for a film without area or pixels, with lengths beyond 1e9 mm, or tilted by
/// a quarter turn or more.
PETZVAL_API void check_rectangle(const std::string& where, const Film& film);

}  // namespace petzval::core_detail
