// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Sag of a surface at (x, y), mm: the height along z over the plane of its vertex; NaN beyond the equator of a sphere
/// or conic. Clear apertures are ignored.
PETZVAL_API double sag(const Lens& lens, std::size_t surface, double x, double y) noexcept;

}  // namespace petzval::inline v0
