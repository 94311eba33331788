// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/scene_description.hpp"

namespace lens_blur {

/// Names of the scenes, for messages.
inline constexpr std::string_view blur_scene_names = "town, miniature, lights, statues, knot, leaves, street";

/// A scene to blur; nullopt for an unknown name. Its vertical field of view is 30 degrees and it is in focus at 5 m,
/// except for "miniature" and "lights".
/// "statues" and "street" are the scenes of the renderer.
std::optional<renderer::SceneDescription> blur_scene(std::string_view name);

/// A market town in daylight, 150,000 triangles: streets of houses with windows and roofs, trees, lamp posts, and a
/// stall 2 m away.
renderer::SceneDescription town_scene();

/// The town from above, in strong colours: like a model if only a strip 12 m away is in focus.
renderer::SceneDescription miniature_scene();

/// Lights behind a statue at night, in all directions of a picture of 22 degrees: cat's eyes, halos and fringes.
/// The statue is 3 m away.
renderer::SceneDescription lights_scene();

/// A knot of a thick, knobbly tube with rings, 864,000 triangles, 1.8 to 7 m away, in front of a wall.
renderer::SceneDescription knot_scene();

/// 120,000 leaves on boughs 1.9 m to 10 m away, on average more than 12 surfaces behind each other.
renderer::SceneDescription leaves_scene();

}  // namespace lens_blur
