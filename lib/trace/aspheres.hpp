// SPDX-License-Identifier: Apache-2.0
// Aspheres for a bundle of rays. Included like core/lanes.hpp.
#pragma once

#include "lens/asphere_hit.hpp"
#include "steps.hpp"

namespace petzval::trace_detail {
namespace {

/// A number and its derivative; gives the second derivative of a sag.
template <class R>
struct Rate {
  using Scalar = R;
  Lanes<R> v, d;

  Rate() = default;
  PETZVAL_INLINE Rate(R value) noexcept : v(value), d(R(0)) {}
  PETZVAL_INLINE Rate(Lanes<R> value, Lanes<R> rate) noexcept : v(value), d(rate) {}

  friend PETZVAL_INLINE Rate operator+(Rate a, Rate b) noexcept { return {a.v + b.v, a.d + b.d}; }
  friend PETZVAL_INLINE Rate operator-(Rate a, Rate b) noexcept { return {a.v - b.v, a.d - b.d}; }
  friend PETZVAL_INLINE Rate operator*(Rate a, Rate b) noexcept { return {a.v * b.v, a.d * b.v + a.v * b.d}; }
  friend PETZVAL_INLINE Rate operator/(Rate a, Rate b) noexcept {
    const Lanes<R> q = a.v / b.v;
    return {q, (a.d - q * b.d) / b.v};
  }
  friend PETZVAL_INLINE Mask<R> operator<(Rate a, Rate b) noexcept { return a.v < b.v; }
  friend PETZVAL_INLINE Mask<R> operator>(Rate a, Rate b) noexcept { return a.v > b.v; }
};

template <class R>
PETZVAL_INLINE Rate<R> select(Mask<R> mask, Rate<R> a, Rate<R> b) noexcept {
  return {select(mask, a.v, b.v), select(mask, a.d, b.d)};
}
template <class R>
PETZVAL_INLINE Rate<R> sqrt(Rate<R> x) noexcept {
  const Lanes<R> s = sqrt(x.v);
  return {s, x.d / (s + s)};
}

/// Height of a ray above an asphere and its derivative along the ray, in the frame of kernel::Step.
template <class R>
struct Height {
  Lanes<R> value, rate, slope;
  Mask<R> defined;
};

template <class R>
PETZVAL_INLINE Height<R> height(const kernel::Step<R>& s, const kernel::Asphere<R>& asphere, Lanes<R> x, Lanes<R> y,
                                Lanes<R> z, Lanes<R> px, Lanes<R> py, Lanes<R> pz) noexcept {
  using V = Lanes<R>;
  const V ux = V(s.ax) * x, uy = V(s.ay) * y;
  const auto sag = kernel::sag(asphere, V(ux * x + uy * y));
  const V slope = V(s.sense) * sag.slope;
  return {z - V(s.sense) * sag.z, pz - slope * (ux * px + uy * py), slope, sag.defined};
}

/// Result of a search. `stands`: the result of Newton's iteration is the first crossing. `past_rim`: the ray passes
/// outside the aperture.
enum class Outcome : std::uint8_t { open, stands, crosses, past_rim, lost };

template <class R>
PETZVAL_INLINE Lanes<R> code(Outcome what) noexcept {
  return Lanes<R>(static_cast<R>(what));
}
template <class R>
PETZVAL_INLINE Mask<R> are(Lanes<R> outcomes, Outcome what) noexcept {
  return (outcomes >= code<R>(what)) & (outcomes <= code<R>(what));
}

/// Rays of a bundle whose crossings are searched, packed, in the lens frame; and the results in the same order.
template <class R>
struct Search {
  using V = Lanes<R>;
  using Vector = kernel::Vec<V>;
  static constexpr int width = V::width, capacity = Bundle<R>::rays + width;
  /// Values per ray: point, direction, Newton's result, and 1 if this result lies inside the aperture.
  enum Value { x, y, z, dx, dy, dz, answer, inside, values };
  R v[values][capacity];
  int count = 0;
  R t[capacity], outcome[capacity];

  void take(Mask<R> lanes, const Vector& p, const Vector& d, V newton, Mask<R> newton_inside) noexcept {
    const V flag = select(newton_inside, V(R(1)), V(R(0)));
    int k = 0;
    for (const V& numbers : {p.x, p.y, p.z, d.x, d.y, d.z, newton, flag}) pack(v[k++] + count, lanes, numbers);
    count += lanes_in(lanes);
  }

  /// Decides rays by bounds if possible, then packs and searches the other rays.
  void run(const kernel::Asphere<R>& surface, R sense) noexcept {
    R from[capacity], to[capacity];
    Mask<R> left[Bundle<R>::vectors];
    int kept = 0;
    fill(v, count);
    for (int o = 0; o < count; o += width) {
      const Vector p{at(x, o), at(y, o), at(z, o)}, d{at(dx, o), at(dy, o), at(dz, o)};
      const V newton = at(answer, o);
      const auto ray = kernel::trace_detail::passage(surface, p, d);
      const auto [range, empty, rising] = kernel::trace_detail::prospect(surface, ray, p, d, sense);
      const Mask<R> stands = rising & (at(inside, o) > V(R(0)));
      // Without a crossing inside the aperture, a ray that can have at most one crossing passes outside.
      const V nothing = select(empty | rising, code<R>(Outcome::past_rim), code<R>(Outcome::open));
      store(outcome + o, select(stands, code<R>(Outcome::stands), nothing));
      left[o / width] = without(range.from <= range.to, stands);
      int k = 0;
      for (const V& numbers : {p.x, p.y, p.z, d.x, d.y, d.z, newton}) pack(v[k++] + kept, left[o / width], numbers);
      pack(from + kept, left[o / width], range.from);
      pack(to + kept, left[o / width], range.to);
      kept += lanes_in(left[o / width]);
    }
    if (kept == 0) return;
    fill(v, kept);
    for (R* numbers : {from, to}) fill(numbers, kept);
    R found_t[capacity], found[capacity];
    for (int o = 0; o < kept; o += width) {
      const Vector p{at(x, o), at(y, o), at(z, o)}, d{at(dx, o), at(dy, o), at(dz, o)};
      const auto ray = kernel::trace_detail::passage(surface, p, d);
      const auto crossing = kernel::trace_detail::first_crossing(surface, ray, p, d, sense,
                                                                 {load(from + o), load(to + o)}, at(answer, o));
      const V outcome_if_found = select(crossing.converged, code<R>(Outcome::crosses), code<R>(Outcome::lost));
      store(found_t + o, crossing.t);
      store(found + o, select(crossing.found, outcome_if_found, code<R>(Outcome::open)));
    }
    for (int o = 0, taken = 0; o < count; o += width) {
      const V said = load(outcome + o);
      const V more = unpack(found + taken, left[o / width], code<R>(Outcome::open));
      store(outcome + o, select(are(more, Outcome::open), said, more));
      store(t + o, unpack(found_t + taken, left[o / width], V(R(0))));
      taken += lanes_in(left[o / width]);
    }
  }

 private:
  V at(Value value, int o) const noexcept { return load(v[value] + o); }

  /// Fills the remaining lanes of the last vector with copies of the last ray.
  static void fill(R* numbers, int count) noexcept {
    for (int l = count; l % width != 0; ++l) numbers[l] = numbers[count - 1];
  }
  static void fill(R (&numbers)[values][capacity], int count) noexcept {
    for (auto& row : numbers) fill(row, count);
  }
};

/// True if both ends of the part of the ray inside the cylinder of the aperture lie on the same side of the rim. Only
/// for rays so close to the axial direction that they cross the surface at most once.
template <class R>
PETZVAL_INLINE Mask<R> past_edge(const kernel::Asphere<R>& surface, const kernel::trace_detail::Passage<Lanes<R>>& ray,
                                 Lanes<R> z, Lanes<R> dz) noexcept {
  using V = Lanes<R>;
  const R unsure = R(64) * std::numeric_limits<R>::epsilon() * surface.height;
  const V within2 = V(surface.height * surface.height) - ray.nearest2, half = sqrt(quotient(within2, ray.across2));
  const V one = z + (ray.middle - half) * dz, other = z + (ray.middle + half) * dz;
  const V over(surface.edge + unsure), under(surface.edge - unsure);
  return (within2 < V(-unsure * surface.height)) | ((one > over) & (other > over)) | ((one < under) & (other < under));
}

/// Numbers of Newton steps from the hit on the base conic: at most usual_steps; more than first_steps only if the last
/// step was shorter than 1/16 of the height; up to newton_steps if the search shows no crossing inside the aperture.
template <class R>
inline constexpr int usual_steps = sizeof(R) == sizeof(float) ? 4 : 6;
inline constexpr int first_steps = 3, newton_steps = 10;

/// Points b + q p at which the rays of a bundle meet an asphere.
template <class R>
struct Meeting {
  using V = Lanes<R>;
  static constexpr int vectors = Bundle<R>::vectors;
  V q[vectors], rate[vectors], slope[vectors];
  Mask<R> found[vectors];
  Mask<R> past_rim[vectors];  ///< no crossing inside the aperture: vignetted, even if the ray hits farther out
};

/// Newton's iteration in each lane; a converged lane keeps its value, so that results do not depend on other lanes. A
/// result is accepted if it lies inside the aperture and the ray rises above the surface along the complete part that
/// may meet the surface inside the aperture. For other rays the intervals are searched, as in kernel::intersect.
/// @param at on input, the start values of q; on output, the results
/// @param per_n2 one over the squared index in front of the surface
template <class R>
[[gnu::noinline]] void meet(const kernel::Step<R>& s, const Route<R>& route, std::uint8_t* unsettled,
                            const Bundle<R>& b, const Lanes<R>* per_n2, Meeting<R>& at) noexcept {
  using V = Lanes<R>;
  constexpr int vectors = Bundle<R>::vectors, width = V::width;
  constexpr R eps = std::numeric_limits<R>::epsilon();
  const kernel::Asphere<R>& surface = route.aspheres[s.asphere];
  const V ax(s.ax), ay(s.ay), none(R(0)), size(surface.height), sense(s.sense);
  V offset[vectors];
  Mask<R> moving[vectors], waiting[vectors];
  for (int i = 0; i < vectors; ++i) {
    offset[i] = ax * kernel::absolute(b.x[i]) + ay * kernel::absolute(b.y[i]) + kernel::absolute(b.z[i]);
    at.rate[i] = at.slope[i] = none;
    moving[i] = b.alive[i];
    waiting[i] = at.found[i] = at.past_rim[i] = without(moving[i], moving[i]);
  }
  const auto height_at = [&](int i, V q) {
    return height(s, surface, V(b.x[i] + q * b.px[i]), V(b.y[i] + q * b.py[i]), V(b.z[i] + q * b.pz[i]), b.px[i],
                  b.py[i], b.pz[i]);
  };
  const auto iterate = [&](int from, int to) {
    bool more = true;
    for (int step = from; step < to && more; ++step) {
      more = false;
      for (int i = 0; i < vectors; ++i) {
        if (!any(moving[i])) continue;
        const auto h = height_at(i, at.q[i]);
        const V by = quotient(h.value, h.rate), by2 = by * by;
        const V scale = size + offset[i] + kernel::absolute(at.q[i]);
        const Mask<R> now = moving[i] & h.defined & (kernel::absolute(h.value) <= V(R(2) * eps) * scale) &
                            (by2 <= V(eps) * scale * scale * per_n2[i]);
        at.q[i] = select(moving[i], at.q[i] - by, at.q[i]);
        at.rate[i] = select(moving[i], h.rate, at.rate[i]);
        at.slope[i] = select(moving[i], h.slope, at.slope[i]);
        at.found[i] = at.found[i] | (now & (h.rate > none));
        moving[i] = without(moving[i], now);
        if (step >= first_steps && step < usual_steps<R>) {
          const Mask<R> hopeless = without(moving[i], by2 <= V(R(1.0 / 256)) * size * size * per_n2[i]);
          waiting[i] = waiting[i] | hopeless;
          moving[i] = without(moving[i], hopeless);
        }
        more = more || any(moving[i]);
      }
    }
  };
  iterate(0, usual_steps<R>);

  // Rays close to the axial direction with a result inside the aperture need no search.
  Mask<R> inside[vectors], doubtful[vectors];
  bool doubts = false;
  const V steepest2(surface.steepest * surface.steepest);
  for (int i = 0; i < vectors; ++i) {
    const V x = b.x[i] + at.q[i] * b.px[i], y = b.y[i] + at.q[i] * b.py[i];
    inside[i] = at.found[i] & (ax * x * x + ay * y * y <= size * size);
    const Mask<R> upright = b.pz[i] * b.pz[i] > steepest2 * (ax * b.px[i] * b.px[i] + ay * b.py[i] * b.py[i]);
    doubtful[i] = without(b.alive[i], inside[i] & upright);
    doubts = doubts || any(doubtful[i]);
  }
  if (!doubts) return;

  Search<R> search;
  Mask<R> taken[vectors];
  for (int i = 0; i < vectors; ++i) {
    taken[i] = without(doubtful[i], doubtful[i]);
    if (!any(doubtful[i])) continue;
    const kernel::Vec<V> p{b.x[i], b.y[i], sense * b.z[i]}, d{b.px[i], b.py[i], sense * b.pz[i]};
    const auto ray = kernel::trace_detail::passage(surface, p, d);
    const Mask<R> upright = d.z * d.z > steepest2 * ray.across2;
    at.past_rim[i] = doubtful[i] & upright & past_edge(surface, ray, p.z, d.z);
    taken[i] = without(doubtful[i], at.past_rim[i]);
    if (any(taken[i])) search.take(taken[i], p, d, at.q[i], inside[i]);
  }
  if (search.count > 0) search.run(surface, s.sense);
  for (int i = 0, o = 0; i < vectors; o += lanes_in(taken[i++])) {
    const V outcome = any(taken[i]) ? unpack(search.outcome + o, taken[i], code<R>(Outcome::open)) : none;
    const Mask<R> crosses = taken[i] & are(outcome, Outcome::crosses), lost = taken[i] & are(outcome, Outcome::lost);
    at.past_rim[i] = at.past_rim[i] | (taken[i] & are(outcome, Outcome::past_rim));
    at.found[i] = without(at.found[i] | crosses, lost);
    // A hit outside the aperture does not matter if the aperture clips the ray.
    const Mask<R> settled = crosses | lost | (route.apertures ? at.past_rim[i] : lost);
    moving[i] = without(moving[i] | waiting[i], settled);
    if (any(lost)) {
      R said[width];
      store(said, outcome);
      for (int l = 0; l < width; ++l) unsettled[i * width + l] |= said[l] == static_cast<R>(Outcome::lost) ? 1 : 0;
    }
    if (!any(crosses)) continue;
    at.q[i] = select(crosses, unpack(search.t + o, taken[i], at.q[i]), at.q[i]);
    const auto h = height_at(i, at.q[i]);
    at.rate[i] = select(crosses, h.rate, at.rate[i]);
    at.slope[i] = select(crosses, h.slope, at.slope[i]);
  }
  iterate(usual_steps<R>, newton_steps);
}

template <class R, class Media, class Follow>
void asphere(const kernel::Step<R>& s, const Lanes<R>& rim2, const Route<R>& route, std::uint8_t* unsettled,
             const Media& media, Bundle<R>& b, Follow& follow) noexcept {
  using V = Lanes<R>;
  constexpr int vectors = Bundle<R>::vectors;
  const V ax(s.ax), ay(s.ay), none(R(0));
  Meeting<R> at;
  V per_n2[vectors];
  for (int i = 0; i < vectors; ++i) {
    approach(s, media, b, i, follow);
    // The hit on the base conic or, if there is no hit, the point found by approach().
    const auto [a, slant, f] = quadratic(s, b, i);
    const V disc = slant * slant - a * f;
    const Mask<R> on_base = (disc > none) & (slant > none);
    at.q[i] = select(on_base, quotient(f, V(slant + root(disc))), none);
    per_n2[i] = media.per_n2(i);
  }
  meet(s, route, unsettled, b, per_n2, at);
  const kernel::Asphere<R>& surface = route.aspheres[s.asphere];
  const V described2(route.apertures ? surface.rim2 : std::numeric_limits<R>::infinity());
  for (int i = 0; i < vectors; ++i) {
    const V x = b.x[i], y = b.y[i], z = b.z[i], px = b.px[i], py = b.py[i], pz = b.pz[i], q = at.q[i];
    const Mask<R> found = at.found[i] | at.past_rim[i];
    b.x[i] = select(without(at.past_rim[i], at.found[i]), V(std::numeric_limits<R>::quiet_NaN()), x + q * px);
    b.y[i] = y + q * py;
    b.z[i] = z + q * pz;
    const V u = ax * b.x[i] * b.x[i] + ay * b.y[i] * b.y[i];
    const V gx = at.slope[i] * ax * b.x[i], gy = at.slope[i] * ay * b.y[i];
    V path = q, twist = none;
    if constexpr (Follow::enabled) {
      path = ((b.x[i] - x) * px + (b.y[i] - y) * py + (b.z[i] - z) * pz) * per_n2[i];
      twist = V(s.sense + s.sense) * kernel::sag(surface, Rate<R>(u, V(R(1)))).slope.d;
    }
    bend(s, V(select(u <= described2, rim2, V(R(-1)))), media, b, i, found,
         {path, px, py, pz, gx, gy, V(R(1)), none, at.rate[i], none, none, none, at.slope[i] * ax, at.slope[i] * ay,
          none, twist * ax, twist * ay},
         follow);
  }
}

}  // namespace
}  // namespace petzval::trace_detail
