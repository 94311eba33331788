// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/iris/iris.hpp"

namespace petzval::iris_detail {

/// The edge of one blade, in semi-diameters of the stop: within the rim, light passes where
/// x nx + y ny + bend (x^2 + y^2) <= distance.
/// That is a straight line or a circle; the left side grows at the rate 1 across it.
struct IrisEdge {
  double nx = 1, ny = 0, bend = 0, distance = 1;
};

/// Throws Error, which begins with `where`, for blades, roundness or rotation out of range.
PETZVAL_API void check(const Iris& iris, const std::string& where);

/// The edges from that behind the first corner on, from +y towards +x. None of a round iris.
PETZVAL_API std::vector<IrisEdge> edges(const Iris& iris);

/// The iris as an image shows it that is upside down along an axis, or along both.
PETZVAL_API Iris upside_down(Iris iris, bool along_x = true, bool along_y = true);

/// One edge of a bladed iris in a frame whose second axis points from the stop's centre to the edge's middle.
struct Blade {
  double half_angle = 0;  ///< of the sector
  double half_chord = 0;
  double middle = 0;     ///< distance of the edge's middle from the centre
  double curvature = 0;  ///< > 0 outwards

  explicit Blade(const Iris& iris);

  /// Twice the area between the middle of the edge, its point at `across` and the centre.
  double twice_area(double across) const noexcept;
  /// Where that is a part of the whole, 0 to 1.
  double across_at(double part) const noexcept;
  /// The second coordinate of a point of the edge.
  double along_at(double across) const noexcept;
};

}  // namespace petzval::iris_detail
