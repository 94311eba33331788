// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::inline v0::pupil_table_detail {

inline constexpr std::size_t film_strips = 64;         ///< between the heights of polygons
inline constexpr std::size_t region_directions = 128;  ///< of the regions that polygons are made of

/// The pupils of film points on +y at some heights, in the plane of the pupil: one for each height or, of a film that
/// has different points at one height, several of each, row by row.
using PupilsAt = std::function<std::vector<PupilRegion>(std::span<const double> heights)>;

/// Those of a lens of revolution, traced.
PupilsAt traced_pupils(const Lens& lens, const TwoPlanes& space, std::size_t wavelength);
/// Those of a tilted film, by virtual film points: of the farthest and nearest film points of each, and of three
/// between. upright: which lines pass.
PupilsAt tilted_film_pupils(const FilmPupilTable& upright, const FilmTilt& tilt, std::size_t wavelength);

/// The height up to which the film gets light, at most film_radius.
double lit_radius(double film_radius, const PupilsAt& pupils_at);

/// The pupils of film points on +y at 65 heights up to film_radius. enclosing: those of the points between are
/// contained in the interpolated ones.
std::vector<PupilPolygon> film_polygons(double film_radius, PolygonFit fit, const PupilsAt& pupils_at);

/// The overlap of some discs, for film points on +y at 65 heights.
std::vector<PupilPolygon> disc_polygons(std::span<const PupilDisc> discs, double film_radius);

}  // namespace petzval::inline v0::pupil_table_detail
