// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "cli.hpp"
#include "files.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/io/camera_setup.hpp"

namespace examples {

/// Adds --kind and --beta, which need the option of the points or --setup.
void add_surface_kind(App& app, petzval::CameraSetup& setup, Option* points);

/// Maps a point of the world to the lens frame, mm.
using WorldToLens = std::function<petzval::Vec3<double>(const petzval::Vec3<double>&)>;

/// The surface through the points of a file {"points": [{"pixel": [x, y] or "world_mm": [x, y, z], "distance_mm",
/// "extent_stops", "blur_px", "weight", "fade"}]}. Pixels count from the upper left corner, with centres at halves.
/// distance_mm counts from the origin; null is infinity. Without distance_mm a point of the world has its own distance,
/// and a pixel fixes only the extent.
///
/// Sets focal_points and the distance without points in focal_surface.
///
/// @param camera  a camera of a first-order model without a focal surface, which projects points of the world
/// @throws petzval::Error that names the file, the point (from 1) and the key
petzval::FocalSurface read_focal_surface(const std::string& file, petzval::CameraSetup& setup,
                                         const petzval::Camera& camera, const WorldToLens& to_lens);
/// The same for the list of points of a file that is not read again; `file` names it in messages.
petzval::FocalSurface focal_surface_through(const Json& list, const std::string& file, petzval::CameraSetup& setup,
                                            const petzval::Camera& camera, const WorldToLens& to_lens);

}  // namespace examples
