// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"

namespace petzval {

/// The shape of a stop: round, or a regular polygon of blades with straight or rounded edges.
///
///     petzval::Lens bladed = petzval::with_iris(lens, {.blades = 6, .roundness = 0.3});
///
/// The corners lie on the rim of the stop, where the round iris of the same f-number ends; with_f_number changes the
/// size and keeps the shape. So the iris passes the share iris_area(iris) / pi of the round one's light, and exposes at
/// N as that does at N sqrt(pi / iris_area(iris)). Photographers' f-numbers mean equal areas: equal_area_f_number.
struct Iris {
  int blades = 0;  ///< 3 to 20; 0: round
  /// The angle between the edge of a blade and the straight line from corner to corner, as a share of the rim's own. 0:
  /// straight; 1: the rim, so that the iris is round; below 0 the edges bend inwards; at -1 they are mirror images of
  /// the rim, or, of five blades and less, halve the angles of the straight polygon's corners.
  double roundness = 0;
  /// The first corner's angle from +y towards -x: anticlockwise where +x points right and +y up. Within 1e6.
  double rotation_rad = 0;

  bool round() const noexcept { return blades == 0 || roundness == 1; }
};

/// The area in squares of the stop's semi-diameter; pi for a round iris. Throws Error for blades, roundness or rotation
/// out of range.
PETZVAL_API double iris_area(const Iris& iris);

/// The f-number by its corners of an iris that passes as much light as a round one of f_number: f_number
/// sqrt(iris_area(iris) / pi). Throws Error as iris_area does, and for an f_number that is not a finite one above 0.
///
///     petzval::Lens lens = with_f_number(with_iris(wide_open, hexagon), petzval::equal_area_f_number(hexagon, 4));
PETZVAL_API double equal_area_f_number(const Iris& iris, double f_number);

}  // namespace petzval
