// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "renderer/scene_description.hpp"

namespace renderer {

/// The same for scenes that look the same, whatever files they came from; names do not count.
std::string checksum(const SceneDescription& scene);

}  // namespace renderer
