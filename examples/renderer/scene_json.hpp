// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "renderer/scene_description.hpp"

namespace renderer {

/// Reads a scene from JSON. World: right-handed, y up, mm; colours: linear Rec. 709. All keys with their defaults; an
/// object has only one shape and one material:
///
///     {"sky": [0, 0, 0],                                     or "sky.exr": see Sky
///      "camera": {"position_mm": [0, 0, 0],                  see Pose
///                 "look_at_mm": [0, 0, -1],                  default: 1 mm in front of the position
///                 "up": [0, 1, 0]},
///      "objects": [
///        {"sphere": {"centre_mm": [0, 0, 0], "radius_mm": 1},
///         "quad": {"corner_mm": [0, 0, 0], "edge_u_mm": [1, 0, 0], "edge_v_mm": [0, 1, 0]},
///         "obj": "mesh.obj",                                 see read_obj
///         "material": {"diffuse": [0.5, 0.5, 0.5],           default material; or {"image": "wood.exr"}, or
///                                                            {"checker": [[0.5, 0.5, 0.5], [0, 0, 0]], "size_mm": 10}
///                      "mirror": [0.9, 0.9, 0.9],
///                      "rough": {"reflectance": [0.9, 0.9, 0.9], "roughness": 0.2},
///                      "glass": {"ior": 1.5, "roughness": 0},
///                      "varnish": {"diffuse": [0.5, 0.5, 0.5], "roughness": 0.1}},
///         "emission": [0, 0, 0]}]}
///
/// Paths are relative to the file of the scene; images are linear EXR files. A quad and a mesh emit from their front; a
/// sphere emits outward.
///
/// @throws petzval::Error that names the file and the value, such as objects[3].material.rough: for broken JSON,
///         unknown keys, numbers out of range, missing or broken files, meshes that read_obj does not accept, quads
///         without area and cameras that look at themselves or along their up
SceneDescription read_scene(const std::filesystem::path& file);

}  // namespace renderer
