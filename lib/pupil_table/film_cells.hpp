// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "film_grid.hpp"
#include "film_pupil_table_loops.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::inline v0::pupil_table_detail {

/// Pupils over the two axes of a film, of a lens that is alike at x and -x and at y and -y: polygons at the nodes of a
/// FilmGrid, bilinear between them.
///
/// In the other quadrants u runs the other way round, from where it begins at the axis between them: samples of
/// neighbours are neighbours there too.
class FilmCells {
 public:
  FilmCells(const FilmGrid& grid, double film_radius, std::size_t primary);

  /// Adds a wavelength: the polygons of the nodes.
  void add(const std::vector<PupilPolygon>& polygons);

  double area(const FilmPoint& film, std::size_t wavelength) const noexcept;
  Vec2<double> middle(const FilmPoint& film, std::size_t wavelength) const noexcept;
  bool contains(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept;
  double clearance(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept;
  FilmPupilTable::Derivatives derivatives(const FilmPoint& film, double u, double v,
                                          std::size_t wavelength) const noexcept;

  template <class R>
  CellTable<R> table() const noexcept;
  void put(FilmPupilArrays& arrays) const;

 private:
  struct Place;
  Place find(const FilmPoint& film, std::size_t wavelength) const noexcept;

  FilmGrid grid_;
  double film_radius_;
  std::size_t primary_, wavelengths_ = 0;
  int corrections_ = 0;
  std::vector<std::vector<PupilPolygon>> polygons_;  // by wavelength
  std::vector<double> twice_;                        // cells by CellLayout
  std::vector<float> single_, half_widths_single_;
};

}  // namespace petzval::inline v0::pupil_table_detail
