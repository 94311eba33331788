// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene_description.hpp"

namespace renderer {

enum class AngelPose {
  praying,  ///< hands together in front of the chest
  calling,  ///< the left arm raised, the right one on the heart
};

/// A winged statue that looks along +z, `height` mm from its foot at the origin to its crown. The wings are 0.76 of the
/// height wide. Curls, feathers and folds are some thousandths of the height in size.
Mesh angel(AngelPose pose, float height);

}  // namespace renderer
