// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/scene_description.hpp"

namespace renderer {

/// A scene as JSON; world right-handed, y up, mm; colours linear Rec. 709. All keys with their defaults, except that an
/// object names one shape and one material:
///
///     {"sky": [0, 0, 0],                                     or "sky.exr": see Sky
///      "camera": {"position_mm": [0, 0, 0],                  see Pose
///                 "look_at_mm": [0, 0, -1],                  by default 1 mm before the position
///                 "up": [0, 1, 0]},
///      "objects": [
///        {"sphere": {"centre_mm": [0, 0, 0], "radius_mm": 1},
///         "quad": {"corner_mm": [0, 0, 0], "edge_u_mm": [1, 0, 0], "edge_v_mm": [0, 1, 0]},
///         "obj": "mesh.obj",                                 see read_obj
///         "material": {"diffuse": [0.5, 0.5, 0.5],           or {"checker": [[0.5, 0.5, 0.5], [0, 0, 0]], "size_mm":
///         10},
///                                                            or {"image": "wood.exr"}; the default
///                      "mirror": [0.9, 0.9, 0.9],
///                      "rough": {"reflectance": [0.9, 0.9, 0.9], "roughness": 0.2},
///                      "glass": {"ior": 1.5, "roughness": 0},
///                      "varnish": {"diffuse": [0.5, 0.5, 0.5], "roughness": 0.1}},
///         "emission": [0, 0, 0]}]}
///
/// Files are relative to that of the scene; images are linear EXR files. A quad and a mesh emit from their front; a
/// sphere emits outward.
///
/// Throws petzval::Error with the file, the place, such as objects[3].material.rough, what was found and what was
/// wanted: broken JSON, unknown keys, numbers out of range, files that are missing or broken, meshes that read_obj
/// refuses, quads without area, a camera that looks at itself or along its up.
SceneDescription read_scene(const std::filesystem::path& file);

}  // namespace renderer
