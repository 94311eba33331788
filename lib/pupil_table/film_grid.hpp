// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "petzval/core/film.hpp"
#include "pupil_chart.hpp"

namespace petzval::pupil_table_detail {

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
};

/// Tests which film points rays reach at any wavelength.
using LitPoints = std::function<std::vector<bool>(const std::vector<FilmPoint>& points)>;

/// Grid from the axis to the last lit point.
/// @param strips number of steps between rows
FilmGrid radial_grid(const LitPoints& lit, double film_radius, std::size_t strips);
/// Grid over the lit part of a quadrant.
FilmGrid quadrant_grid(const LitPoints& lit, double film_radius);

}  // namespace petzval::pupil_table_detail
