// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/vec.hpp"

namespace petzval::inline v0 {

/// The points p with normal . p = offset; unit normal. Lens frame, mm.
struct Plane {
  Vec3<double> normal{0, 0, 1};
  double offset = 0;
};

/// A line in space; unit direction.
struct SpaceLine {
  Vec3<double> point{0, 0, 0};      ///< of the line the point nearest to the axis
  Vec3<double> direction{1, 0, 0};  ///< x >= 0 (x = 0: y > 0) of lines across the axis
};

/// Where a plane meets the plane across the axis at z. Nothing where both are parallel within rounding.
PETZVAL_API std::optional<SpaceLine> line_at(const Plane& plane, double z);

}  // namespace petzval::inline v0
