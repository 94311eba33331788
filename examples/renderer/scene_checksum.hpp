// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Checksum of the visible properties of a scene, independent of its files and names.
std::string checksum(const SceneDescription& scene);

}  // namespace renderer
