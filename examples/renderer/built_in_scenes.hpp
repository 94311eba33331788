// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Their names, for messages.
inline constexpr std::string_view built_in_scene_names = "balls, chess, statues, street";

/// A scene that comes with the program; nothing for another name. They are made for lenses of 100 mm (statues: 50 mm)
/// and a film of 36 x 24 mm, and for exposures where radiance 1 gives 1.
std::optional<SceneDescription> built_in_scene(std::string_view name);

/// A row of glossy balls across the picture, each with one small highlight at about 1000 mm from the front of the lens
/// (1050 mm from the entrance pupil), in dark surroundings: figure 8 of Wu et al. 2010, "Realistic rendering of bokeh
/// effect based on optical aberrations". From the middle to the edge they are those of x = 0, 25, 50 ... 150 mm.
SceneDescription balls_scene();

/// A game of chess, 790 to 1110 mm from the entrance pupil, with lamps far behind: figure 9 there.
SceneDescription chess_scene();

/// Two angels far apart, 1.5 m and 6 m from the entrance pupil, on the left and on the right of a colonnade at dusk,
/// with smaller figures from 1.1 to 15 m between and beside them, garlands, and lamps far behind: in the manner of
/// figure 1 (d) of Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control". In mm, the near one
/// stands with its foot at (-235, -235, -1500) and its head at (-235, 235, -1500), the far one at (930, -640, -6000)
/// and (930, 1100, -6000). The globes of the lamps are large, so that path tracing finds them.
SceneDescription statues_scene();

/// A street at night: a sign at 3 m from the entrance pupil to focus on, and small lights from there to 200 m.
SceneDescription street_scene();

}  // namespace renderer
