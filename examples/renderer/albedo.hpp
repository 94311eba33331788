// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene_description.hpp"

namespace renderer {

/// The albedo at a point of a surface. point_world: mm; uv: texture coordinates of the point. Images are interpolated
/// linearly and repeated; pixel centres are at half integers. Values outside 0 to 1 are clipped, so that no surface
/// scatters more light than it receives.
Rgb at(const Albedo& albedo, const glm::vec3& point_world, const glm::vec2& uv);

/// The albedo or reflectance of a material at a point of a surface; 1 for glass.
Rgb reflectance(const Material& material, const glm::vec3& point_world, const glm::vec2& uv);

}  // namespace renderer
