// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"

namespace petzval {

/// The shape of a stop: round, or a regular polygon of blades with straight or rounded edges.
///
///     petzval::Lens bladed = petzval::with_iris(lens, {.blades = 6, .roundness = 0.3});
///
/// The corners lie on the rim of the stop. with_f_number() changes the size and keeps the shape, so that at the same
/// f-number the iris transmits the fraction iris_area(iris) / pi of the light of a round iris. Photographers' f-numbers
/// mean equal areas: see equal_area_f_number().
struct Iris {
  int blades = 0;  ///< 3 to 20; 0: round
  /// Angle between the edge of a blade and the chord from corner to corner, divided by the angle of the rim. 0:
  /// straight edges; 1: round; below 0: edges bend inwards; -1: edges are mirror images of the rim or, for at most five
  /// blades, halve the corner angles of the straight polygon.
  double roundness = 0;
  /// Angle of the first corner from +y towards -x, within 1e6: anticlockwise if +x points right and +y up.
  double rotation_rad = 0;

  bool round() const noexcept { return blades == 0 || roundness == 1; }
};

/// Area of an iris in units of the squared semi-diameter of the stop; pi for a round iris.
///
/// @throws Error if blades, roundness or rotation are out of range
PETZVAL_API double iris_area(const Iris& iris);

/// The f-number, for with_f_number(), at which an iris transmits as much light as a round iris at f_number: f_number *
/// sqrt(iris_area(iris) / pi).
///
/// @throws Error if iris_area() does, or f_number is not positive and finite
///
///
///     petzval::Lens lens = with_f_number(with_iris(wide_open, hexagon), petzval::equal_area_f_number(hexagon, 4));
PETZVAL_API double equal_area_f_number(const Iris& iris, double f_number);

}  // namespace petzval
