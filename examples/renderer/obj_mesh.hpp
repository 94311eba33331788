// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/scene_description.hpp"

namespace renderer {

/// The faces of a Wavefront OBJ file, all groups in one mesh, mm; faces of more than three corners are cut into
/// triangles. Corners without a normal get that of their triangle, unless no corner has one. Texture coordinates are
/// left out unless all corners have them, and so are materials, lines and points.
///
/// Throws petzval::Error that names the file, and the line for what can be told from it: a file that cannot be read or
/// has no face, numbers that are not finite, indices out of range, triangles without area.
Mesh read_obj(const std::filesystem::path& file);

}  // namespace renderer
