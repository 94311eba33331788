// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pupil/pupil_boundary.hpp"

namespace petzval::pupil_detail {

/// Area of a region (mm^2) from the sum of its squared radii over all directions.
double area_of(const PupilRegion& region, double squared_radii) noexcept;

/// The region of exit_pupil_boundary() in angles at the film point: a direction at the angle t from the film normal has
/// the distance t from (0, 0). Unlike a plane, these coordinates include directions parallel to the film.
PupilRegion pupil_in_angles(const Lens& lens, const FilmPoint& point, Wavelength wavelength, std::size_t directions);

/// One direction of a region, simplified to an interval from the middle and one obscuration. If rays are blocked at the
/// middle, the obscuration is the blocked interval there, otherwise the widest gap between two spans.
struct Extent {
  double obscured_from = 0, obscured_to = 0;  ///< radii; equal if there is no obscuration
  double to = 0;                              ///< radius of the outermost point that passes
  RimPoint rim;                               ///< the outermost point
  bool lit = false;                           ///< true if the direction has a span

  /// Radius at which the first span begins; 0 if the middle passes.
  double from() const noexcept { return obscured_from > 0 ? 0 : obscured_to; }
};

/// The extents of all directions of a region.
std::vector<Extent> extents(const PupilRegion& region);

/// Keeps the spans that are connected with the span nearest to `position`. Spans of adjacent directions with
/// overlapping radii are connected, and so are all spans that begin at the middle.
void keep_connected(PupilRegion& region, const Vec2<double>& position);

/// Keeps the spans that overlap a span of another region with the same middle, half axes and directions.
void keep_within(PupilRegion& region, const PupilRegion& other);

}  // namespace petzval::pupil_detail
