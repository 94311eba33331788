// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/scene_description.hpp"

namespace lens_blur {

/// Their names, for messages.
inline constexpr std::string_view blur_scene_names = "town, statues, knot, leaves, street";

/// A scene to blur; nothing for another name. Of a vertical angle of 30 degrees, in focus at 5 m; statues and street
/// are those of the renderer.
std::optional<renderer::SceneDescription> blur_scene(std::string_view name);

/// A market town in daylight, 150,000 triangles: houses with windows and roofs along streets, trees, lamp posts, stalls
/// 2 m away.
renderer::SceneDescription town_scene();

/// A knot of a thick, knobbly tube with rings on it, 864,000 triangles, 1.8 to 7 m away, before a wall.
renderer::SceneDescription knot_scene();

/// 120,000 leaves on boughs 1.9 m to 10 m away, more than 12 surfaces behind each other in the mean.
renderer::SceneDescription leaves_scene();

}  // namespace lens_blur
