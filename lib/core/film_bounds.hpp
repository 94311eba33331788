// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>

#include "petzval/core/film.hpp"

namespace petzval::core_detail {

/// Rectangle of a film with its margin, in numbers of type T. The half widths are enlarged by the rounding error of T,
/// so that edge points that were rounded to T lie inside.
template <class T>
struct FilmBounds {
  T centre_x, centre_y, half_width, half_height;
};

template <class T>
FilmBounds<T> bounds_of(const Film& film) noexcept {
  constexpr double rounding = 2 * std::numeric_limits<T>::epsilon();
  const auto half = [&](double length, double shift) {
    const double whole = length + 2 * film.margin_mm;
    return whole / 2 + rounding * (std::abs(shift) + whole);
  };
  return {static_cast<T>(film.shift_x_mm), static_cast<T>(film.shift_y_mm),
          static_cast<T>(half(film.width_mm, film.shift_x_mm)), static_cast<T>(half(film.height_mm, film.shift_y_mm))};
}

}  // namespace petzval::core_detail
