// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "surface/quadric.hpp"

namespace petzval::inline v0::kernel {

/// Highest order of an aspheric term.
inline constexpr int max_asphere_order = 40;

/// A quadric with a polynomial in r added to its sag, r measured across the curved section.
///
/// The polynomial is stored over rho = r / height with coefficients a_i height^i: raw coefficients such as 1e-41 mm^-13
/// are denormal in float, and r^16 overflows it outside about 10^(+-2.4) mm.
template <class R>
struct Asphere {
  Quadric<R> base;
  R height = 1;  ///< half height to which it is described: the clear one, or as far as it is not steep
  int even_count = 0, odd_count = 0;
  std::array<R, max_asphere_order / 2> even{};  ///< of rho^2, rho^4, ...
  std::array<R, max_asphere_order / 2> odd{};   ///< of rho^3, rho^5, ...
  R lowest = 0, highest = 0;                    ///< bounds of the sag within the height
  R steepest = 0;                               ///< bound of |dz/dr| there
};

/// Sag and slope of an asphere at a squared distance from the axis: z = sag, dz/dx = ax x slope, dz/dy = ay y slope.
template <class T>
struct Sag {
  T z, slope;
  Mask<T> defined;  ///< false beyond the equator of the base conic
};

template <class T>
Sag<T> sag(const Asphere<Storage<T>>& s, const T& r2) noexcept {
  using R = Storage<T>;
  const R c = s.base.curvature;
  const T inside = R(1) - s.base.e * c * c * r2;
  const auto defined = inside > R(0);
  const T root = safe_sqrt(inside);
  // z = c r2 / (1 + root) and slope = c / root by one division.
  const T sum = R(1) + root;
  const T share = quotient(T(c), select(defined, T(root * sum), sum));
  const T conic_sag = share * (r2 * root);
  const T conic_slope = share * sum;

  const R per_height_squared = R(1) / (s.height * s.height);
  const T u = r2 * per_height_squared;  // rho^2
  T even(R(0)), even_derivative(R(0));
  for (int i = s.even_count - 1; i >= 0; --i) {
    even_derivative = even_derivative * u + even;
    even = even * u + T(s.even[i]);
  }
  even_derivative = even_derivative * u + even;  // d(u even) / du
  even = even * u;

  T odd(R(0)), odd_slope(R(0));
  if (s.odd_count > 0) {
    T q(R(0)), q_derivative(R(0));
    for (int i = s.odd_count - 1; i >= 0; --i) {
      q_derivative = q_derivative * u + q;
      q = q * u + T(s.odd[i]);
    }
    const T rho = safe_sqrt(u);
    odd = u * rho * q;
    odd_slope = rho * (R(1.5) * q + u * q_derivative);  // d(rho^3 q) / du
  }
  return {conic_sag + even + odd, conic_slope + R(2) * per_height_squared * (even_derivative + odd_slope), defined};
}

/// Answer of the asphere's iteration: hit, none, or not found.
template <class T>
struct AsphereHit {
  Vec<T> point;
  bool hit;
  bool converged;
  bool beside = false;  ///< no hit, because the ray passes outside the height to which the surface is described
};

namespace surface_detail {

/// Signed height of a point of the ray above the surface, and its rate along the ray.
template <class T>
struct Clearance {
  T value, rate;
  Mask<T> defined;
};

template <class T>
Clearance<T> clearance(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d, const T& t) noexcept {
  const Vec<T> q = p + d * t;
  const T x = s.base.ax * q.x, y = s.base.ay * q.y;
  const auto [z, slope, defined] = sag(s, T(x * x + y * y));
  const Mask<T> usable = all_of(defined, finite(z), finite(slope));
  return {q.z - z, d.z - slope * (x * d.x + y * d.y), usable};
}

template <class T>
struct Span {
  T from, to;
};

/// Squared length of a direction across the axis, in the sections in which the surface is curved.
template <class T>
T across(const Asphere<Storage<T>>& s, const Vec<T>& d) noexcept {
  return s.base.ax * d.x * d.x + s.base.ay * d.y * d.y;
}

/// The part of a ray within the slab of the sag and the cylinder of the clear aperture, as distances along it.
template <class T>
Span<T> segment(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d) noexcept {
  using R = Storage<T>;
  const R far = std::numeric_limits<R>::max() / R(4);
  Span<T> span{T(-far), T(far)};
  if (any(absolute(d.z) > R(0))) {
    const T a = quotient(T(s.lowest - p.z), d.z), b = quotient(T(s.highest - p.z), d.z);
    span = {select(a < b, a, b), select(a < b, b, a)};
  }
  const T lx = s.base.ax * d.x, ly = s.base.ay * d.y, px = s.base.ax * p.x, py = s.base.ay * p.y;
  const T l2 = across(s, d);
  if (any(l2 > R(0))) {
    const T middle = quotient(T(-(px * lx + py * ly)), l2);
    const T qx = px + middle * lx, qy = py + middle * ly;
    const T half = safe_sqrt(quotient(T(s.height * s.height - qx * qx - qy * qy), l2));
    if (any(middle - half > span.from)) span.from = middle - half;
    if (any(middle + half < span.to)) span.to = middle + half;
  }
  return span;
}

/// Whether a ray crosses nothing within the clear aperture: it stays outside its cylinder, or within that above or
/// below the sag; of a ray too upright to cross the surface twice it is enough to see both ends on one side of the
/// edge.
template <class T>
bool passes_beside(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d, bool upright) noexcept {
  using R = Storage<T>;
  const R edge2 = s.height * s.height;
  const T px = s.base.ax * p.x, py = s.base.ay * p.y, l2 = across(s, d);
  const auto slanting = l2 > R(0);
  const T middle = select(slanting, quotient(T(-(px * d.x + py * d.y)), select(slanting, l2, T(1))), T(0));
  const T qx = px + middle * s.base.ax * d.x, qy = py + middle * s.base.ay * d.y;
  const T within2 = edge2 - qx * qx - qy * qy;
  const T half = safe_sqrt(quotient(within2, l2));
  const T one = p.z + (middle - half) * d.z, other = p.z + (middle + half) * d.z;
  const T edge = sag(s, T(edge2)).z;
  const T lowest = upright ? edge : T(s.lowest), highest = upright ? edge : T(s.highest);
  const R unsure = R(64) * std::numeric_limits<R>::epsilon() * s.height;  // left to the search
  return any(within2 < -unsure * s.height) || (any(one > highest + unsure) && any(other > highest + unsure)) ||
         (any(one < lowest - unsure) && any(other < lowest - unsure));
}

/// The crossing between two places on either side of the surface: Newton, with a bisection where it leaves the bracket
/// and at every third step, so that the bracket ends even where rounding keeps Newton from it.
template <class T>
AsphereHit<T> refine(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d, Storage<T> sense,
                     Span<T> bracket) noexcept {
  using R = Storage<T>;
  constexpr R eps = std::numeric_limits<R>::epsilon();
  auto [low, high] = bracket;
  T t = low + (high - low) * R(0.5);
  for (int i = 0; i < 200; ++i) {
    const auto f = clearance(s, p, d, t);
    if (!f.defined) break;
    (f.value * sense < R(0) ? low : high) = t;
    const T next = t - quotient(f.value, f.rate);
    const bool inside = next >= low && next <= high;
    const T scale = s.height + absolute(t);
    if (absolute(f.value) <= R(4) * eps * scale || !(high - low > R(4) * eps * scale)) {
      return {p + d * (inside ? next : t), true, true};
    }
    t = inside && i % 3 != 2 ? next : low + (high - low) * R(0.5);
  }
  return {p, false, false};
}

/// Newton from the hit on the base conic. usable: it ended where the surface is crossed in the sense of travel.
template <class T>
struct Candidate {
  Vec<T> point;
  bool usable = false;
};

/// base: that hit; p: a point of the ray.
template <class T>
Candidate<T> newton(const Asphere<Storage<T>>& s, const Hit<T>& base, const Vec<T>& p, const Vec<T>& d,
                    Storage<T> sense) noexcept {
  using R = Storage<T>;
  constexpr R eps = std::numeric_limits<R>::epsilon();
  T t(R(0));
  if (base.hit) {
    t = dot(base.point - p, d);
  } else if (any(absolute(d.z) > R(0.1))) {
    t = quotient(T(-p.z), d.z);
  }
  const T offset = absolute(p.x) + absolute(p.y) + absolute(p.z);
  bool usable = false;
  for (int i = 0; i < 10 && !usable; ++i) {
    const auto f = clearance(s, p, d, t);
    if (!f.defined || !(absolute(f.rate) > R(0))) break;
    const T step = quotient(f.value, f.rate);
    const T scale = s.height + offset + absolute(t);
    t = t - step;
    if (!finite(t)) break;
    // The step from a point already on the surface is the last: derivatives carried along have followed by then.
    const bool arrived = absolute(f.value) <= R(4) * eps * scale && step * step <= eps * scale * scale;
    if (arrived && !(f.rate * sense > R(0))) break;
    usable = arrived;
  }
  const Vec<T> point = p + d * t;
  return {point, usable && finite(point.x) && finite(point.y) && finite(point.z)};
}

/// The first crossing inside the clear aperture, if the steps of the search show one.
template <class T>
std::optional<AsphereHit<T>> first_crossing(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d,
                                            Storage<T> sense) noexcept {
  using R = Storage<T>;
  using std::sqrt;
  const auto [from, to] = segment(s, p, d);
  if (!(from < to)) return {};
  const T fastest = absolute(d.z) + s.steepest * sqrt(across(s, d));  // bound of the rate of clearance
  const T least = (to - from) * R(1.0 / 64);
  T low = from;
  auto below = clearance(s, p, d, low);
  for (int i = 0; i < 80 && below.defined && low < to; ++i) {  // 64 steps, and some for rounding
    const T safe = low + quotient(absolute(below.value), fastest);
    T high = safe > low + least ? safe : low + least;
    if (!(high < to)) high = to;
    const auto above = clearance(s, p, d, high);
    if (above.defined && below.value * sense <= R(0) && above.value * sense >= R(0)) {
      return refine(s, p, d, sense, {low, high});
    }
    low = high;
    below = above;
  }
  return {};
}

}  // namespace surface_detail

/// Where a ray meets an asphere: the first crossing inside the clear aperture in the sense of travel.
///
/// Newton from the hit on the base conic; its answer is taken if it lies inside the aperture, is crossed in the sense
/// of travel, and the ray is too upright to cross twice. Else the part of the ray that can lie on the surface is
/// searched from its beginning, in steps that the slope of the surface allows: on gull-wing surfaces the plain
/// iteration loses 2.6 % of steep rays to a wrong crossing. (Two crossings closer than 1/64 of that part may be passed
/// over as a near touch.) A ray that passes beside the aperture needs no search. A search takes at most 80 steps, and
/// 200 to close in on the crossing; in the phone lens of data/lenses it takes 6 and 15 on average. One ray at a time; a
/// lane that needs the search leaves its batch. Arguments as for the quadric. Accuracy: |error| cos(incidence) <= 4 eps
/// (height + distance slope); see tests/surface.
template <class T>
AsphereHit<T> intersect(const Asphere<Storage<T>>& s, const Vec<T>& start, const Vec<T>& d, Storage<T> sense) noexcept {
  const auto base = intersect(s.base, start, d, sense);
  // Distances count from the point nearest to the vertex: none of them, nor the point, is then longer than the hit is
  // far out.
  const Vec<T> p = start + d * T(-dot(start, d));
  const bool only_one = d.z * d.z > s.steepest * s.steepest * surface_detail::across(s, d);
  std::optional<surface_detail::Candidate<T>> candidate;
  if (only_one) {
    candidate = surface_detail::newton(s, base, p, d, sense);
    const T x = s.base.ax * candidate->point.x, y = s.base.ay * candidate->point.y;
    if (candidate->usable && x * x + y * y <= s.height * s.height) return {candidate->point, true, true};
  }
  const bool beside = surface_detail::passes_beside(s, p, d, only_one);
  if (!beside) {
    if (const auto found = surface_detail::first_crossing(s, p, d, sense)) return *found;
  }
  // No crossing inside the aperture: the one outside, if the iteration finds it, is where the ray is vignetted.
  if (!candidate) candidate = surface_detail::newton(s, base, p, d, sense);
  if (candidate->usable) return {candidate->point, true, true};
  return {start, false, true, beside};
}

template <class T>
Vec<T> normal(const Asphere<Storage<T>>& s, const Vec<T>& point) noexcept {
  using R = Storage<T>;
  using std::sqrt;
  const T x = s.base.ax * point.x, y = s.base.ay * point.y;
  const T slope = sag(s, T(x * x + y * y)).slope;
  const Vec<T> n{T(-slope * x), T(-slope * y), T(R(1))};
  return n * T(R(1) / sqrt(dot(n, n)));
}

}  // namespace petzval::inline v0::kernel
