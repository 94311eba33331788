// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bladed_polygons.hpp"
#include "film_grid.hpp"
#include "film_pupil_table_loops.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "pupil_table/pupil_polygon.hpp"

namespace petzval::pupil_table_detail {

/// Rows or strips per mm of a film. A film smaller than 1e-30 mm counts as one of the axis alone, so that this is
/// finite in float too.
inline double steps_per_mm(std::size_t steps, double mm) noexcept {
  constexpr double smallest = 1e-30;
  return mm > smallest ? static_cast<double>(steps) / mm : 0;
}

/// Pupils over two coordinates of a film, bilinear between polygons at the nodes of a grid: over its two axes, of a
/// lens that is alike at x and -x and at y and -y; or over the distance from the axis and the azimuth, of a lens of
/// revolution with a bladed iris.
///
/// In the other quadrants u runs the other way round, from where it begins at the axis between them: samples of
/// neighbours are neighbours there too. So it does with the other blades, where u begins at the first corner of the
/// iris.
class FilmCells {
 public:
  FilmCells(const FilmGrid& grid, double film_radius, std::size_t primary);
  FilmCells(const BladedGrid& grid, std::size_t primary);

  /// Adds a wavelength: the polygons of the nodes.
  void add(const std::vector<PupilPolygon>& polygons);

  double area(const FilmPoint& film, std::size_t wavelength) const noexcept;
  Vec2<double> middle(const FilmPoint& film, std::size_t wavelength) const noexcept;
  bool contains(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept;
  /// sector: as clearance_of_place().
  double clearance(const FilmPoint& film, double x, double y, std::size_t wavelength,
                   std::size_t& sector) const noexcept;
  Vec2<double> position(const FilmPoint& film, double x, double y, std::size_t wavelength) const noexcept;
  FilmPupilTable::Derivatives derivatives(const FilmPoint& film, double u, double v,
                                          std::size_t wavelength) const noexcept;

  bool bladed() const noexcept { return corners_ > 0; }
  /// The polygon at a node, as add() took it, without obscurations.
  PupilPolygon node(std::size_t wavelength, std::size_t i) const noexcept;
  template <class R>
  CellTable<R> table() const noexcept;
  template <class R>
  BladedTable<R> bladed_table() const noexcept;
  void put(FilmPupilArrays& arrays) const;

 private:
  struct Place;
  Place find(const FilmPoint& film, std::size_t wavelength) const noexcept;
  Place find_bladed(const FilmPoint& film, std::size_t wavelength) const noexcept;
  FilmPupilTable::Derivatives bladed_derivatives(const Place& at, const FilmPoint& film, double u,
                                                 double v) const noexcept;

  FilmGrid grid_;
  double film_radius_;
  std::size_t primary_, rows_, columns_, wavelengths_ = 0;
  std::size_t corners_ = 0;  // of polygons of a bladed iris
  double blades_ = 0, first_blade_ = 0;
  int corrections_ = 0;
  std::vector<double> twice_, folds_;  // cells by CellLayout
  std::vector<float> single_, folds_single_, half_widths_single_;
};

}  // namespace petzval::pupil_table_detail
