// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::inline v0 {

/// Height of a surface over the plane of its vertex, along z, at (x, y) from the axis, mm; NaN where the surface has no
/// point there: beyond the equator of a sphere or conic. Clear apertures are not looked at.
PETZVAL_API double sag(const Lens& lens, std::size_t surface, double x, double y) noexcept;

}  // namespace petzval::inline v0
