// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "petzval/core/config.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval {

/// A point on the film, mm.
///
/// The coordinates are along Film::right() and Film::up(), from the point where the axis meets the film. For an upright
/// film they are x and y of the lens frame.
struct FilmPoint {
  double x = 0, y = 0;
};

/// The exposed rectangle: its size, its pixels, and its position behind the lens.
///
/// The film plane crosses the axis at z_mm and rotates about that point: its normal is Ry(swing) Rx(tilt) e_z, with the
/// tilt about +x first. A shift moves the rectangle within the film plane. If the film travels, z_mm is its position
/// when the shutter opens. Cameras and lint() accept lengths up to 1e9 mm.
///
///     const Film film{.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280};
///     const Camera camera(lens, film);
///     const TiltFit fit = fit_tilt(thick_lens(lens), targets, {.film = film});
///     const Camera tilted(lens, fit.film);
struct PETZVAL_API Film {
  double width_mm = 36, height_mm = 24;  ///< the default of every program; for one lens: default_film()
  int columns = 3840, rows = 2560;
  double shift_x_mm = 0, shift_y_mm = 0;  ///< film point at the centre of the rectangle
  /// Width of a margin around the rectangle, for overscan and for pixel filters that reach over the edge.
  ///
  /// A filter of radius r pixels needs r * width_mm / columns. Film points in the margin see the scene, and connections
  /// can end there. Size, area and raster refer to the rectangle; raster positions in the margin lie outside the image.
  double margin_mm = 0;
  std::optional<double> z_mm = {};  ///< position on the axis, lens frame; nullopt: Lens::film_z()
  double tilt_rad = 0, swing_rad = 0;
  double travel_mm = 0;  ///< along z while the shutter is open (focus pull)

  /// The film at one time of the exposure, without travel.
  ///
  /// @param time  0: the shutter opens; 1: it closes; clamped to this range, NaN counts as 0
  /// @throws Error if z_mm is not set
  Film at(double time) const;

  bool tilted() const noexcept { return tilt_rad != 0 || swing_rad != 0; }
  double area_mm2() const noexcept { return width_mm * height_mm; }
  /// Side of the square with the area of a pixel (mm).
  double pixel_mm() const noexcept;
  /// Distance from the axis to the farthest corner of the margin (mm).
  double radius_mm() const noexcept;
  /// The corners of the margin.
  std::array<FilmPoint, 4> corners() const noexcept;
  /// True if a film point lies within the margin. Edges count as inside, including the rounding of point().
  bool contains(const FilmPoint& point) const noexcept;

  /// Converts a raster position to a film point, and back.
  ///
  /// Raster (0, 0) is the upper left corner of the upright picture and (columns, rows) the lower right corner. The
  /// image on the film is rotated by 180 degrees: objects on the right in the scene (+x) are on the -x side of the film
  /// and on the right of the picture; objects above (+y) are on the -y side and at the top. PSFs have no film:
  /// render(Psf) rotates their pictures.
  FilmPoint point(double column, double row) const noexcept;
  Vec2<double> raster(const FilmPoint& point) const noexcept;
  /// Converts many raster positions to film points, in float or double. N values per array; outputs may be the inputs.
  template <class T>
  void points(std::size_t count, const T* raster_x, const T* raster_y, T* film_x, T* film_y) const noexcept;

  /// The film's axes in the lens frame: +x, +y and +z rotated by tilt and swing.
  Vec3<double> right() const noexcept;
  Vec3<double> up() const noexcept;
  Vec3<double> normal() const noexcept;
  /// Angle between the film plane and a plane perpendicular to the axis (radians, 0 to pi).
  double angle() const noexcept;

  /// The value of z_mm. This function and the functions below throw Error if z_mm is not set.
  double z() const;
  Plane plane() const;
  /// Position of a film point in the lens frame (mm).
  Vec3<double> position(const FilmPoint& point) const;
  /// The film point at a position (lens frame, mm); for a position outside the film plane, its perpendicular foot.
  FilmPoint point(const Vec3<double>& position) const;
};

/// Places a film in a plane: sets z_mm, tilt_rad and swing_rad.
///
/// @param plane  the plane (lens frame, mm)
/// @param film   the film that supplies all other values
/// @return       the film with abs(swing_rad) <= pi / 2; upright if the plane is perpendicular to the axis
/// @throws Error if the plane is parallel to the axis or has numbers that are not finite
PETZVAL_API Film film_in(const Plane& plane, const Film& film = {});

}  // namespace petzval
