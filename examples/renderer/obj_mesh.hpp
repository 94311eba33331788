// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Reads the faces of a Wavefront OBJ file into one mesh, mm; faces with more than three corners are triangulated. If
/// only some corners have a normal, the others get the normal of their triangle. Texture coordinates are ignored unless
/// all corners have them. Materials, lines and points are ignored.
///
/// @throws petzval::Error that names the file and, if known, the line: if the file cannot be read or has no face, a
///         number is not finite, an index is out of range, or a triangle has no area
Mesh read_obj(const std::filesystem::path& file);

}  // namespace renderer
