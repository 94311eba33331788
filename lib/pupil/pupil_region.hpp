// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/pupil/pupil_boundary.hpp"

namespace petzval::pupil_detail {

/// The area of squared radii, summed over the directions of a region.
double area_of(const PupilRegion& region, double squared_radii) noexcept;

/// What passes along one direction of a region, as one interval from the middle with one obscuration: the part around
/// a dark middle, else the widest between two spans.
struct Extent {
  double obscured_from = 0, obscured_to = 0;  ///< radii; equal: nothing is obscured
  double to = 0;                              ///< radius of the outermost point that passes
  RimPoint rim;                               ///< that point
  bool lit = false;                           ///< something passes

  /// Radius at which light begins: 0 where the middle passes.
  double from() const noexcept { return obscured_from > 0 ? 0 : obscured_to; }
};

/// Of each direction.
std::vector<Extent> extents(const PupilRegion& region);

/// Leaves the spans that are connected with the one nearest to a place: spans of neighbouring directions whose radii
/// overlap, and spans that begin at the middle, are connected.
void keep_connected(PupilRegion& region, const Vec2<double>& place);

/// Keeps the spans that overlap a span of another region with the same middle, half axes and directions.
void keep_within(PupilRegion& region, const PupilRegion& other);

}  // namespace petzval::pupil_detail
