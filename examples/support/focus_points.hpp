// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "camera_setup.hpp"
#include "cli.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/focus/autofocus.hpp"

namespace examples {

// All files of points have one format: section "Points and keys" of data/README.md. Errors name the file, the point
// (from 1) and the key.

/// Reads points in the lens frame, with the scene at negative z; at infinity the position is a direction.
std::vector<petzval::FocusTarget> read_targets(const std::string& file);
/// Maps a point of the world to the lens frame, mm.
using WorldToLens = std::function<petzval::Vec3<double>(const petzval::Vec3<double>&)>;

/// Reads points over time, in the lens frame. A point without keys does not move.
std::vector<petzval::FocusPoint> read_focus_points(const std::string& file,
                                                   const WorldToLens& to_lens = std::identity());

/// Reads distances over time for --focus. from: origin of the distances; empty: not given.
std::vector<FocusPull::Key> read_distances(const std::string& file, std::string& from);

/// The surface through the points of a file. Pixels count from the upper left corner, with centres at halves.
/// distance_mm counts from the origin. Without distance_mm a point of the world has its own distance, and a pixel fixes
/// only the extent. Sets focal_points and the distance without points in focal_surface.
///
/// @param camera  a camera of a first-order model without a focal surface, which projects points of the world
petzval::FocalSurface read_focal_surface(const std::string& file, petzval::CameraSetup& setup,
                                         const petzval::Camera& camera, const WorldToLens& to_lens);

/// The surface through the focal points of a set-up. file: of the points, for messages
petzval::FocalSurface focal_surface(const std::string& file, const petzval::IdealLens& lens, const petzval::Film& film,
                                    const petzval::CameraSetup& setup);

/// Adds --points for points_file, and --kind and --beta, which need --points or --setup. Returns --points.
Option* add_focal_surface(App& app, CameraFlags& flags, const std::string& help);

}  // namespace examples
