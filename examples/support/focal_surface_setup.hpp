// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cli.hpp"
#include "files.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/focus/focus.hpp"

namespace examples {

/// Command line of the programs with a focal surface.
struct FocalSurfaceSetup {
  std::string points_file;  ///< empty: none
  std::string kind = "affine";
  double beta = 3;
};

/// Adds --kind and --beta, which need the option of the points.
void add_surface_kind(App& app, FocalSurfaceSetup& setup, Option* points);

/// Maps a point of the world to the lens frame, mm.
using WorldToLens = std::function<petzval::Vec3<double>(const petzval::Vec3<double>&)>;

/// A surface with its points.
struct ReadSurface {
  std::vector<petzval::FocalPoint> points;
  petzval::FocalSurface surface;
};

/// The surface through the points of a file {"points": [{"pixel": [x, y] or "world_mm": [x, y, z], "distance_mm",
/// "extent_stops", "blur_px", "weight", "fade"}]}. Pixels count from the upper left corner, with centres at halves.
/// distance_mm counts from the origin; null is infinity. Without distance_mm a point of the world has its own distance,
/// and a pixel fixes only the extent.
///
/// @param camera  a camera of a first-order model without a focal surface, which projects points of the world
/// @throws petzval::Error that names the file, the point (from 1) and the key
ReadSurface read_focal_surface(const FocalSurfaceSetup& setup, const petzval::Camera& camera,
                               petzval::DistanceOrigin origin, double focus_mm, const WorldToLens& to_lens);
/// The same for the list of points of a file that is not read again; setup.points_file names it in messages.
ReadSurface focal_surface_through(const Json& list, const FocalSurfaceSetup& setup, const petzval::Camera& camera,
                                  petzval::DistanceOrigin origin, double focus_mm, const WorldToLens& to_lens);

}  // namespace examples
