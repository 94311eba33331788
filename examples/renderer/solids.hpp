// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "renderer/scene_description.hpp"

/// Closed meshes from few numbers, mm. All have normals, outward.
namespace renderer {

/// A point of the outline of a turned body, and the curve from there to the next one.
struct ProfilePoint {
  float radius = 0, height = 0;
  /// Of the arc of a circle to the next point: its height over half its chord; > 0 bends outward, 1 is a semicircle, 0
  /// a straight line.
  float bulge = 0;
};

/// The body that an outline makes as it turns about the y axis. The outline goes from the lower end of the axis to the
/// upper one; where its direction jumps there is an edge, elsewhere the normals are those of the smooth body. Arcs are
/// cut into chords of at most 10 degrees. sides: 3 or more. Throws petzval::Error for a profile that does not begin and
/// end on the axis, or leaves to its other side.
Mesh lathe(std::span<const ProfilePoint> profile, int sides = 64);

/// An ellipse that a tube passes, square to the xy plane.
struct TubeStation {
  glm::vec2 left{0, 0}, right{0, 0};  ///< where it meets that plane, seen along the tube with z towards the viewer
  float half_z = 0;                   ///< half axis along z
};

/// A smooth body through the stations, 2 or more, closed by a point in the middle of the first and of the last.
Mesh tube(std::span<const TubeStation> stations, int sides = 32);

/// A box along the axes.
Mesh box(const glm::vec3& least, const glm::vec3& most);

/// The mesh turned about the y axis, counter-clockwise seen from above, then moved.
Mesh placed(Mesh mesh, const glm::vec3& by, float turn_deg = 0);

/// Both in one. Texture coordinates are left out.
void append(Mesh& mesh, const Mesh& other);

}  // namespace renderer
