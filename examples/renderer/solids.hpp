// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "renderer/scene_description.hpp"

/// Closed meshes from few parameters, mm. All have outward normals.
namespace renderer {

/// A point of the outline of a solid of revolution, and the curve from it to the next point.
struct ProfilePoint {
  float radius = 0, height = 0;
  /// Height of the circular arc to the next point divided by half its chord: > 0 bends outward, 1 is a semicircle, 0 a
  /// straight line.
  float bulge = 0;
};

/// The solid of revolution of an outline about the y axis. The outline goes from the lower end of the axis to the upper
/// end. Corners of the outline are edges of the solid; elsewhere it has smooth normals. Arcs are divided into chords of
/// at most 10 degrees.
///
/// @param sides  number of sides, 3 or more
/// @throws petzval::Error if the outline does not begin and end on the axis, or crosses the axis
Mesh lathe(std::span<const ProfilePoint> profile, int sides = 64);

/// An ellipse across a tube, perpendicular to the xy plane.
struct TubeStation {
  glm::vec2 left{0, 0}, right{0, 0};  ///< its points in the xy plane, seen along the tube with z up
  float half_z = 0;                   ///< half axis along z
};

/// A smooth tube through 2 or more stations, closed by a point in the centre of the first and of the last station.
Mesh tube(std::span<const TubeStation> stations, int sides = 32);

/// An axis-aligned box.
Mesh box(const glm::vec3& least, const glm::vec3& most);

/// The mesh rotated about the y axis, counter-clockwise seen from above, then moved.
Mesh placed(Mesh mesh, const glm::vec3& by, float turn_deg = 0);

/// Appends a mesh. Texture coordinates are discarded.
void append(Mesh& mesh, const Mesh& other);

}  // namespace renderer
