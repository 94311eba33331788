// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// A straight edge of an iris in the plane of the stop: light passes where x nx + y ny <= distance.
struct IrisEdge {
  double nx = 1, ny = 0;  ///< unit normal, outwards
  double distance = 1;    ///< from the axis, in units of the stop's semi-diameter
};

/// The shape of a stop: light passes within every edge and within the stop's rim. Without edges the stop is round.
///
///     petzval::Lens bladed = petzval::with_iris(lens, petzval::regular_iris(6));
///
/// Distances follow the semi-diameter, so that with_f_number changes the size of the iris and keeps its shape.
struct Iris {
  std::vector<IrisEdge> edges;

  bool round() const noexcept { return edges.empty(); }
};

/// A regular polygon with its corners on the rim. The normal of the first edge has the angle turn_rad from +x towards
/// +y. Throws Error for fewer than 3 blades and an angle that is not finite.
PETZVAL_API Iris regular_iris(int blades, double turn_rad = 0);

}  // namespace petzval::inline v0
