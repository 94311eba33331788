// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::pupil_detail {

/// Half height of an outer surface through which light enters: its semi-diameter or, if it has no rim, the
/// largest semi-diameter of any rim or pupil.
double half_height(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept;

/// An outer surface of the lens as a bounding box of its clear part, lens frame, mm.
struct SurfaceBox {
  double half = 0;  ///< half height
  double vertex_z = 0, z_min = 0, z_max = 0;
};

/// @param entrance sets the size of a surface without a rim, see half_height()
SurfaceBox surface_box(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept;

/// Face of the last surface.
PETZVAL_API SurfaceBox last_surface_box(const Lens& lens);

}  // namespace petzval::pupil_detail
