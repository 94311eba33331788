// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval::iris_detail {

/// The edge of one blade, a straight line or a circle, in semi-diameters of the stop. Light passes inside the rim if
///     x nx + y ny + bend (x^2 + y^2) <= distance.
/// The left side grows at the rate 1 across the edge.
struct IrisEdge {
  double nx = 1, ny = 0, bend = 0, distance = 1;
};

/// Throws Error, prefixed with `where`, if blades, roundness or rotation are out of range.
PETZVAL_API void check(const Iris& iris, const std::string& where);

/// The edges of all blades in order from +y towards +x, starting behind the first corner. Empty for a round iris.
PETZVAL_API std::vector<IrisEdge> edges(const Iris& iris);

/// The iris as it appears in an image that is mirrored along x, along y, or along both.
PETZVAL_API Iris upside_down(Iris iris, bool along_x = true, bool along_y = true);

/// One edge of a bladed iris in a frame whose second axis points from the stop's centre to the edge's middle.
struct Blade {
  double half_angle = 0;  ///< half the angle of the sector
  double half_chord = 0;
  double middle = 0;     ///< distance from the centre to the middle of the edge
  double curvature = 0;  ///< positive if the edge bends outwards

  explicit Blade(const Iris& iris);

  /// Twice the area bounded by the centre, the middle of the edge and the edge point at `across`.
  double twice_area(double across) const noexcept;
  /// The inverse: the coordinate at which twice_area() is the fraction `edge_fraction` of its largest value, 0 to 1.
  double across_at(double edge_fraction) const noexcept;
  /// Second coordinate of the edge point at `across`.
  double along_at(double across) const noexcept;
};

}  // namespace petzval::iris_detail
