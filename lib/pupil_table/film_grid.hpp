// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "petzval/lens/lens.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::pupil_table_detail {

/// A grid over the quadrant x, y >= 0 of a film, for lenses that are symmetric about x = 0 and y = 0. Rows are equally
/// spaced in y, and the nodes of a row in x, so that interpolation is exact for a pupil that moves in proportion to the
/// film point.
struct FilmGrid {
  std::size_t columns = 0;          ///< steps between the nodes of a row
  double height = 0;                ///< y of the last row, mm
  std::vector<double> half_widths;  ///< x of the last node of each row, mm; at least two rows

  std::size_t rows() const noexcept { return half_widths.size() - 1; }  ///< steps between rows of nodes
  std::size_t nodes() const noexcept { return half_widths.size() * (columns + 1); }
};

/// Grid over a disc about the axis.
FilmGrid disc_grid(double film_radius);
/// Grid over the part of a film that rays reach at any wavelength.
FilmGrid film_grid(const Lens& lens, const TwoPlanes& space, double film_radius);

/// Pupils at the nodes of a grid, row by row, without obscurations. With PolygonFit::enclosing the interpolated pupils
/// contain the pupils of the points between nodes.
std::vector<PupilPolygon> grid_polygons(const Lens& lens, const TwoPlanes& space, const FilmGrid& grid, PolygonFit fit,
                                        std::size_t wavelength);

/// Pupils of a tilted film, for each virtual film point. A pupil contains the pupils of all possible positions of the
/// film point and of its mirror images.
/// @param upright the table of a lens with two mirror symmetries
std::vector<PupilPolygon> tilted_grid_polygons(const FilmPupilTable& upright, const FilmTilt& tilt,
                                               const FilmGrid& grid, std::size_t wavelength);

}  // namespace petzval::pupil_table_detail
