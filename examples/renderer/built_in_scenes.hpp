// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Their names, for messages.
inline constexpr std::string_view built_in_scene_names = "balls, chess, street";

/// A scene that comes with the program; nothing for another name. They are made for lenses of 100 mm and a film of
/// 36 x 24 mm, and for exposures where radiance 1 gives 1.
std::optional<SceneDescription> built_in_scene(std::string_view name);

/// A row of glossy balls across the picture, each with one small highlight at about 1000 mm from the front of the lens
/// (1050 mm from the entrance pupil), in dark surroundings: figure 8 of Wu et al. 2010, "Realistic rendering of bokeh
/// effect based on optical aberrations". From the middle to the edge they are those of x = 0, 25, 50 ... 150 mm.
SceneDescription balls_scene();

/// A game of chess, 790 to 1110 mm from the entrance pupil, with lamps far behind: figure 9 there.
SceneDescription chess_scene();

/// A street at night: a sign at 3 m from the entrance pupil to focus on, and small lights from there to 200 m.
SceneDescription street_scene();

}  // namespace renderer
