// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderer/scene_description.hpp"

namespace renderer {

enum class AngelPose {
  praying,  ///< hands together before the chest
  calling,  ///< the left arm raised, the right one on the heart
};

/// A winged statue, `height` mm from its foot in the middle of the plane y = 0 to its crown; it looks along +z. The
/// wings are 0.76 of the height wide. Its details are some thousandths of the height: curls, feathers, folds.
Mesh angel(AngelPose pose, float height);

}  // namespace renderer
