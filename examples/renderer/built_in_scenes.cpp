// SPDX-License-Identifier: Apache-2.0
#include "renderer/built_in_scenes.hpp"

namespace renderer {

std::optional<SceneDescription> built_in_scene(std::string_view name) {
  if (name == "balls") return balls_scene();
  if (name == "chess") return chess_scene();
  if (name == "statues") return statues_scene();
  if (name == "street") return street_scene();
  if (name == "table") return table_scene();
  return {};
}

}  // namespace renderer
