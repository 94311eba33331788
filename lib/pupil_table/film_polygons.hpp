// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil_chart.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::pupil_table_detail {

/// Number of strips between the heights of polygons. Polygons of equal area define the irradiance, up to the edge of
/// the lit film. Enclosing polygons may be coarser: they lose 3 samples in 10,000 more than with 64 strips.
constexpr std::size_t film_strips(PolygonFit fit) noexcept { return fit == PolygonFit::enclosing ? 32 : 64; }

/// A grid of film points. For a lens of revolution, points on +y. For a lens that is symmetric about x = 0 and y = 0,
/// points of the quadrant x, y >= 0: rows are equally spaced in y, and the nodes of a row in x, so that interpolation
/// is exact for a pupil that moves in proportion to the film point.
struct FilmGrid {
  std::size_t columns = 0;          ///< steps between the nodes of a row; 0 for a lens of revolution
  double height = 0;                ///< y of the last row, mm
  std::vector<double> half_widths;  ///< x of the last node of each row, mm; at least two rows

  std::size_t rows() const noexcept { return half_widths.size() - 1; }  ///< steps between rows of nodes
  Lattice nodes() const noexcept { return {{0, rows(), columns}}; }
  FilmPoint point(const ChartPoint& at) const noexcept;
  FilmPoint node(std::size_t index) const noexcept { return point(nodes().point(index)); }
};

/// Grid of points on +y.
/// @param strips number of steps between rows
inline FilmGrid radial_grid(double height, std::size_t strips) {
  return {0, height, std::vector<double>(strips + 1, 0)};
}

/// The pupils of a film in the pupil plane, which film_polygons() searches.
struct FilmPupils {
  struct Point {
    FilmPoint film;
    double layer = 0;  ///< in [0, 1]: which of the pupils of this film point
  };
  using Points = std::span<const Point>;

  bool of_revolution = true;  ///< false for a lens that is symmetric about x = 0 and about y = 0
  std::size_t layers = 1;     ///< number of pupils searched at each film point; a polygon contains all of them
  std::size_t wavelengths = 0;
  std::function<std::vector<pupil_detail::PupilGuess>(Points, std::size_t wavelength)> guesses{};
  std::function<pupil_detail::PositionClearances(Points, std::size_t wavelength)> clearances{};
  std::function<pupil_detail::ConnectedPupils(Points, std::size_t wavelength)> connected{};  ///< PupilChart::connected
};

/// Pupils at the nodes of a grid.
struct FilmPolygons {
  FilmGrid grid;
  std::vector<std::vector<PupilPolygon>> by_wavelength;
};

/// Makes the polygons of a film; wavelengths are distributed over `threads` threads.
FilmPolygons film_polygons(const FilmPupils& pupils, double film_radius, PolygonFit fit, int threads);

/// Traced pupils of a lens with a round stop.
FilmPolygons traced_polygons(const Lens& lens, const TwoPlanes& space, double film_radius, PolygonFit fit, int threads);

/// Pupils of a tilted film, for each virtual film point: a polygon contains the pupils of all possible positions of the
/// film point and, for a lens with two sections, of its mirror images.
/// @param upright table that tells which rays pass
FilmPolygons tilted_polygons(const FilmPupilTable& upright, bool of_revolution, const FilmTilt& tilt, int threads);

/// The overlap of the discs of each wavelength, as polygons of equal area.
FilmPolygons disc_polygons(std::span<const std::vector<PupilDisc>> discs, double film_radius);

/// The intersection of a polygon and a disc, both centred on the y axis, with a new middle point. Each corner moves
/// along the line from the new middle to the old corner. Obscurations are ignored.
PupilPolygon clipped_by_disc(const PupilPolygon& polygon, double centre, double radius);

}  // namespace petzval::pupil_table_detail
