// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "lens/asphere.hpp"

namespace petzval::kernel {

/// Result of the intersection with an asphere: a hit, no hit, or no convergence.
template <class T>
struct AsphereHit {
  Vec<T> point;
  bool hit;
  bool converged;
  bool past_rim = false;  ///< no hit, because the ray passes outside the described height of the surface
};

namespace trace_detail {

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

/// Distance of a ray from the axis: at distance t along the ray, r^2 = nearest2 + across2 (t - middle)^2.
template <class T>
struct Passage {
  T middle, nearest2, across2;
};

template <class T>
Passage<T> passage(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d) noexcept {
  using R = Storage<T>;
  const T lx = s.base.ax * d.x, ly = s.base.ay * d.y, px = s.base.ax * p.x, py = s.base.ay * p.y;
  const T across2 = lx * lx + ly * ly;
  const auto slanting = across2 > R(0);
  const T middle = select(slanting, quotient(T(-(px * lx + py * ly)), select(slanting, across2, T(R(1)))), T(R(0)));
  const T qx = px + middle * lx, qy = py + middle * ly;
  return {middle, qx * qx + qy * qy, across2};
}

/// Bounds of the squared radius over a part of the ray.
template <class T>
Span<T> radii2(const Passage<T>& ray, const Span<T>& range) noexcept {
  using R = Storage<T>;
  const T a = range.from - ray.middle, b = range.to - ray.middle, a2 = a * a, b2 = b * b;
  const T near2 = select(all_of(a<R(0), b> R(0)), T(R(0)), select(a2 < b2, a2, b2));
  return {ray.nearest2 + ray.across2 * near2, ray.nearest2 + ray.across2 * select(a2 < b2, b2, a2)};
}

/// Bounds of the sag between two squared radii.
template <class T>
Span<T> sags(const Asphere<Storage<T>>& s, const Span<T>& radii2) noexcept {
  using R = Storage<T>;
  Span<T> bounds{T(s.highest), T(s.lowest)};
  for (const AsphereRing<R>& ring : s.rings) {
    const auto met = all_of(radii2.from <= ring.outer2, radii2.to >= ring.inner2);
    if (!any(met)) continue;
    bounds.from = select(all_of(met, bounds.from > ring.lowest), T(ring.lowest), bounds.from);
    bounds.to = select(all_of(met, bounds.to < ring.highest), T(ring.highest), bounds.to);
  }
  return bounds;
}

/// Bounds of the rate at which the ray rises above the surface over a part of its length.
///
/// The rate is d.z - (slope / r) (r r'), and r r' = across2 (t - middle) increases along the ray; within a ring its
/// magnitude is at most the outer radius times the speed across the axis.
template <class T>
Span<T> rates(const Asphere<Storage<T>>& s, const Passage<T>& ray, const T& dz, const Span<T>& range) noexcept {
  using R = Storage<T>;
  const auto [inner2, outer2] = radii2(ray, range);
  const T from = ray.across2 * (range.from - ray.middle), to = ray.across2 * (range.to - ray.middle);
  const T speed = safe_sqrt(ray.across2);
  constexpr R huge = std::numeric_limits<R>::max();
  T least(huge), most(-huge);
  for (const AsphereRing<R>& ring : s.rings) {
    const auto met = all_of(inner2 <= ring.outer2, outer2 >= ring.inner2);
    if (!any(met)) continue;
    const T reach = ring.outer * speed;
    const T low = select(from > -reach, from, T(-reach)), high = select(to < reach, to, reach);
    // Product of two intervals.
    const T a = low * ring.least_bend, b = low * ring.most_bend, c = high * ring.least_bend, d = high * ring.most_bend;
    const T ab = select(a < b, a, b), ba = select(a < b, b, a), cd = select(c < d, c, d), dc = select(c < d, d, c);
    const T lesser = select(ab < cd, ab, cd), greater = select(ba < dc, dc, ba);
    least = select(all_of(met, lesser < least), lesser, least);
    most = select(all_of(met, greater > most), greater, most);
  }
  return {dz - most, dz - least};
}

/// The part of the ray that lies between two heights.
template <class T>
Span<T> between(const T& z, const T& dz, const Span<T>& heights, const Span<T>& range) noexcept {
  const T a = quotient(T(heights.from - z), dz), b = quotient(T(heights.to - z), dz);
  const T enter = select(a < b, a, b), leave = select(a < b, b, a);
  return {select(enter > range.from, enter, range.from), select(leave < range.to, leave, range.to)};
}

/// The part of a ray that may meet the surface within its height: inside the cylinder and between the bounds of the
/// sag. Slightly enlarged for rounding; from > to if the part is empty.
template <class T>
Span<T> reachable(const Asphere<Storage<T>>& s, const Passage<T>& ray, const Vec<T>& p, const Vec<T>& d) noexcept {
  using R = Storage<T>;
  constexpr R rounding_margin = R(1) + R(64) * std::numeric_limits<R>::epsilon();
  const R far = R(1e18);  // its square is finite in float
  const T within2 = rounding_margin * s.height * s.height - ray.nearest2;
  const auto slanting = ray.across2 > R(0);
  T half = safe_sqrt(quotient(within2, select(slanting, ray.across2, T(R(1)))));
  half = select(all_of(slanting, half < far), half, T(far));
  Span<T> range{ray.middle - half, ray.middle + half};
  const auto outside = within2 < R(0);
  range = {select(outside, T(far), range.from), select(outside, T(-far), range.to)};
  range = between(p.z, d.z, {T(s.lowest), T(s.highest)}, range);
  return between(p.z, d.z, sags(s, radii2(ray, range)), range);
}

/// Properties of a ray that follow from the bounds of the surface.
template <class T>
struct Prospect {
  Span<T> range;          ///< may meet the surface within its height
  Mask<T> empty, rising;  ///< no such part; rising along the complete part: at most one crossing
};

/// @param sense +1 or -1, the direction of travel, which defines `rising`
template <class T>
Prospect<T> prospect(const Asphere<Storage<T>>& s, const Passage<T>& ray, const Vec<T>& p, const Vec<T>& d,
                     Storage<T> sense) noexcept {
  using R = Storage<T>;
  const auto range = reachable(s, ray, p, d);
  const auto [slowest, fastest] = rates(s, ray, d.z, range);
  const Mask<T> rising = sense > 0 ? slowest > R(0) : fastest < R(0);
  return {range, range.from > range.to, all_of(rising, slowest <= fastest)};
}

/// First crossing of a ray with the surface. If `found` and not `converged`, the ray is lost.
template <class T>
struct Crossing {
  T t;
  Mask<T> found, converged;
};

/// Steps of the search. The shortest interval is 1/64 of the part. After each interval that is decided, an interval of
/// twice the length may be tried in vain; in addition, the first interval may need six halvings.
inline constexpr int search_intervals = 64, search_steps = 2 * search_intervals + 8;

/// Refines the crossing between `low` (below the surface in the sense of travel) and `high` (above the surface).
/// Newton's iteration, replaced by a bisection if a step leaves the bracket or is not at most half the last step; at
/// most 100 steps.
template <class T>
void close_in(const Asphere<Storage<T>>& s, const Vec<T>& p, const Vec<T>& d, Storage<T> sense, T low, T high,
              Crossing<T>& crossing) noexcept {
  using R = Storage<T>;
  constexpr R eps = std::numeric_limits<R>::epsilon();
  T t = crossing.t, last = high - low;
  Mask<T> active = crossing.found;
  for (int i = 0; i < 100 && any(active); ++i) {
    const auto f = clearance(s, p, d, t);
    active = all_of(active, f.defined);
    const auto under = sense * f.value < R(0);
    low = select(under, t, low);
    high = select(under, high, t);
    const T next = t - quotient(f.value, f.rate), step = absolute(T(next - t)), half = R(0.5) * (high - low);
    const auto inside = all_of(next >= low, next <= high);
    const T scale = s.height + absolute(t);
    const auto usable = all_of(inside, step + step <= last);
    const auto arrived = any_of(absolute(f.value) <= R(4) * eps * scale, R(2) * half <= R(4) * eps * scale);
    const T onwards = select(usable, next, T(low + half));
    t = select(active, select(arrived, select(inside, next, t), onwards), t);
    last = select(usable, step, half);
    crossing.converged = any_of(crossing.converged, all_of(active, arrived));
    active = without(active, arrived);
  }
  crossing.t = t;
}

/// Finds the first crossing on a part of the ray in the sense of travel; no earlier crossing exists.
///
/// An interval of the ray has no crossing if, by the bounds of the rates in its rings, the surface cannot be reached
/// from its ends. It has at most one crossing if the ray rises throughout. Other intervals are halved down to 1/64 of
/// the part; two crossings within such an interval may be missed.
/// @param guess result of Newton's iteration
template <class T>
Crossing<T> first_crossing(const Asphere<Storage<T>>& s, const Passage<T>& ray, const Vec<T>& p, const Vec<T>& d,
                           Storage<T> sense, const Span<T>& range, const T& guess) noexcept {
  using R = Storage<T>;
  const T fraction = (range.to - range.from) * R(1.0 / search_intervals);
  const T rounding = R(4) * std::numeric_limits<R>::epsilon() * (absolute(range.from) + absolute(range.to));
  const T shortest = select(fraction > rounding, fraction, rounding);
  T low = range.from, high = range.to, width = high - low, bracket_low = low, bracket_high = low;
  T below = sense * clearance(s, p, d, low).value;
  Mask<T> active = low <= high;
  Crossing<T> crossing{guess, without(active, active), without(active, active)};
  for (int i = 0; i < search_steps && any(active); ++i) {
    const T above = sense * clearance(s, p, d, high).value;
    // Bounds of the speeds at which the ray falls towards the surface and rises above it, in the sense of travel.
    const auto [slowest, fastest] = rates(s, ray, d.z, {low, high});
    const T fall = sense > 0 ? -slowest : fastest, rise = sense > 0 ? fastest : -slowest;
    const auto over = below > R(0);
    const T one = select(over, below, T(-above)), other = select(over, above, T(-below));
    const auto out_of_reach = all_of(one > R(0), other > R(0), rise * one + fall * other > fall * rise * (high - low));
    const auto proven = any_of(any_of(fall < R(0), rise < R(0)), out_of_reach);
    const auto settled = all_of(active, any_of(proven, width <= shortest));
    const auto crossed = all_of(settled, below <= R(0), above >= R(0));
    T start = low + (high - low) * quotient(below, T(below - above));
    start = select(all_of(start >= low, start <= high), start, T(low + R(0.5) * (high - low)));
    start = select(all_of(guess > low, guess < high), guess, start);
    crossing.found = any_of(crossing.found, crossed);
    crossing.t = select(crossed, start, crossing.t);
    bracket_low = select(crossed, low, bracket_low);
    bracket_high = select(crossed, high, bracket_high);
    low = select(settled, high, low);
    below = select(settled, above, below);
    width = select(settled, T(width + width), T(R(0.5) * width));
    high = select(low + width < range.to, T(low + width), range.to);
    active = all_of(without(active, crossed), low < range.to);
  }
  if (any(crossing.found)) close_in(s, p, d, sense, bracket_low, bracket_high, crossing);
  return crossing;
}

/// Result of Newton's iteration from the hit on the base conic; usable if it is a crossing in the sense of travel.
template <class T>
struct Candidate {
  T t;
  Vec<T> point;
  bool usable = false;
};

/// @param base hit on the base conic
/// @param p a point of the ray
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
  const T offset = s.base.ax * absolute(p.x) + s.base.ay * absolute(p.y) + absolute(p.z);
  bool usable = false;
  for (int i = 0; i < 10 && !usable; ++i) {
    const auto f = clearance(s, p, d, t);
    if (!f.defined || !(absolute(f.rate) > R(0))) break;
    const T step = quotient(f.value, f.rate);
    const T scale = s.height + offset + absolute(t);
    t = t - step;
    if (!finite(t)) break;
    // A step from a point that is already on the surface is the last step, because the derivatives are accurate by
    // then.
    const bool arrived = absolute(f.value) <= R(4) * eps * scale && step * step <= eps * scale * scale;
    if (arrived && !(f.rate * sense > R(0))) break;
    usable = arrived;
  }
  const Vec<T> point = p + d * t;
  return {t, point, usable && finite(point.x) && finite(point.y) && finite(point.z)};
}

}  // namespace trace_detail

/// Intersects a ray with an asphere: the first crossing inside the clear aperture in the sense of travel.
///
/// Newton's iteration starts at the hit on the base conic. Its result is accepted if it lies inside the aperture and
/// the ray rises above the surface, in the sense of travel, along the complete part that may meet the surface: then
/// there is no other crossing. (On gull-wing surfaces plain iteration takes a wrong crossing for 2.6 % of steep rays.)
///
/// Otherwise this part is searched from its beginning, in intervals that are decided by bounds over rings of the
/// surface: at most 136 intervals, and 100 steps to refine the crossing. The phone lens of data/lenses needs one
/// interval and four steps. The arguments are the same as for a quadric.
///
/// Accuracy: |error| cos(incidence) <= 4 eps (height + distance slope); see tests/lens.
/// Limitations: two crossings closer than 1/64 of the part may be missed.
template <class T>
AsphereHit<T> intersect(const Asphere<Storage<T>>& s, const Vec<T>& start, const Vec<T>& d, Storage<T> sense) noexcept {
  const auto base = intersect(s.base, start, d, sense);
  // Distances are measured from the point of the ray nearest to the vertex. Neither the distances nor the coordinates
  // of this point then exceed the distance of the hit from the vertex.
  const Vec<T> p = start + d * T(-dot(start, d));
  const auto candidate = trace_detail::newton(s, base, p, d, sense);
  const T x = s.base.ax * candidate.point.x, y = s.base.ay * candidate.point.y;
  const bool inside = candidate.usable && x * x + y * y <= s.height * s.height;
  const auto ray = trace_detail::passage(s, p, d);
  if (inside && d.z * d.z > s.steepest * s.steepest * ray.across2) return {candidate.point, true, true};
  const auto [range, empty, rising] = trace_detail::prospect(s, ray, p, d, sense);
  if (inside && rising) return {candidate.point, true, true};
  if (!empty) {
    const auto [t, found, converged] = trace_detail::first_crossing(s, ray, p, d, sense, range, candidate.t);
    if (found) return {converged ? p + d * t : start, converged, converged};
  }
  // No crossing inside the aperture: the ray is vignetted at the crossing outside, if the iteration finds one.
  if (candidate.usable) return {candidate.point, true, true};
  return {start, false, true, empty || rising};
}

}  // namespace petzval::kernel
