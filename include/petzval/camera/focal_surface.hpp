// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// How values between points are interpolated. Both go through the points.
enum class SurfaceKind : std::uint8_t {
  affine,   ///< by planes: reproduces planes, has slopes at the points
  shepard,  ///< by constants: weighted means, flat at the points
};

/// "affine", "shepard".
PETZVAL_API std::string_view name(SurfaceKind kind) noexcept;

/// What an artist fixes at a place of the picture: the distance in focus, the extent of the depth of field, or both.
struct FocalPoint {
  FilmPoint place = {};  ///< mm; may lie outside the frame
  /// Of the object there, 1/mm, along the axis from the entrance pupil towards the scene; 0: infinity.
  std::optional<double> inverse_distance = {};
  /// Diameter that the blur of that object should have, signed as FocusTarget::blur_mm: the surface passes it by so
  /// much, by the paraxial pupil of the ideal lens. A camera's pupil is as bright as the real one: its blur is 4 %
  /// larger at f/1.8 and 14 % at f/1.1, for double Gauss lenses. For n pixels: n Film::pixel_mm().
  double blur_mm = 0;
  /// Of the depth of field, in stops: +2 as if stopped down by two stops, at the same exposure.
  std::optional<double> extent_stops = {};
  double weight = 1;  ///< 0 or more, against the other points
  double fade = 1;    ///< from 0 (gone) to 1
};

struct FocalSurfaceOptions {
  SurfaceKind kind = SurfaceKind::affine;
  double beta = 3;  ///< 1 to 8: weights fall with the distance in the picture to the power -beta
  /// In focus where no point fixes a distance, 1/mm from the entrance pupil; unset: what the ideal lens images to the
  /// film.
  std::optional<double> otherwise = {};
};

/// The distance in focus and the extent of the depth of field at every place of the picture, through focal points: what
/// no lens does, and artists ask for.
///
///     const IdealLens lens = thin_lens(50, 2);
///     const Film film{.z_mm = 51.2};
///     const std::vector<FocalPoint> points{{.place = {-9, 0}, .inverse_distance = 1 / 1500.0},
///                                          {.place = {9, 2}, .inverse_distance = 1 / 4000.0},
///                                          {.place = {0, -8}, .inverse_distance = 0, .extent_stops = 2}};
///     const FocalSurface surface(lens, film, points);
///     const double in_focus = surface.at({3, 1}).inverse_distance;
///
/// Moving least squares in inverse distance, so that infinity is a value, and in stops. At a place of the film, point i
/// weighs weight fade / d_i^beta, with d_i the distance on the film: results do not depend on the resolution of the
/// picture, on its aspect, or on a common factor of the weights. A point that counts in full is met exactly. One that
/// fades, or weighs less than a thousandth of what the heaviest one weighs, is passed at a growing distance, so that
/// it leaves without a jump. Extrapolated distances are limited to [least - m, most + m] of those of the points, with m
/// = most - least, to objects that the lens images, and to infinity, unless a blur leads beyond it (values below 0);
/// extents to those of the points.
///
/// Distances and extents go through the points that fix them, each with weights of its own. If no point fixes a
/// distance, that is FocalSurfaceOptions::otherwise; if none fixes an extent, that is 0.
/// Results are finite for every place, and the same for all instruction sets and however places are batched.
class PETZVAL_API FocalSurface {
 public:
  /// Copies. Moves copy too, so that no FocalSurface is ever empty.
  FocalSurface(const FocalSurface&) = default;
  FocalSurface& operator=(const FocalSurface&) = default;

  /// lens: the entrance pupil is the origin of distances; with the film it tells how large a blur comes of an error in
  /// inverse distance. film: its size tells how far points lie apart, in parts of the picture.
  ///
  /// Throws Error for points with numbers that are not finite, places beyond 1e6 sides of the picture, negative
  /// weights, fades outside [0, 1], extents beyond 20 stops, and objects that the lens does not image with a margin of
  /// 1e-3 focal lengths, or passed at such distances because of blur_mm; if no point has a weight; for beta outside [1,
  /// 8]; for an entrance pupil at infinity; and for a film without size or place. Points are numbered from 1.
  FocalSurface(const IdealLens& lens, const Film& film, std::span<const FocalPoint> points,
               const FocalSurfaceOptions& options = {});

  /// Whether a point fixes a distance. Otherwise a Camera keeps the focus of its film, and takes extents alone.
  bool fixes_distance() const noexcept;

  /// z of the entrance pupil, lens frame: distances count from here towards -z.
  double origin_z() const noexcept;

  struct Values {
    double inverse_distance = 0;  ///< 1/mm
    double extent_stops = 0;
    double blur_mm = 0;  ///< signed diameter that points ask for here: of an object at their own distances
  };
  Values at(const FilmPoint& place) const noexcept;

  /// With the derivatives by film x and y, 1/mm^2 and stops/mm. 0 where a limit holds.
  struct Slopes {
    Values values;
    Vec2<double> inverse_distance, extent_stops;
  };
  Slopes slopes(const FilmPoint& place) const noexcept;

  /// N places, float or double; inverse_distances, extents: N each, extents may be null. Floats are within 2e-4 of the
  /// range of values (nearest() less farthest()).
  template <class T>
  void at(std::size_t count, const T* film_x, const T* film_y, T* inverse_distances, T* extents) const noexcept;

  /// At the middles of all pixels of a film, row by row from the upper left one; columns x rows each, extents may be
  /// null. The same for any number of threads. Throws Error for fewer than 1 thread.
  template <class T>
  void frame(const Film& film, int threads, T* inverse_distances, T* extents) const;

  /// Limits of what at() gives: inverse distances, 1/mm, and extents, stops.
  double nearest() const noexcept;
  double farthest() const noexcept;
  double least_extent() const noexcept;
  double most_extent() const noexcept;

 private:
  struct Fields;
  std::shared_ptr<const Fields> fields_;
};

/// The focal points of a moment, to make a surface of; places are where chief rays meet the film, in the frame or not.
///
/// fades: of each point, whether it is valid at the moment or not, as FocusFades gives them; or none: 1 for points that
/// are valid, and others are left out. So are points without an image, those that a surface does not take (too near the
/// lens, or more than 1e6 sides of the picture beside it), and, if the moment has a film, those beside that.
/// nearer_weighs_more works as for focus_targets(). Throws Error as that and for another number of fades.
PETZVAL_API std::vector<FocalPoint> focal_points(const IdealLens& lens, const Film& film,
                                                 std::span<const FocusPoint> points, const FocusMoment& moment,
                                                 std::span<const double> fades = {});

/// Whether each point is valid at a moment, has an image and lies on the film: what FocusFades follows, with what the
/// renderer knows of hidden points. Throws Error as focus_targets().
PETZVAL_API std::vector<bool> points_in_view(const IdealLens& lens, const Film& film,
                                             std::span<const FocusPoint> points, const FocusMoment& moment);

/// Fades of points that leave the picture or are hidden, and come back: exponential in time, the same for any frame
/// rate.
///
///     FocusFades fades(0.2);
///     for (...) {
///       moment.time += 1 / 24.0;
///       fades.advance(1 / 24.0, points_in_view(lens, film, points, moment));
///       const auto seen = focal_points(lens, film, points, moment, fades.fades());
///       if (!seen.empty()) surface.emplace(lens, film, seen);  // else the last one stays
///     }
class PETZVAL_API FocusFades {
 public:
  /// After this time, 1 / e of the way is left; 0: no fading. Throws Error unless finite and 0 or more.
  explicit FocusFades(double time_constant_s);

  /// Goes on by a time, in which all points stay in view or out of it. A point that was not known before begins at 1 in
  /// view and at 0 out of it. Throws Error unless seconds >= 0.
  void advance(double seconds, const std::vector<bool>& in_view);
  const std::vector<double>& fades() const noexcept { return fades_; }

 private:
  double time_constant_;
  std::vector<double> fades_;
};

}  // namespace petzval
