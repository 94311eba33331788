// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "petzval/core/version.hpp"

namespace petzval::inline v0 {

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

}  // namespace petzval::inline v0
