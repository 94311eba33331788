// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// The intersection of a polygon and a disc, both centred on the y axis, with a new middle point. Each corner moves
/// along the line from the new middle to the old corner. Obscurations are ignored.
PupilPolygon clipped_by_disc(const PupilPolygon& polygon, double centre, double radius);

}  // namespace petzval::pupil_table_detail
