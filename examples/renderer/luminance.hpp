// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

namespace renderer {

/// Luminance of linear Rec. 709.
inline float luminance(const glm::vec3& rgb) noexcept { return 0.2126f * rgb.r + 0.7152f * rgb.g + 0.0722f * rgb.b; }

}  // namespace renderer
