// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/pupils.hpp"

namespace petzval::inline v0::pupil_detail {

/// Half height of what an outer surface lets in: its own, or where it is unlimited four times the widest rim or pupil.
double half_height(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept;

/// An outer surface as a box around its clear part: half height, lowest and highest z of the lens frame.
struct Face {
  double half = 0, z_min = 0, z_max = 0;
};

Face face_of(const Lens& lens, std::size_t surface, const Pupil& entrance) noexcept;

}  // namespace petzval::inline v0::pupil_detail
