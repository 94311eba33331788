// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// A grid over the film of a lens that is alike at x and -x and at y and -y: over the quadrant x, y >= 0. Rows lie at
/// equal steps of y, the nodes of a row at equal steps of x, so that a pupil that moves as the film point does is
/// interpolated exactly.
struct FilmGrid {
  std::size_t columns = 0;          ///< between the nodes of a row
  double height = 0;                ///< y of the last row, mm
  std::vector<double> half_widths;  ///< x of the last node of each row, mm: two rows or more

  std::size_t rows() const noexcept { return half_widths.size() - 1; }  ///< between the rows of nodes
  std::size_t nodes() const noexcept { return half_widths.size() * (columns + 1); }
};

/// The grid over a disc about the axis.
FilmGrid disc_grid(double film_radius);
/// The grid over the part of a film that gets any light, at any wavelength.
FilmGrid film_grid(const Lens& lens, const TwoPlanes& space, double film_radius);

/// The pupils at the nodes of a grid, row by row, without obscurations. enclosing: those of the points between are
/// contained in the interpolated ones.
std::vector<PupilPolygon> grid_polygons(const Lens& lens, const TwoPlanes& space, const FilmGrid& grid, PolygonFit fit,
                                        std::size_t wavelength);

/// Those of a tilted film, by virtual film points: each contains the pupils of all places that a film point of it, or
/// of its mirror images, may have. upright: the table of a lens of this kind.
std::vector<PupilPolygon> tilted_grid_polygons(const FilmPupilTable& upright, const FilmTilt& tilt,
                                               const FilmGrid& grid, std::size_t wavelength);

}  // namespace petzval::pupil_table_detail
