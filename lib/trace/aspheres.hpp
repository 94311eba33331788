// SPDX-License-Identifier: Apache-2.0
// Aspheres for a bundle of rays. Included like lanes.hpp.
#pragma once

#include "steps.hpp"

namespace petzval::inline v0::trace_detail {
namespace {

/// A number and its derivative, for the slope of the slope of a sag.
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

/// A ray's height over an asphere and how fast it grows along the ray, in the turned frame.
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

/// Asks the search of one ray for the hits of some lanes of a vector; true where it found one.
template <class R>
Mask<R> search(const kernel::Step<R>& s, const BlockJob<R>& job, std::uint8_t* unsettled, Bundle<R>& b, int i,
               Mask<R> lanes, Lanes<R> x, Lanes<R> y, Lanes<R> z) noexcept {
  using V = Lanes<R>;
  constexpr int width = V::width;
  R values[6][width], found[width], wanted[width];
  const V p2 = b.px[i] * b.px[i] + b.py[i] * b.py[i] + b.pz[i] * b.pz[i];
  const V scale = V(R(1)) / sqrt(p2), sense(s.sense);
  store(values[0], x);
  store(values[1], y);
  store(values[2], sense * z);
  store(values[3], scale * b.px[i]);
  store(values[4], scale * b.py[i]);
  store(values[5], sense * scale * b.pz[i]);
  store(wanted, select(lanes, V(R(1)), V(R(0))));
  for (int l = 0; l < width; ++l) {
    found[l] = 0;
    if (wanted[l] == 0) continue;
    BeforeAsphere<R> ray{values[0][l], values[1][l], values[2][l], values[3][l], values[4][l], values[5][l]};
    const Found answer = job.search(job.aspheres[s.asphere], s.sense, ray);
    if (answer == Found::no_convergence) unsettled[i * width + l] = 1;
    if (answer == Found::beside) found[l] = 1, values[0][l] = std::numeric_limits<R>::quiet_NaN();
    if (answer != Found::hit) continue;
    found[l] = 1;
    values[0][l] = ray.x, values[1][l] = ray.y, values[2][l] = s.sense * ray.z;
  }
  const Mask<R> hit = load(found) > V(R(0));
  b.x[i] = select(hit, load(values[0]), b.x[i]);
  b.y[i] = select(hit, load(values[1]), b.y[i]);
  b.z[i] = select(hit, load(values[2]), b.z[i]);
  return hit;
}

/// Whether rays cross nothing within the clear aperture: they stay outside its cylinder, or within that above or below
/// the sag; of rays too upright to cross the surface twice it is enough to see both ends on one side of the edge. (x,
/// y, z): a point of the ray.
template <class R>
Mask<R> beside(const kernel::Step<R>& s, const kernel::Asphere<R>& asphere, const Bundle<R>& b, int i, Mask<R> upright,
               Lanes<R> across, Lanes<R> x, Lanes<R> y, Lanes<R> z) noexcept {
  using V = Lanes<R>;
  const V ax(s.ax), ay(s.ay), none(R(0)), edge2(asphere.height * asphere.height);
  const V px = b.px[i], py = b.py[i], pz = b.pz[i];
  const V middle = select(across > none, -(ax * x * px + ay * y * py) / across, none);
  const V nx = x + middle * px, ny = y + middle * py;
  const V within2 = edge2 - (ax * nx * nx + ay * ny * ny);
  const V half = sqrt(within2 / across);
  const V one = z + (middle - half) * pz, other = z + (middle + half) * pz;
  const V edge = V(s.sense) * kernel::sag(asphere, edge2).z;
  const V lowest = select(upright, edge, V(s.sense > 0 ? asphere.lowest : -asphere.highest));
  const V highest = select(upright, edge, V(s.sense > 0 ? asphere.highest : -asphere.lowest));
  const V unsure(R(64) * std::numeric_limits<R>::epsilon() * asphere.height);  // left to the search
  return (within2 < -unsure * V(asphere.height)) | ((one > highest + unsure) & (other > highest + unsure)) |
         ((one < lowest - unsure) & (other < lowest - unsure));
}

/// As many steps as the iteration of one ray has. From the hit on the base conic four do; after them, rays that pass
/// beside the aperture need not wander on.
inline constexpr int newton_steps = 10, usual_steps = 4;

/// Newton lane by lane: a lane that has arrived stays, so that its answer is its own. Where the answer might not be the
/// first crossing within the aperture, or there is none, the search of one ray decides.
template <class R, class Media, class Follow>
void asphere(const kernel::Step<R>& s, const Lanes<R>& rim2, const BlockJob<R>& job, std::uint8_t* unsettled,
             const Media& media, Bundle<R>& b, Follow& follow) noexcept {
  using V = Lanes<R>;
  const kernel::Asphere<R>& surface = job.aspheres[s.asphere];
  const V ax(s.ax), ay(s.ay), none(R(0)), size(surface.height);
  constexpr R eps = std::numeric_limits<R>::epsilon();
  for (int i = 0; i < Bundle<R>::vectors; ++i) {
    approach(s, media, b, i, follow);
    const V px = b.px[i], py = b.py[i], pz = b.pz[i], per_n2 = media.per_n2(i);
    const V x = b.x[i], y = b.y[i], z = b.z[i];

    // The hit on the base conic; where there is none, the place that approach() found.
    const auto [a, slant, f] = quadratic(s, b, i);
    const V disc = slant * slant - a * f;
    const Mask<R> on_base = (disc > none) & (slant > none);
    V q = select(on_base, f / (slant + root(disc)), none);

    const V offset = kernel::absolute(x) + kernel::absolute(y) + kernel::absolute(z);
    const V across = ax * px * px + ay * py * py;
    const Mask<R> upright = pz * pz > V(surface.steepest) * V(surface.steepest) * across;
    Mask<R> moving = b.alive[i], found = without(moving, moving);
    V rate = none, slope = none;
    for (int step = 1; step <= newton_steps; ++step) {
      const auto h = height(s, surface, V(x + q * px), V(y + q * py), V(z + q * pz), px, py, pz);
      const V by = h.value / h.rate;
      const V scale = size + offset + kernel::absolute(q);
      const Mask<R> now = moving & h.defined & (kernel::absolute(h.value) <= V(R(2) * eps) * scale) &
                          (by * by <= V(eps) * scale * scale * per_n2);
      q = select(moving, q - by, q);
      rate = select(moving, h.rate, rate);
      slope = select(moving, h.slope, slope);
      found = found | (now & (h.rate > none));
      moving = without(moving, now);
      if (step == usual_steps && job.apertures && any(moving)) {
        moving = without(moving, beside(s, surface, b, i, upright, across, x, y, z));
      }
      if (!any(moving)) break;
    }
    b.x[i] = x + q * px;
    b.y[i] = y + q * py;
    b.z[i] = z + q * pz;

    const V r2 = ax * b.x[i] * b.x[i] + ay * b.y[i] * b.y[i];
    if (Mask<R> doubtful = without(b.alive[i], found & upright & (r2 <= size * size)); any(doubtful)) {
      // What passes beside the aperture is vignetted, wherever it may cross the surface.
      const Mask<R> outside = doubtful & beside(s, surface, b, i, upright, across, x, y, z);
      b.x[i] = select(without(outside, found), V(std::numeric_limits<R>::quiet_NaN()), b.x[i]);
      found = found | outside;
      doubtful = without(doubtful, outside);
      if (any(doubtful)) {
        found = without(found, doubtful) | search(s, job, unsettled, b, i, doubtful, x, y, z);
        const auto h = height(s, surface, b.x[i], b.y[i], b.z[i], px, py, pz);
        rate = select(doubtful, h.rate, rate);
        slope = select(doubtful, h.slope, slope);
      }
    }

    const V gx = slope * ax * b.x[i], gy = slope * ay * b.y[i];
    V twist = none;
    if constexpr (Follow::wanted) {
      q = ((b.x[i] - x) * px + (b.y[i] - y) * py + (b.z[i] - z) * pz) * per_n2;
      const V u = ax * b.x[i] * b.x[i] + ay * b.y[i] * b.y[i];
      twist = V(s.sense + s.sense) * kernel::sag(surface, Rate<R>(u, V(R(1)))).slope.d;
    }
    bend(s, rim2, media, b, i, found,
         {q, px, py, pz, gx, gy, V(R(1)), none, rate, none, none, none, slope * ax, slope * ay, none, twist * ax,
          twist * ay},
         follow);
  }
}

}  // namespace
}  // namespace petzval::inline v0::trace_detail
