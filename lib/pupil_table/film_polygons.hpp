// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::pupil_table_detail {

inline constexpr std::size_t region_directions = 128;  ///< directions of the regions from which polygons are made

/// Number of strips between the heights of polygons. Polygons of equal area define the irradiance, up to the edge of
/// the lit film. Enclosing polygons may be coarser: they lose 3 samples in 10,000 more than with 64 strips.
constexpr std::size_t film_strips(PolygonFit fit) noexcept { return fit == PolygonFit::enclosing ? 32 : 64; }

/// Pupils, in the pupil plane, of film points on +y at some heights: one pupil per height or, if a film has different
/// points at one height, several pupils per height, row by row.
struct FilmPupils {
  std::function<std::vector<PupilRegion>(std::span<const double> heights)> at;
  std::function<std::vector<bool>(std::span<const double> heights)> lit;  ///< true for each lit height
};

/// Traced pupils of a lens of revolution.
FilmPupils traced_pupils(const Lens& lens, const TwoPlanes& space, std::size_t wavelength);
/// Pupils of a tilted film by virtual film point: for the farthest and the nearest film point of each virtual point,
/// and for three between.
/// @param upright table that tells which rays pass
FilmPupils tilted_film_pupils(const FilmPupilTable& upright, const FilmTilt& tilt, std::size_t wavelength);

/// Pupils of film points on +y at equal steps of the height, from the axis on.
struct FilmPolygons {
  double lit_radius = 0;  ///< the last height; at larger heights no ray of any wavelength reaches the film
  std::vector<std::vector<PupilPolygon>> by_wavelength;
};

/// Makes the polygons of a film from its pupils at each wavelength. With PolygonFit::enclosing the interpolated pupils
/// contain the pupils between heights. Wavelengths are distributed over `threads` threads.
FilmPolygons film_polygons(double film_radius, PolygonFit fit, std::span<const FilmPupils> pupils, int threads);

/// The overlap of some discs, as polygons of equal area.
std::vector<PupilPolygon> disc_polygons(std::span<const PupilDisc> discs, double film_radius);

}  // namespace petzval::pupil_table_detail
