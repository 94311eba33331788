// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "pupil_table/film_pupil_table.hpp"

namespace petzval::pupil_table_detail {

/// A virtual film point of a tilted film, with the value of `excess` for one of its film points (see FilmTilt).
struct VirtualFilmPoint {
  FilmPoint at;
  double excess = 0;

  /// Intersection of the upright film with the ray from that film point through (x, y) in the pupil plane.
  FilmPoint on_upright(double x, double y) const noexcept { return {at.x - excess * x, at.y - excess * y}; }
};

/// Clearances, in the pupils of the upright film, of N rays through positions in the pupil plane.
/// @param from function; from(i) is the VirtualFilmPoint of ray i
template <class From>
void upright_clearances(const FilmPupilTable& upright, std::size_t wavelength, std::size_t count, const From& from,
                        const double* x, const double* y, double* clearances) {
  constexpr std::size_t block = 256;
  std::array<double, block> film_x, film_y;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t size = std::min(block, count - begin);
    for (std::size_t i = 0; i < size; ++i) {
      const FilmPoint film = from(begin + i).on_upright(x[begin + i], y[begin + i]);
      film_x[i] = film.x, film_y[i] = film.y;
    }
    upright.clearances(size, {film_x.data(), film_y.data(), x + begin, y + begin}, wavelength, clearances + begin);
  }
}

}  // namespace petzval::pupil_table_detail
