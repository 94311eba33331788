// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Equal for scenes that look the same, independent of their files and names.
std::string checksum(const SceneDescription& scene);

}  // namespace renderer
