// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "petzval/camera/camera.hpp"

namespace examples {

/// An include file of POV-Ray 3.7 with a mesh_camera that traces the rays of a camera: one mesh per sample, one
/// triangle per pixel.
///
/// The centroid of a triangle is the origin of a ray, its normal the direction. A mesh_camera has no weights: rays are
/// dropped in proportion to their weights, and dropped or lost rays start inside a black ball.
///
/// @param camera   camera with Normalisation::unity_on_axis
/// @param samples  rays per pixel
/// @throws petzval::Error if no ray passes the lens
///
/// Accuracy: positions within 0.5 pixels, diameters of blur within 2 % of `petzval render` (povray_test.cpp).
/// Limitations: POV-Ray 3.7 uses the triangles of the second row also for the first row of a picture.
std::string povray_camera(const petzval::Camera& camera, std::uint32_t samples);

}  // namespace examples
