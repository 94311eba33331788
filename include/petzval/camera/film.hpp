// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "petzval/pupil/field_point.hpp"

namespace petzval::inline v0 {

/// A rectangle of film where the lens has its film plane: perpendicular to the axis or leaning about the point on it.
/// Film points count from the axis along the film's own right and up (FilmPose has their places).
struct Film {
  double width_mm = 36, height_mm = 24;
  int columns = 3840, rows = 2560;
  double centre_x_mm = 0, centre_y_mm = 0;  ///< shift movements: where the rectangle's middle lies in the film plane
  double tilt_rad = 0, swing_rad = 0;       ///< its normal is Ry(swing) Rx(tilt) e_z

  bool tilted() const noexcept { return tilt_rad != 0 || swing_rad != 0; }
  double area_mm2() const noexcept { return width_mm * height_mm; }
  /// The side of a square as large as a pixel.
  double pixel_mm() const noexcept { return std::sqrt(area_mm2() / (static_cast<double>(columns) * rows)); }
  /// From the axis to the farthest corner.
  double radius_mm() const noexcept {
    return std::hypot(std::abs(centre_x_mm) + width_mm / 2, std::abs(centre_y_mm) + height_mm / 2);
  }
  /// Edges belong to the film, as point() rounds them.
  bool contains(const FilmPoint& point) const noexcept {
    return std::abs(point.x - centre_x_mm) <= half_width<double>() &&
           std::abs(point.y - centre_y_mm) <= half_height<double>();
  }
  /// From the middle to the edges, with room for those that were rounded to T.
  template <class T>
  double half_width() const noexcept {
    return width_mm / 2 + rounding<T> * (std::abs(centre_x_mm) + width_mm);
  }
  template <class T>
  double half_height() const noexcept {
    return height_mm / 2 + rounding<T> * (std::abs(centre_y_mm) + height_mm);
  }

  /// The film point behind a place of the picture, and back. Raster: (0, 0) the upper left corner of the upright
  /// picture, (columns, rows) the lower right one. The image on the film is upside down: what lies to the right in the
  /// scene (+x) meets the film on its -x side and the picture on the right, what lies above (+y) meets the film below
  /// and the picture at the top. This turn is made here and nowhere else.
  FilmPoint point(double column, double row) const noexcept {
    return {centre_x_mm + (0.5 - column / columns) * width_mm, centre_y_mm + (row / rows - 0.5) * height_mm};
  }
  std::array<double, 2> raster(const FilmPoint& point) const noexcept {
    return {(0.5 - (point.x - centre_x_mm) / width_mm) * columns, (0.5 + (point.y - centre_y_mm) / height_mm) * rows};
  }

 private:
  template <class T>
  static constexpr double rounding = 2 * std::numeric_limits<T>::epsilon();
};

}  // namespace petzval::inline v0
