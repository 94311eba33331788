// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// Interpolation between focal points. Both kinds go through the points.
enum class SurfaceKind : std::uint8_t {
  affine,   ///< local planes: reproduces planes, has slopes at the points
  shepard,  ///< local constants (weighted means): flat at the points
};

/// "affine" or "shepard".
PETZVAL_API std::string_view name(SurfaceKind kind) noexcept;

/// The distance in focus, the extent of the depth of field, or both, fixed at one film point.
struct FocalPoint {
  FilmPoint film_point = {};  ///< mm; may lie outside the frame
  /// 1 / distance of the object, along the axis from the entrance pupil towards the scene (1/mm); 0: infinity.
  std::optional<double> inverse_distance = {};
  /// Blur diameter that the object shall have, with the sign of FocusTarget::blur_mm; n * Film::pixel_mm() for n
  /// pixels. It refers to the paraxial pupil of the ideal lens. The pupil of a camera has the exposure of the real one,
  /// so that its blur is larger: by 4 % at f/1.8 and 14 % at f/1.1 for double Gauss lenses.
  double blur_mm = 0;
  /// Extent of the depth of field in stops: +2 as if stopped down by two stops, at the same exposure.
  std::optional<double> extent_stops = {};
  double weight = 1;  ///< relative to the other points; at least 0
  double fade = 1;    ///< 0 (no influence) to 1
};

/// Options of FocalSurface.
struct FocalSurfaceOptions {
  SurfaceKind kind = SurfaceKind::affine;
  double beta = 3;  ///< 1 to 8: weights are distance^-beta, with the distance in the picture
  /// 1 / distance in focus if no point fixes a distance (1/mm, from the entrance pupil); unset: the plane that the
  /// ideal lens images to the film.
  std::optional<double> default_inverse_distance = {};
};

/// Distance in focus and extent of the depth of field at every film point, interpolated through focal points.
///
///     const IdealLens lens = thin_lens(50, 2);
///     const Film film{.z_mm = 51.2};
///     const std::vector<FocalPoint> points{{.film_point = {-9, 0}, .inverse_distance = 1 / 1500.0},
///                                          {.film_point = {9, 2}, .inverse_distance = 1 / 4000.0},
///                                          {.film_point = {0, -8}, .inverse_distance = 0, .extent_stops = 2}};
///     const FocalSurface surface(lens, film, points);
///     const double in_focus = surface.at({3, 1}).inverse_distance;
///
/// Moving least squares in inverse distance and in stops, with the weights weight * fade / distance^beta. Results are
/// finite at every film point, and independent of instruction sets and batches. Points with full weight are met
/// exactly; a point that fades leaves without a jump. If no point fixes an extent, it is 0. Inverse distances are
/// limited to [least - m, most + m], with m = most - least of the points; to objects that the lens images; and to
/// infinity, unless a blur leads beyond. Extents are limited to the range of the points.
class PETZVAL_API FocalSurface {
 public:
  /// Copies. Moves also copy, so that a FocalSurface is never empty.
  FocalSurface(const FocalSurface&) = default;
  FocalSurface& operator=(const FocalSurface&) = default;

  /// Fits a surface through focal points.
  ///
  /// @param lens     origin of the distances (entrance pupil), and blur per error of the inverse distance
  /// @param film     position, and size as the unit of distances between points
  /// @param points   focal points; messages number them from 1
  /// @param options  interpolation
  /// @throws Error   if a number is not finite, a point lies beyond 1e6 sides of the picture, a weight is negative, a
  ///                 fade is outside [0, 1], an extent is beyond 20 stops, or an object (with blur_mm: the focus there)
  ///                 is less than 1e-3 focal lengths in front of the front focal plane; if no point has a weight; if
  ///                 beta is outside [1, 8]; if the entrance pupil is at infinity; if the film has no size or no
  ///                 position
  FocalSurface(const IdealLens& lens, const Film& film, std::span<const FocalPoint> points,
               const FocalSurfaceOptions& options = {});

  /// True if a point fixes a distance. If false, a Camera keeps the focus of its film and uses the extents only.
  bool fixes_distance() const noexcept;

  /// z of the entrance pupil (lens frame, mm), from which distances count towards -z.
  double origin_z() const noexcept;

  struct Values {
    double inverse_distance = 0;  ///< 1/mm
    double extent_stops = 0;
    double blur_mm = 0;  ///< signed blur diameter here of an object at the points' own distances
  };
  Values at(const FilmPoint& film_point) const noexcept;

  /// Values and their derivatives by film x and y (1/mm^2 and stops/mm); 0 at a limit.
  struct Slopes {
    Values values;
    Vec2<double> inverse_distance, extent_stops;
  };
  Slopes slopes(const FilmPoint& film_point) const noexcept;

  /// Values at N film points, float or double; extents may be null. Floats are within 2e-4 * (nearest() - farthest()).
  template <class T>
  void at(std::size_t count, const T* film_x, const T* film_y, T* inverse_distances, T* extents) const noexcept;

  /// Values at the centres of all pixels of a film, row by row from the upper left pixel; columns * rows values each.
  ///
  /// @param film               columns, rows and size
  /// @param threads            at least 1; the result is the same for every number
  /// @param inverse_distances  result (1/mm)
  /// @param extents            result (stops), or null
  /// @throws Error             if threads is less than 1
  template <class T>
  void frame(const Film& film, int threads, T* inverse_distances, T* extents) const;

  /// Limits of the results of at(): inverse distances (1/mm) and extents (stops).
  double nearest() const noexcept;
  double farthest() const noexcept;
  double least_extent() const noexcept;
  double most_extent() const noexcept;

 private:
  struct Fields;
  std::shared_ptr<const Fields> fields_;
};

/// The focal points of one moment, at the film points of their chief rays, inside or outside the frame.
///
/// Left out are points with fade 0 and points without an image; points too near to the lens, or more than 1e6 sides of
/// the picture from the axis; and points outside moment.film, if the moment has a film.
///
/// @param lens    the ideal lens
/// @param film    the film of the surface
/// @param points  focus points over time
/// @param moment  time and options, as in focus_targets()
/// @param fades   one fade per point, for points that leave the picture and come back; empty: 1 for points valid at the
/// moment, 0 for others
/// @throws Error  if focus_targets() does, if the number of fades differs from the number of points, or if a fade is
///                outside [0, 1]
PETZVAL_API std::vector<FocalPoint> focal_points(const IdealLens& lens, const Film& film,
                                                 std::span<const FocusPoint> points, const FocusTime& moment,
                                                 std::span<const double> fades = {});

}  // namespace petzval
