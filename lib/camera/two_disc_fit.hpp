// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "petzval/pupil_table/film_pupil_table.hpp"

namespace petzval::camera_detail {

/// A point of a pupil's edge, in the plane of the pupil, of a film point at (0, field), mm.
struct EdgePoint {
  double field = 0, x = 0, y = 0;
  double share = 0;  ///< length of the edge that it represents, mm, over the pupil's area, mm^2
};

/// Edges of the pupils of some film points, at equal steps of film area; none where hardly any light comes.
std::vector<EdgePoint> real_edges(const FilmPupilTable& pupils, std::size_t wavelength);

/// The error of the intersection of two discs: the area between its edge and those of some pupils, over the areas of
/// the pupils.
double two_disc_error(std::span<const EdgePoint> edges, const std::array<PupilDisc, 2>& discs) noexcept;

/// The two discs whose intersection is nearest to pupils that are mirrored in x. The points of one film point's edge
/// are consecutive; the axis and other film points are needed.
std::array<PupilDisc, 2> fit_two_discs(std::span<const EdgePoint> edges);

}  // namespace petzval::camera_detail
