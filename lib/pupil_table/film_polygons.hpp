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

namespace petzval::pupil_table_detail {

inline constexpr std::size_t region_directions = 128;  ///< of the regions that polygons are made of

/// Strips between the heights of polygons. Of equal area they are the film's light, where that ends too; what enclosing
/// ones hold beyond the pupils costs lost samples alone: 3 in 10,000 more than with 64 strips.
constexpr std::size_t film_strips(PolygonFit fit) noexcept { return fit == PolygonFit::enclosing ? 32 : 64; }

/// The pupils of film points on +y at some heights, in the plane of the pupil: one for each height or, of a film that
/// has different points at one height, several of each, row by row.
struct FilmPupils {
  std::function<std::vector<PupilRegion>(std::span<const double> heights)> at;
  std::function<std::vector<bool>(std::span<const double> heights)> lit;  ///< which of them have any light
};

/// Those of a lens of revolution, traced.
FilmPupils traced_pupils(const Lens& lens, const TwoPlanes& space, std::size_t wavelength);
/// Those of a tilted film, by virtual film points: of the farthest and nearest film points of each, and of three
/// between. upright: which lines pass.
FilmPupils tilted_film_pupils(const FilmPupilTable& upright, const FilmTilt& tilt, std::size_t wavelength);

/// The pupils of film points on +y at equal steps of the height, from the axis on.
struct FilmPolygons {
  double lit_radius = 0;  ///< the last height: up to there the film gets light at any of the wavelengths
  std::vector<std::vector<PupilPolygon>> by_wavelength;
};

/// Those of a film, from its pupils at each wavelength. enclosing: those of the points between are contained in the
/// interpolated ones. threads: they share the wavelengths.
FilmPolygons film_polygons(double film_radius, PolygonFit fit, std::span<const FilmPupils> pupils, int threads);

/// The overlap of some discs, as a pupil of equal area.
std::vector<PupilPolygon> disc_polygons(std::span<const PupilDisc> discs, double film_radius);

}  // namespace petzval::pupil_table_detail
