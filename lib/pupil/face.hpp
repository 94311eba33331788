// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::pupil_detail {

/// Half height through which light enters an outer surface: its own, or where it is unlimited four times that of the
/// widest rim or pupil.
double half_height(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept;

/// An outer surface as a box around its clear part, lens frame, mm.
struct Face {
  double half = 0;  ///< half height
  double vertex_z = 0, z_min = 0, z_max = 0;
};

Face face_of(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept;

/// The last surface.
PETZVAL_API Face last_face(const Lens& lens);

}  // namespace petzval::pupil_detail
