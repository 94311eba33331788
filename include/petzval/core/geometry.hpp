// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "petzval/core/export.hpp"
#include "petzval/core/version.hpp"

namespace petzval {

/// Two components, of a point in a plane across the axis unless said otherwise.
///
/// The qualifier of these vectors is spelled out on purpose: plain `glm::vec3` changes its size when a program defines
/// GLM_FORCE_DEFAULT_ALIGNED_GENTYPES, and a struct that holds one would then be read wrongly without a warning.
/// They convert from and to the `glm::vec3` and `glm::dvec3` of the caller.
template <class T>
using Vec2 = glm::vec<2, T, glm::packed_highp>;

/// Three components in the lens frame.
template <class T>
using Vec3 = glm::vec<3, T, glm::packed_highp>;

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

}  // namespace petzval
