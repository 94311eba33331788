// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

namespace petzval::inline v0 {

/// Three components in the lens frame.
///
/// The qualifier is spelled out on purpose: plain `glm::vec3` changes its size when a program defines
/// GLM_FORCE_DEFAULT_ALIGNED_GENTYPES, and a struct that holds one would then be read wrongly without a word.
/// Converts from and to the `glm::vec3` and `glm::dvec3` of the caller.
template <class T>
using Vec3 = glm::vec<3, T, glm::packed_highp>;

}  // namespace petzval::inline v0
