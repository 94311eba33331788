// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene_description.hpp"

namespace renderer {

/// The albedo at a point of a surface. point_world: mm; uv: texture coordinates there. Pixels of an image are
/// interpolated linearly, across its edges too; their centres lie at half integers. Values of an image outside 0 to 1
/// are clipped: no surface scatters back more light than it gets.
Rgb at(const Albedo& albedo, const glm::vec3& point_world, const glm::vec2& uv);

}  // namespace renderer
