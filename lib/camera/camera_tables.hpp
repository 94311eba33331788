// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"

namespace petzval {

/// The table of a camera for petzval/petzval_camera.h: one array of floats, in the layout of lib/docs/camera_table.md.
///
/// @param camera  a camera with exact rays or polynomials, an upright film and a pupil without weights
/// @throws Error  if the film is tilted or travels, if the camera has weights of the pupil, a focal surface or an
///                expressive lens, or if the model is of first order or custom
///
/// Limitations: the table of a polynomial has no scene side.
PETZVAL_API std::vector<float> camera_tables(const Camera& camera);

}  // namespace petzval
