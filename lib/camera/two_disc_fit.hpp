// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "pupil_table/film_pupil_table.hpp"

namespace petzval::camera_detail {

/// A point on the edge of a pupil, in the pupil plane, for the film point (0, field) (mm).
struct EdgePoint {
  double field = 0, x = 0, y = 0;
  double edge_weight = 0;  ///< length of the edge that it represents, divided by the pupil's area, 1/mm
};

/// Edge points of the pupils of some film points, which are equally spaced in film area; film points without light are
/// left out.
std::vector<EdgePoint> real_edges(const FilmPupilTable& pupils, std::size_t wavelength);

/// Error of the intersection of two discs: the area between its edge and the edges of the given pupils, divided by the
/// areas of the pupils.
double two_disc_error(std::span<const EdgePoint> edges, const std::array<PupilDisc, 2>& discs) noexcept;

/// Fits two discs whose intersection is closest to pupils that are symmetric about x = 0. Edge points of one film point
/// are consecutive; the axis and other film points are required.
std::array<PupilDisc, 2> fit_two_discs(std::span<const EdgePoint> edges);

}  // namespace petzval::camera_detail
