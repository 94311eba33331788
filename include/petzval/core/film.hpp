// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "petzval/core/export.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// A point of the film, mm: counted from the axis along the film's own right and up, which for an upright film are +x
/// and +y of the lens frame.
struct FilmPoint {
  double x = 0, y = 0;
};

/// The rectangle that is exposed: its size, its pixels, and its place behind the lens.
///
/// The film crosses the axis at z_mm (where the lens has its film plane, if that is not set) and turns about that
/// point: its normal is Ry(swing) Rx(tilt) e_z (tilt about +x first). A shift moves the rectangle within that plane.
/// Where the film travels, its place is that when the shutter opens. Cameras and lint() take lengths up to 1e9 mm.
///
///     const Film film{.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280};
///     const Camera camera(lens, film);
///     const TiltFit fit = fit_tilt(thick_lens(lens), targets, {.film = film});
///     const Camera tilted(lens, fit.film);
struct PETZVAL_API Film {
  double width_mm = 36, height_mm = 24;
  int columns = 3840, rows = 2560;
  double shift_x_mm = 0, shift_y_mm = 0;  ///< film point in the middle of the rectangle
  /// Around the rectangle on all sides. Film points there see the scene too, for pixel filters that reach over the edge
  /// and for overscan: a filter of radius r pixels wants r * width_mm / columns. Size, area and raster are those of the
  /// rectangle: points of the margin have their raster outside the picture, and connections find them too.
  double margin_mm = 0;
  std::optional<double> z_mm = {};  ///< lens frame; unset: the lens's own film_z()
  double tilt_rad = 0, swing_rad = 0;
  double travel_mm = 0;  ///< along z while the shutter is open: a pull of focus

  /// The film at a part of the time that the shutter is open (0: it opens; 1: it closes; clamped, and not a number is
  /// 0), without travel. Throws Error where z_mm is not set.
  Film at(double time) const;

  bool tilted() const noexcept { return tilt_rad != 0 || swing_rad != 0; }
  double area_mm2() const noexcept { return width_mm * height_mm; }
  /// The side of a square of the area of a pixel.
  double pixel_mm() const noexcept;
  /// From the axis to the farthest corner of the margin.
  double radius_mm() const noexcept;
  /// Of the margin.
  std::array<FilmPoint, 4> corners() const noexcept;
  /// Within the margin. Edges belong to it, as point() rounds them.
  bool contains(const FilmPoint& point) const noexcept;

  /// The film point of a place in the picture, and back. Raster: (0, 0) is the upper left corner of the upright
  /// picture, (columns, rows) the lower right one. The image on the film is upside down: what lies to the right in the
  /// scene (+x) meets the film on its -x side and the picture on the right; what lies above (+y) meets the film below
  /// and the picture at the top. Pictures of PSFs, which have no film, are turned by render(Psf).
  FilmPoint point(double column, double row) const noexcept;
  Vec2<double> raster(const FilmPoint& point) const noexcept;
  /// The film points of many places, float or double. raster_x, raster_y, film_x, film_y: N each; outputs may be
  /// inputs.
  template <class T>
  void points(std::size_t count, const T* raster_x, const T* raster_y, T* film_x, T* film_y) const noexcept;

  /// The film's axes in the lens frame: what +x, +y and +z become.
  Vec3<double> right() const noexcept;
  Vec3<double> up() const noexcept;
  Vec3<double> normal() const noexcept;
  /// Between the film and the plane across the axis, 0 to pi.
  double angle() const noexcept;

  /// z_mm. It and what follows throw Error where z_mm is not set.
  double z() const;
  Plane plane() const;
  /// A film point in the lens frame, mm.
  Vec3<double> position(const FilmPoint& point) const;
  /// The film point at a position on the film; for one beside it, the foot of the perpendicular.
  FilmPoint point(const Vec3<double>& position) const;
};

/// The film laid into a plane: z_mm, tilt and swing are set, swing within a quarter turn, and upright if the plane
/// allows. Throws Error for a plane parallel to the axis and for numbers that are not finite.
PETZVAL_API Film film_in(const Plane& plane, const Film& film = {});

}  // namespace petzval
