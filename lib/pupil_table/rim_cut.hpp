// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/geometry.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// What a disc leaves of a polygon whose middle lies at middle.y along a unit vector, as the centre of the disc does at
/// `centre`; the new middle too. Corners stay on the ways to those of the polygon. Obscurations are left out.
PupilPolygon cut_by_disc(const PupilPolygon& polygon, const Vec2<double>& towards, double centre, double radius);

}  // namespace petzval::pupil_table_detail
