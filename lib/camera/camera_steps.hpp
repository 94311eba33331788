// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/film_bounds.hpp"
#include "core/loop_math.hpp"
#include "petzval/core/ray.hpp"

/// What a camera does to one sample before and after its ray is found, for loops over many and for a single one.
namespace petzval::camera_detail {

using core_detail::FilmBounds;

// Local names: this is compiled for several instruction sets, and the linker must not take one for another.
namespace {

/// False for what is not a number.
template <class T>
inline bool on_film(const FilmBounds<T>& film, T x, T y) noexcept {
  const T dx = x - film.centre_x, dy = y - film.centre_y;
  return (dx <= film.half_width) & (-dx <= film.half_width) & (dy <= film.half_height) & (-dy <= film.half_height);
}

/// The weight of a sample of a pupil, and its density in solid angle at the film point.
template <class T>
struct PupilWeight {
  T depth2, per_depth;  ///< square of the distance between the planes, and one over the distance

  explicit PupilWeight(T depth) noexcept : depth2(depth * depth), per_depth(T(1) / (depth < T(0) ? -depth : depth)) {}
  /// Square of the distance between the film point and the place in the pupil.
  T length2(T film_x, T film_y, T pupil_x, T pupil_y) const noexcept {
    const T x = pupil_x - film_x, y = pupil_y - film_y;
    return x * x + y * y + depth2;
  }
  /// Of places in the pupil, uniform.
  static T pdf_pupil(T area) noexcept { return limited(T(1) / area); }
  /// cos / pdf_direction, pdf_direction = pdf_pupil length^3 / depth.
  T weight(T length2, T area) const noexcept {
    const T part = depth2 / length2 * per_depth;
    return area * part * part;
  }
  T pdf_direction(T length2, T pdf_pupil) const noexcept {
    return limited(length2 * core_detail::square_root(length2) * per_depth * pdf_pupil);
  }

 private:
  /// Densities of float stay numbers, those of a film that all but touches a lens too.
  static T limited(T pdf) noexcept { return pdf < T(1e36) ? pdf : T(1e36); }
};

/// The fate of a sample: of its ray, unless it has none.
inline RayFate fate_of(RayFate fate, bool kept, bool wanted, bool seen) noexcept {
  fate = seen ? fate : RayFate::vignetted;
  fate = wanted ? fate : RayFate::outside_spectrum;
  return kept ? fate : RayFate::outside_film;
}

template <class T>
struct PlanePoint {
  T x, y;
};

/// The virtual point of a film point, on a film that lies as `plane`, a TiltedPlane or its numbers in T.
template <class T, class Plane>
inline PlanePoint<T> virtual_of(const Plane& plane, T x, T y) noexcept {
  const T per_distance = T(1) / ((T(1) + plane.travel) + (plane.depth_by_x * x + plane.depth_by_y * y));
  return {(plane.x_by_x * x + plane.x_by_y * y) * per_distance, plane.y_by_y * y * per_distance};
}

/// By how much the upright film's distance from the pupil's plane is larger than that of the film point, in parts of
/// the latter.
template <class T, class Plane>
inline T nearer_by(const Plane& plane, T virtual_x, T virtual_y) noexcept {
  return ((plane.slope_x * virtual_x + plane.slope_y * virtual_y) - plane.travel) / (T(1) + plane.travel);
}

/// Where the ray of a virtual point through a place in the pupil meets the upright film.
template <class T, class Plane>
inline PlanePoint<T> upright_of(const Plane& plane, T virtual_x, T virtual_y, T pupil_x, T pupil_y) noexcept {
  const T nearer = nearer_by(plane, virtual_x, virtual_y);
  return {virtual_x - nearer * pupil_x, virtual_y - nearer * pupil_y};
}

/// The weight of the film's sample over that of the upright film's sample with the same ray; not positive: it meets the
/// film's back.
template <class T, class Plane>
inline T facing_of(const Plane& plane, T virtual_x, T virtual_y, T pupil_x, T pupil_y) noexcept {
  const T near = T(1) + nearer_by(plane, virtual_x, virtual_y);
  const T front = (T(1) + plane.travel) - (plane.slope_x * pupil_x + plane.slope_y * pupil_y);
  return plane.cosine * front * near * near * near;
}

}  // namespace
}  // namespace petzval::camera_detail
