// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace petzval::inline v0 {

/// One straight edge of an iris in the plane of the stop: light passes where x nx + y ny <= distance (mm).
struct IrisEdge {
  double nx = 1, ny = 0;
  double distance = 0;
};

/// A convex iris: light passes within every edge, and within the circle of the stop as ever. Plain data, borrowed from
/// the caller. No edges, or a lens without a stop: no iris.
using Iris = std::span<const IrisEdge>;

}  // namespace petzval::inline v0
