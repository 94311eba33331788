// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/film_bounds.hpp"
#include "core/loop_math.hpp"
#include "petzval/core/ray.hpp"

/// Steps of a camera sample before and after its ray is found, for loops and for single samples.
namespace petzval::camera_detail {

using core_detail::FilmBounds;

/// A point in a plane across the axis.
template <class V>
struct PlanePoint {
  V x, y;
};

// Local names: compiled for several instruction sets, which the linker must not mix.
namespace {

/// False for NaN.
template <class T>
inline bool on_film(const FilmBounds<T>& film, T x, T y) noexcept {
  const T dx = x - film.centre_x, dy = y - film.centre_y;
  return (dx <= film.half_width) & (-dx <= film.half_width) & (dy <= film.half_height) & (-dy <= film.half_height);
}

/// Weight of a pupil sample, and its density in solid angle at the film point.
template <class T>
struct PupilWeight {
  T depth2, per_depth;  ///< squared distance between film and pupil plane, and reciprocal distance

  explicit PupilWeight(T depth) noexcept : depth2(depth * depth), per_depth(T(1) / (depth < T(0) ? -depth : depth)) {}
  /// Squared distance between the film point and the position in the pupil.
  T length2(T film_x, T film_y, T pupil_x, T pupil_y) const noexcept {
    const T x = pupil_x - film_x, y = pupil_y - film_y;
    return x * x + y * y + depth2;
  }
  /// Density of uniform positions in the pupil.
  static T pdf_pupil(T area) noexcept { return limited(T(1) / area); }
  /// The weight cos / pdf_direction, with pdf_direction = pdf_pupil length^3 / depth.
  T weight(T length2, T area) const noexcept {
    const T factor = depth2 / length2 * per_depth;
    return area * factor * factor;
  }
  T pdf_direction(T length2, T pdf_pupil) const noexcept {
    return limited(length2 * core_detail::square_root(length2) * per_depth * pdf_pupil);
  }

 private:
  /// Keeps densities finite in float, even if the film nearly touches the lens.
  static T limited(T pdf) noexcept { return pdf < T(1e36) ? pdf : T(1e36); }
};

/// Fate of a sample: the fate of its ray if the sample has a ray.
inline RayFate fate_of(RayFate fate, bool kept, bool covered, bool seen) noexcept {
  fate = seen ? fate : RayFate::vignetted;
  fate = covered ? fate : RayFate::outside_spectrum;
  return kept ? fate : RayFate::outside_film;
}

/// The virtual point of a film point.
/// @param plane a TiltedPlane or its numbers in another type
template <class V, class Plane>
inline PlanePoint<V> virtual_of(const Plane& plane, const V& x, const V& y) noexcept {
  const V per_distance = 1 / ((1 + plane.travel) + (plane.depth_by_x * x + plane.depth_by_y * y));
  return {(plane.x_by_x * x + plane.x_by_y * y) * per_distance, plane.y_by_y * y * per_distance};
}

/// Distance of the upright film from the pupil plane divided by the distance of the film point, minus 1.
template <class V, class Plane>
inline V distance_excess(const Plane& plane, const V& virtual_x, const V& virtual_y) noexcept {
  return ((plane.slope_x * virtual_x + plane.slope_y * virtual_y) - plane.travel) / (1 + plane.travel);
}

/// Intersection with the upright film of the ray of a virtual point through a position in the pupil.
/// @param excess distance_excess() of the virtual point
template <class V>
inline PlanePoint<V> upright_of(const V& excess, const V& virtual_x, const V& virtual_y, const V& pupil_x,
                                const V& pupil_y) noexcept {
  return {virtual_x - excess * pupil_x, virtual_y - excess * pupil_y};
}

/// Weight of a film sample divided by the weight of the sample of an upright film with the same ray; zero or negative
/// if the ray meets the back of the film.
template <class V, class Plane>
inline V facing_of(const Plane& plane, V excess, V pupil_x, V pupil_y) noexcept {
  const V near = 1 + excess;
  const V front = (1 + plane.travel) - (plane.slope_x * pupil_x + plane.slope_y * pupil_y);
  return plane.cosine * front * near * near * near;
}

/// For a pinhole in front of a tilted film: the point of the upright film with the ray of a film point, divided by the
/// virtual point. Each film point has one ray, and the weights of the complete pupil. The ray passes the centre of the
/// exit pupil of the thick lens.
/// @param shift from ParaxialModel::pinhole_shifts()
template <class V>
inline V chief_scale(const V& excess, double shift) noexcept {
  return 1 / (1 + excess * shift);
}

}  // namespace
}  // namespace petzval::camera_detail
