// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "core/widest.hpp"
#include "petzval/lens/wavelength.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/iris_image_kernel.hpp"
#include "pupil_table/pupil_grid.hpp"

namespace petzval::pupil_table_detail {

/// Samples of the pupils of N film points, for a PupilGrid or an IrisImageTable.
template <class Grid>
struct FilmLoopsOf {
  using R = typename Grid::Number;
  using Lines = const R* const (&)[4];  ///< film x, film y, then u and v or pupil x and y
  void (*sample)(const Grid&, std::size_t, Lines, const RayWavelengths&, R* const (&x_y_area)[3]) noexcept;
  /// Pupil areas that samples at given positions represent; 0 if there is no such sample.
  void (*areas)(const Grid&, std::size_t, Lines, const RayWavelengths&, R* const (&areas)[1]) noexcept;
  /// Intersections with the stop, in semi-diameters, of rays through positions in the pupil plane; only for grids.
  void (*stop_points)(const Grid&, std::size_t, Lines, const RayWavelengths&, R* const (&x_y)[2]) noexcept;
};

/// Loops over film points, for each instruction set.
struct FilmLoops {
  std::tuple<FilmLoopsOf<PupilGrid<FilmRadius<float>, float>>, FilmLoopsOf<PupilGrid<FilmRadius<double>, double>>,
             FilmLoopsOf<PupilGrid<FilmQuadrant<float>, float>>, FilmLoopsOf<PupilGrid<FilmQuadrant<double>, double>>,
             FilmLoopsOf<IrisImageTable<float>>, FilmLoopsOf<IrisImageTable<double>>>
      loops;
  /// in_image() of one sample.
  PupilSample (*image_sample)(const IrisImageTable<double>&, const ImageSections<double>&, double film_x, double film_y,
                              double u, double v) noexcept;
  void (*find_nearest)(const lens_detail::NearestPosition&, std::size_t, const float* nm,
                       std::uint16_t* positions) noexcept;

  template <class Grid>
  const FilmLoopsOf<Grid>& of() const noexcept {
    return std::get<FilmLoopsOf<Grid>>(loops);
  }
};
PETZVAL_WIDEST(FilmLoops, film_loops)

}  // namespace petzval::pupil_table_detail
