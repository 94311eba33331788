// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/pupil/film_pupil_table.hpp"
#include "petzval/pupil/pupil_polygon.hpp"
#include "petzval/pupil/two_plane_rays.hpp"

namespace petzval::inline v0::pupil_detail {

inline constexpr std::size_t film_strips = 64;       ///< between the heights of stars
inline constexpr std::size_t edge_directions = 128;  ///< of the edges that stars are made of

/// The edges of the pupils of film points on +y at some heights: one for each or, of a film that has different points
/// at one height, several of each, row by row.
using EdgesAt = std::function<std::vector<PupilEdges>(std::span<const double> heights)>;

/// Those of a lens of revolution, traced.
EdgesAt traced_edges(const Lens& lens, const TwoPlanes& space, std::size_t wavelength);
/// Those of a film that leans, by keys: of the farthest and nearest points of each key, and of three between. upright:
/// which lines pass.
EdgesAt leaning_edges(const FilmPupilTable& upright, const FilmTilt& lean, std::size_t wavelength);

/// Up to where the film gets light: film_radius, or where it is dark at last.
double lit_radius(double film_radius, const EdgesAt& edges_at);

/// The pupils of film points on +y at 65 heights up to film_radius; `covering`: with what lies between contained, else
/// of their area.
std::vector<PupilPolygon> film_polygons(double film_radius, bool covering, const EdgesAt& edges_at);

/// One star that contains the pupils of all film points, for a lens without symmetry of revolution.
PupilPolygon star_for_all(const Lens& lens, const TwoPlanes& space, double film_radius, std::size_t wavelength);

/// What lies within all of some discs, for film points on +y at 65 heights.
std::vector<PupilPolygon> disc_stars(std::span<const PupilDisc> discs, double film_radius);

}  // namespace petzval::inline v0::pupil_detail
