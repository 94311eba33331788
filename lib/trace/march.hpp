// SPDX-License-Identifier: Apache-2.0
// Takes a bundle into the lens, through its surfaces and out again. Included like core/lanes.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "aspheres.hpp"
#include "steps.hpp"
#include "tangents.hpp"

namespace petzval::trace_detail {
namespace {

/// Loads rays and transforms them into the frame of the first step. Rays that are not finite or not of unit length are
/// not alive.
template <class R>
PETZVAL_ONE_LANE_INLINE void enter(const Route<R>& route, const RayArrays<const R>& in, const R* index,
                                   Bundle<R>& b) noexcept {
  using V = Lanes<R>;
  const V sense(route.sequence.first_sense);
  for (int i = 0; i < b.used; ++i) {
    const int o = i * V::width;
    const V x = load(in.x + o), y = load(in.y + o), z = load(in.z + o);
    const V dx = load(in.dx + o), dy = load(in.dy + o), dz = load(in.dz + o);
    const V length = dx * dx + dy * dy + dz * dz;
    const V scale = load(index + o) * (V(R(1.5)) - V(R(0.5)) * length);
    b.x[i] = x;
    b.y[i] = y;
    b.z[i] = sense * (z - V(route.sequence.first_z));
    b.px[i] = scale * dx;
    b.py[i] = scale * dy;
    b.pz[i] = sense * (scale * dz);
    b.r2[i] = x * x + y * y;
    const V zero = (x + y + z) * V(R(0));  // NaN if one of them is not finite
    constexpr R shortest(1 - unit_direction_tolerance), longest(1 + unit_direction_tolerance);
    b.alive[i] = (length > V(shortest)) & (length < V(longest)) & (zero >= V(R(0)));
    b.tally[i] = typename Native<R>::Bits{};
  }
  for (int i = b.used; i < Bundle<R>::vectors; ++i) {
    b.x[i] = b.y[i] = b.z[i] = b.px[i] = b.py[i] = b.r2[i] = V(R(0));
    b.pz[i] = V(R(1));
    b.alive[i] = b.x[i] > b.x[i];
    b.tally[i] = typename Native<R>::Bits{};
  }
}

template <class R>
void enter(const Route<R>& route, const RayArrays<const R>& in, const R* index, Tangent<R>& d) noexcept {
  using V = Lanes<R>;
  const V sense(route.sequence.first_sense);
  for (int i = 0; i < Bundle<R>::vectors; ++i) {
    const int o = i * V::width;
    const V n = load(index + o);
    d.x[i] = load(in.x + o);
    d.y[i] = load(in.y + o);
    d.z[i] = sense * load(in.z + o);
    d.px[i] = n * load(in.dx + o);
    d.py[i] = n * load(in.dy + o);
    d.pz[i] = sense * (n * load(in.dz + o));
  }
}

template <class R, class Media>
PETZVAL_ONE_LANE_INLINE void refresh(const Media& media, Bundle<R>& b) noexcept {
  using V = Lanes<R>;
  for (int i = 0; i < b.used; ++i) {
    const V length = (b.px[i] * b.px[i] + b.py[i] * b.py[i] + b.pz[i] * b.pz[i]) * media.per_n2(i);
    const V scale = V(R(1.5)) - V(R(0.5)) * length;
    b.px[i] = b.px[i] * scale;
    b.py[i] = b.py[i] * scale;
    b.pz[i] = b.pz[i] * scale;
  }
}

/// Stores rays in the lens frame with unit directions; lost rays are stored as given.
template <class R>
PETZVAL_ONE_LANE_INLINE void leave(const Route<R>& route, const RayArrays<const R>& in, const R* per_index,
                                   Bundle<R>& b, const RayArrays<R>& out) noexcept {
  using V = Lanes<R>;
  // A direction with |d|^2 = 1 + t, t = unit_direction_tolerance, has an error of 3/4 t^2 after the step in enter().
  constexpr R entered(unit_direction_tolerance * unit_direction_tolerance);
  constexpr R rounding = 100 * std::numeric_limits<R>::epsilon(), entry_bound = entered * entered;
  constexpr R max_excess2 = rounding > entry_bound ? rounding : entry_bound;
  const V sense(route.sequence.last_sense);
  for (int i = 0; i < b.used; ++i) {
    const int o = i * V::width;
    const V per_n = load(per_index + o);
    const V dx = per_n * b.px[i], dy = per_n * b.py[i], dz = per_n * b.pz[i];
    const V length = dx * dx + dy * dy + dz * dz;
    const V scale = V(R(1.5)) - V(R(0.5)) * length;
    // Rays whose values overflowed or lost their digits count as lost at the last surface.
    const V excess = length - V(R(1)) + b.z[i] * V(R(0));
    const Mask<R> sound = b.alive[i] & (excess * excess < V(max_excess2));
    count<1>(b.tally[i], sound);
    const bool all = every(sound);
    const auto put = [&](R* to, V value, const R* before) {
      store(to + o, all ? value : select(sound, value, load(before + o)));
    };
    put(out.x, b.x[i], in.x);
    put(out.y, b.y[i], in.y);
    put(out.z, sense * b.z[i] + V(route.sequence.last_z), in.z);
    put(out.dx, dx * scale, in.dx);
    put(out.dy, dy * scale, in.dy);
    put(out.dz, sense * (dz * scale), in.dz);
    b.alive[i] = sound;
  }
}

template <class R>
void leave(const Route<R>& route, const R* per_index, const Bundle<R>& b, const Tangent<R>& d,
           const RayArrays<R>& out) noexcept {
  using V = Lanes<R>;
  const V sense(route.sequence.last_sense), none(R(0));
  for (int i = 0; i < b.used; ++i) {
    const int o = i * V::width;
    const V per_n = load(per_index + o);
    const auto put = [&](R* to, V value) { store(to + o, select(b.alive[i], value, none)); };
    put(out.x, d.x[i]);
    put(out.y, d.y[i]);
    put(out.z, sense * d.z[i]);
    put(out.dx, per_n * d.px[i]);
    put(out.dy, per_n * d.py[i]);
    put(out.dz, sense * (per_n * d.pz[i]));
  }
}

/// Puts rays with non-finite input on the axis, in the direction of travel.
template <class R>
void put_on_axis(const Route<R>& route, int rays, const RayArrays<R>& out) noexcept {
  const auto finite = [](R value) { return value - value == 0; };
  for (int l = 0; l < rays; ++l) {
    if (finite(out.x[l]) && finite(out.y[l]) && finite(out.z[l]) && finite(out.dx[l]) && finite(out.dy[l]) &&
        finite(out.dz[l])) {
      continue;
    }
    out.x[l] = out.y[l] = out.z[l] = out.dx[l] = out.dy[l] = 0;
    out.dz[l] = route.sequence.first_sense;
  }
}

/// Calls body with the bundle, for work that is rarely needed. A single ray is passed as a copy, so that it stays in
/// registers.
template <class R, class Body>
PETZVAL_INLINE void in_memory(Bundle<R>& b, const Body& body) noexcept {
  if constexpr (Bundle<R>::rays == 1) {
    Bundle<R> own = b;
    body(own);
    b = own;
  } else {
    body(b);
  }
}

/// Passes the bundle through one surface.
template <class R, class Media, class Follow>
PETZVAL_ONE_LANE_INLINE void pass(const Route<R>& route, std::size_t j, const Media& media, std::uint8_t* unsettled,
                                  Bundle<R>& b, Follow& follow) noexcept {
  const kernel::Step<R>& s = route.sequence.steps[j];
  const Lanes<R> rim2(route.apertures ? s.rim2 : s.reach2);
  if (s.refresh) refresh(media, b);
  switch (s.kind) {
    case kernel::StepKind::plane: plane(s, rim2, media, b, follow); break;
    case kernel::StepKind::sphere:
      s.far ? sphere<true>(s, rim2, media, b, follow) : sphere<false>(s, rim2, media, b, follow);
      break;
    case kernel::StepKind::quadric: in_memory(b, [&](Bundle<R>& own) { quadric(s, rim2, media, own, follow); }); break;
    case kernel::StepKind::asphere:
      in_memory(b, [&](Bundle<R>& own) { asphere(s, rim2, route, unsettled, media, own, follow); });
      break;
  }
  const auto iris = s.stop ? route.iris : std::span<const kernel::StopEdge<R>>{};
  if (route.apertures && (s.obscuration2 > 0 || !iris.empty())) {
    in_memory(b, [&](Bundle<R>& own) { clip(s, iris, j, own); });
  }
  follow.watch(route, j, b);
}

}  // namespace
}  // namespace petzval::trace_detail
