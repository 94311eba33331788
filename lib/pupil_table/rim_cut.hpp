// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// What a disc leaves of a polygon, both with their centres on the y axis; the new middle too. Corners stay on the ways
/// to those of the polygon. Obscurations are left out.
PupilPolygon cut_by_disc(const PupilPolygon& polygon, double centre, double radius);

}  // namespace petzval::pupil_table_detail
