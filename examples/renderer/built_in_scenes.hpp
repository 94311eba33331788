// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Names of the scenes, for messages.
inline constexpr std::string_view built_in_scene_names = "balls, chess, statues, street, table";

/// A built-in scene; nullopt for an unknown name. Scenes are made for lenses of 100 mm (statues: 50 mm), a film of
/// 36 x 24 mm and exposures that map radiance 1 to 1.
std::optional<SceneDescription> built_in_scene(std::string_view name);

/// A row of glossy balls across the picture, each with one small highlight about 1000 mm from the front of the lens
/// (1050 mm from the entrance pupil), in dark surroundings: figure 8 of Wu et al. 2010, "Realistic rendering of bokeh
/// effect based on optical aberrations". From the centre to the edge the balls are at x = 0, 25, 50 ... 150 mm.
SceneDescription balls_scene();

/// A game of chess, 790 to 1110 mm from the entrance pupil, with lamps far behind: figure 9 of the same paper.
SceneDescription chess_scene();

/// Two angels 1.5 m and 6 m from the entrance pupil, to the left and right of a colonnade at dusk, with smaller figures
/// at 1.1 to 15 m, garlands, and lamps far behind: in the manner of figure 1 (d) of Lee, Eisemann, Seidel 2010,
/// "Real-time lens blur effects and focus control". The near angel extends from (-235, -235, -1500) to (-235, 235,
/// -1500) mm, the far angel from (930, -640, -6000) to (930, 1100, -6000). The globes of the lamps are large enough for
/// path tracing.
SceneDescription statues_scene();

/// A street at night: a sign 3 m from the entrance pupil to focus on, and small lights from there to 200 m.
SceneDescription street_scene();

/// A round table from above, 980 mm from the entrance pupil, with pawns and balls in rows, for tilted films; in the
/// dark behind it small lamps near all corners of the picture.
SceneDescription table_scene();

}  // namespace renderer
