// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <type_traits>

#include "core/film_bounds.hpp"
#include "core/loop_math.hpp"
#include "petzval/core/ray.hpp"
#include "pupil_table/two_plane_rays.hpp"

/// Steps of a camera sample before and after its ray is found, over a scalar: numbers of loops, doubles of single
/// samples, and dual numbers for derivatives. A ray R is a Ray or a RayOf.
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

/// The ray of a line, from the pupil plane on.
/// @param depth, towards as TwoPlanes::depth() and towards_scene()
template <class T, class V>
inline RayOf<V> leaving(const TwoPlaneRayOf<V>& line, T pupil_z, T depth, T towards) noexcept {
  const V x = line.pupil_x - line.film_x, y = line.pupil_y - line.film_y;
  const V per_length = towards / core_detail::square_root(V(x * x + y * y + depth * depth));
  return {{line.pupil_x, line.pupil_y, V(pupil_z)}, {x * per_length, y * per_length, depth * per_length}};
}

/// The ray of a line in the plane z, by first-order maps.
/// @param maps SectionMaps or its numbers in another type
template <class Maps, class T, class V>
inline RayOf<V> mapped(const Maps& maps, T z, const TwoPlaneRayOf<V>& line) noexcept {
  const auto& [mx, my] = maps;
  const auto& [film_x, film_y, pupil_x, pupil_y] = line;
  const V ux = mx.c * film_x + mx.d * pupil_x, uy = my.c * film_y + my.d * pupil_y;
  const V down = T(-1) / core_detail::square_root(V(T(1) + ux * ux + uy * uy));
  return {{mx.a * film_x + mx.b * pupil_x, my.a * film_y + my.b * pupil_y, V(z)}, {ux * down, uy * down, down}};
}

/// Distance along a ray to the front. The ray travels towards the scene; coordinates are relative to the vertex of the
/// front.
///
/// A sphere of curvature c is c |p|^2 = 2 p_z. With b = d_z - c p.d and e = c |p|^2 - 2 p_z, the ray leaves a convex
/// sphere and meets a concave sphere at the distance
///     s = (b + sqrt(b^2 - c e)) / c = e / (b - sqrt(b^2 - c e)).
/// The second form also holds for planes. A ray that misses the sphere starts on the tangent plane at the vertex; a ray
/// that leaves neither starts at its point nearest to the vertex.
template <class T>
inline T distance_to_front(const T& curvature, const T& x, const T& y, const T& z, const T& dx, const T& dy,
                           const T& dz) noexcept {
  using std::sqrt;
  const T along = x * dx + y * dy + z * dz;
  const T e = curvature * (x * x + y * y + z * z) - T(2) * z;
  const T b = dz - curvature * along;
  const T square = b * b - curvature * e;
  const bool outward = b < T(0);
  const bool curved = curvature != T(0);
  const bool reaches = square > T(0);
  const bool meets = reaches & (outward | curved);
  const T root = sqrt(meets ? square : T(1));
  const T over = meets ? (outward ? e : T(b + root)) : T(-z);
  const T under = meets ? (outward ? T(b - root) : curvature) : dz;
  return (meets | (dz < T(0))) ? T(over / under) : T(-along);
}

/// Moves the origin of a ray along the ray to the front.
template <class T, class R>
inline void move_to_front(T vertex_z, T curvature, R& ray) noexcept {
  auto& [o, d] = ray;
  using V = std::remove_cvref_t<decltype(o.x)>;
  const V distance = distance_to_front(V(curvature), o.x, o.y, V(o.z - vertex_z), d.x, d.y, d.z);
  o.x += distance * d.x, o.y += distance * d.y, o.z += distance * d.z;
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

/// The ray of a virtual point through a position in the pupil, in terms of the upright film.
/// @param excess distance_excess() of the virtual point
template <class V>
inline TwoPlaneRayOf<V> upright_of(const V& excess, const V& virtual_x, const V& virtual_y, const V& pupil_x,
                                   const V& pupil_y) noexcept {
  return {virtual_x - excess * pupil_x, virtual_y - excess * pupil_y, pupil_x, pupil_y};
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
