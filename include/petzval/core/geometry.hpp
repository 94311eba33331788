// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "petzval/core/config.hpp"

namespace petzval {

/// A vector of two components; by default a point in a plane perpendicular to the axis.
///
/// The qualifier is spelled out because plain `glm::vec3` changes its size if a program defines
/// GLM_FORCE_DEFAULT_ALIGNED_GENTYPES; program and library would then disagree about the layout of a struct without a
/// warning. Vec2 and Vec3 convert from and to the vectors of the caller, such as `glm::vec3` and `glm::dvec3`.
template <class T>
using Vec2 = glm::vec<2, T, glm::packed_highp>;

/// A vector of three components in the lens frame.
template <class T>
using Vec3 = glm::vec<3, T, glm::packed_highp>;

/// A plane: the points p with dot(normal, p) = offset. Lens frame, mm; the normal is a unit vector.
struct Plane {
  Vec3<double> normal{0, 0, 1};
  double offset = 0;
};

/// A line in space. Lens frame, mm.
struct Line3 {
  Vec3<double> point{0, 0, 0};      ///< the point of the line nearest to the axis
  Vec3<double> direction{1, 0, 0};  ///< unit vector; if perpendicular to the axis: x > 0, or x = 0 and y > 0
};

/// Intersects a plane with the plane perpendicular to the axis at z.
///
/// @param plane  the plane
/// @param z      position of the perpendicular plane on the axis (mm, lens frame)
/// @return       the common line; nullopt if both planes are parallel within rounding
PETZVAL_API std::optional<Line3> line_at(const Plane& plane, double z);

/// Wavelength of the helium d line, the usual reference of printed indices (nm).
inline constexpr double d_line_nm = 587.5618;

constexpr double radians(double degrees) noexcept { return degrees * (std::numbers::pi / 180.0); }
constexpr double degrees(double radians) noexcept { return radians * (180.0 / std::numbers::pi); }

}  // namespace petzval
