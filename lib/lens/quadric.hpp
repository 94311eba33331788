// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/kernel_vec.hpp"
#include "core/scalar.hpp"

namespace petzval::kernel {

/// Plane, sphere, conic or cylinder: c (ax x^2 + ay y^2 + e z^2) = 2 z in the vertex frame, e = 1 + k. With the
/// curvature c instead of the radius, a plane needs no special case, and R = 1e12 loses no digits.
template <class R>
struct Quadric {
  R curvature = 0;
  R e = 1;             ///< one plus the conic constant
  R ax = 1, ay = 1;    ///< 0 in the section in which a cylinder is straight
  bool sphere = true;  ///< sphere or plane: ax = ay = e = 1
  bool cylinder = false;
  bool steep_conic = false;  ///< |k| > 10, for which the tangent plane is the better start
};

/// @param curved_x, curved_y true if the section is curved; a cylinder has one straight section
template <class R>
Quadric<R> make_quadric(double curvature, double conic, bool curved_x = true, bool curved_y = true) noexcept {
  const bool cylinder = !(curved_x && curved_y);
  return {
      static_cast<R>(curvature), static_cast<R>(1 + conic), R(curved_x), R(curved_y), conic == 0 && !cylinder, cylinder,
      conic > 10 || conic < -10};
}

/// Scalar product in the metric of the quadric (ax, ay, e); the Euclidean product for a sphere.
template <class T>
T product(const Quadric<Storage<T>>& q, const Vec<T>& u, const Vec<T>& v) noexcept {
  if (q.sphere) return dot(u, v);
  return q.ax * u.x * v.x + q.ay * u.y * v.y + q.e * u.z * v.z;
}

/// Result of an intersection: the point in the vertex frame, if `hit` is true.
template <class T>
struct Hit {
  Vec<T> point;
  Mask<T> hit;
  T slant;  ///< gradient times direction, in the sense of travel: the cosine of incidence if the gradient has length 1
};

/// Half the gradient of the quadric's equation at a point of it, +z at the vertex; of unit length on a sphere.
template <class T>
Vec<T> gradient(const Quadric<Storage<T>>& q, const Vec<T>& point) noexcept {
  using R = Storage<T>;
  const R c = q.curvature;
  return {T(-c * q.ax * point.x), T(-c * q.ay * point.y), T(R(1) - c * q.e * point.z)};
}

/// A point of the ray near the surface, from which the quadratic loses no digits: the point nearest to the vertex (for
/// a cylinder, nearest to its axis) or, for a steep conic, the point in the vertex plane.
template <class T>
Vec<T> approach(const Quadric<Storage<T>>& q, const Vec<T>& p, const Vec<T>& d) noexcept {
  using R = Storage<T>;
  T step = -dot(p, d);
  if (q.sphere) return p + d * step;
  if (q.cylinder) {
    const T across = q.ax * d.x * d.x + q.ay * d.y * d.y + d.z * d.z;
    const auto usable = across > R(0);
    step = -(q.ax * p.x * d.x + q.ay * p.y * d.y + p.z * d.z);
    step = select(usable, quotient(step, select(usable, across, T(1))), T(0));
  }
  if (q.steep_conic) {
    const auto upright = absolute(d.z) > R(0.3);
    step = select(upright, quotient(T(-p.z), select(upright, d.z, T(1))), step);
  }
  return p + d * step;
}

/// Intersects a ray with the vertex sheet of a quadric.
///
/// The root is chosen by `sense`, not by the sign of d.z: in a fisheye, rays towards the film may have d.z < 0. The
/// distance may be negative, because neighbouring surfaces may overlap and a ray may start behind the surface. There is
/// no hit if there is no real root, or if the root lies on the far side of the sphere or on the second sheet of the
/// hyperboloid; the returned point is then the start.
/// @param start, d a point of the ray and its unit direction, vertex frame
/// @param sense +1 if light travels towards +z in the unfolded lens, otherwise -1
///
/// Accuracy: |error| cos(incidence) <= 4 eps (height + distance slope), 1.3 at worst in tests/lens. Proven in a
/// narrower domain (`sh tests/run.sh -R Certified`): 10 eps (height + distance) on spheres for height <= 0.6 radii,
/// rays within 30 degrees of the axis and a distance <= height; 16 eps on conics with 0 <= 1 + k <= 2 for height <= 0.5
/// radii and rays within 23 degrees.
template <class T>
Hit<T> intersect(const Quadric<Storage<T>>& q, const Vec<T>& start, const Vec<T>& d, Storage<T> sense) noexcept {
  using R = Storage<T>;
  using std::sqrt;
  const Vec<T> p = approach(q, start, d);
  const R c = q.curvature;
  const T a = c * product(q, d, d);
  const T b = d.z - c * product(q, p, d);
  const T f = c * product(q, p, p) - R(2) * p.z;
  const T root = sqrt(T(b * b - a * f));

  // One root of a t^2 - 2 b t + f in two forms: s f / (s b + root) if s b > 0; otherwise, for rays beyond 90 degrees,
  // (s b - root) / (s a). If there is no root, t is NaN and fails every comparison.
  const T sb = sense * b;
  const auto near_form = sb >= R(0);
  const T t = quotient(select(near_form, T(sense * f), T(sb - root)), select(near_form, T(sb + root), T(sense * a)));
  const Vec<T> point = p + d * t;
  const auto on_vertex_sheet = R(1) - c * q.e * point.z > R(0);
  const auto near = absolute(t) < std::numeric_limits<R>::max() / R(4);
  const Mask<T> hit = all_of(near, on_vertex_sheet);
  return {select(hit, point, start), hit, root};
}

/// Unit normal at a point of the quadric, pointing to +z at the vertex.
template <class T>
Vec<T> normal(const Quadric<Storage<T>>& q, const Vec<T>& point) noexcept {
  using R = Storage<T>;
  using std::sqrt;
  const Vec<T> n = gradient(q, point);
  return q.sphere ? n : n * T(R(1) / sqrt(dot(n, n)));
}

}  // namespace petzval::kernel
