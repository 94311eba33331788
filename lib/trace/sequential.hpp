// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "lens/asphere_hit.hpp"
#include "lens/lens_view.hpp"
#include "petzval/core/ray.hpp"

namespace petzval::kernel {

/// The surfaces [first, last) in table order to trace through, for either direction of travel.
struct SurfaceRange {
  Travel travel = Travel::to_film;
  std::size_t wavelength = 0;
  bool apertures = true;
  std::size_t first = 0;
  std::size_t last = static_cast<std::size_t>(-1);  ///< default: all surfaces
};

/// A ray during a trace, lens frame, any scalar type.
template <class T>
struct TraceState {
  Vec<T> origin, direction;
  RayFate fate = RayFate::transmitted;
  int surface = -1;
};

/// Distance of a point in the stop plane from an edge of the iris, positive inside, to first order.
template <class T>
T edge_clearance(const StopEdge<Storage<T>>& edge, const T& x, const T& y) noexcept {
  return T(edge.distance) - (x * T(edge.nx) + y * T(edge.ny) + T(edge.bend) * (x * x + y * y));
}

/// True if a point in the stop plane lies within the iris; its edges count as inside.
template <class T>
Mask<T> within(std::span<const StopEdge<Storage<T>>> iris, const T& x, const T& y) noexcept {
  Mask<T> inside = x <= std::numeric_limits<Storage<T>>::max();
  for (const auto& edge : iris) inside = all_of(inside, edge_clearance(edge, x, y) >= Storage<T>(0));
  return inside;
}

struct NoObserver {
  template <class T>
  void operator()(int, const Vec<T>&, const Vec<T>&) const noexcept {}
};

/// Traces one ray through a part of the lens, surface by surface; returns as soon as the ray is lost.
///
/// One loop serves both directions of travel and every scalar type: derivatives, parts of a lens and drawings. The
/// faster recurrence of trace() and of batches is tested against it.
/// @param direction a unit vector within a few ulp; the same holds for the direction of a transmitted ray
/// @param observer called as observer(surface, point, direction) for each hit, with the direction of the ray that
/// arrives;
///                 lens frame
template <class T, class Observer = NoObserver>
TraceState<T> trace(const LensView<Storage<T>>& lens, const Vec<T>& origin, const Vec<T>& direction,
                    const SurfaceRange& path, Observer&& observer = {}) noexcept {
  using R = Storage<T>;
  using std::sqrt;
  const bool to_film = path.travel == Travel::to_film;
  const std::size_t last = path.last < lens.count ? path.last : lens.count;
  const Interface<R>* interfaces = (to_film ? lens.to_film : lens.to_scene) + path.wavelength * lens.count;

  bool bent = false;
  TraceState<T> ray{origin, direction, RayFate::transmitted, -1};
  if (path.first >= last) return ray;
  std::size_t i = to_film ? path.first : last - 1;
  Vec<T> p{origin.x, origin.y, T(origin.z - lens.vertex_z[i])};
  for (;;) {
    const SurfaceTable<R>& surface = lens.surfaces[i];
    // Towards the scene the sense is reversed, except at mirrors, which have the same medium on both sides.
    const R sense = to_film || surface.mirror ? surface.sense : -surface.sense;
    const auto end = [&](RayFate fate) {
      ray.fate = fate;
      ray.surface = static_cast<int>(i);
      return ray;
    };

    Vec<T> n;
    T cosine;
    bool described = true;
    if (surface.asphere < 0) {
      const auto [point, hit, slant] = intersect(surface.quadric, p, ray.direction, sense);
      if (!hit) return end(RayFate::missed_surface);
      p = point;
      n = gradient(surface.quadric, p);
      cosine = slant;
      if (!surface.quadric.sphere) {
        const T scale = R(1) / sqrt(dot(n, n));
        n = n * scale;
        cosine = cosine * scale;
      }
    } else {
      const Asphere<R>& asphere = lens.aspheres[surface.asphere];
      const auto [point, hit, converged, past_rim] = intersect(asphere, p, ray.direction, sense);
      if (!hit) {
        return end(past_rim ? RayFate::vignetted : converged ? RayFate::missed_surface : RayFate::no_convergence);
      }
      p = point;
      n = normal(asphere, p);
      cosine = absolute(dot(ray.direction, n));
      const T x = asphere.base.ax * p.x, y = asphere.base.ay * p.y;
      described = x * x + y * y <= asphere.rim2;
    }
    ray.origin = {p.x, p.y, T(p.z + lens.vertex_z[i])};
    observer(static_cast<int>(i), ray.origin, ray.direction);

    const T r2 = p.x * p.x + p.y * p.y;
    if (path.apertures && !(described && r2 <= surface.semi_diameter_squared && r2 >= surface.obscuration_squared)) {
      return end(RayFate::vignetted);
    }
    if (path.apertures && static_cast<std::int32_t>(i) == lens.stop && !within(lens.iris, p.x, p.y)) {
      return end(RayFate::vignetted);
    }
    if (surface.mirror) {
      ray.direction = reflect(ray.direction, n);
    } else if (interfaces[i].k != R(0)) {  // equal media leave the ray as it is, to the bit
      const auto [refracted, transmitted] = refract(ray.direction, n, cosine, sense, interfaces[i]);
      if (!transmitted) return end(RayFate::totally_reflected);
      ray.direction = refracted;
      bent = true;
    }
    ray.surface = static_cast<int>(i);

    if (to_film) {
      if (++i == last) break;
      p.z = p.z - lens.surfaces[i - 1].gap;
    } else {
      if (i == path.first) break;
      --i;
      p.z = p.z + lens.surfaces[i].gap;
    }
  }
  if (bent) ray.direction = renormalised(ray.direction);
  return ray;
}

}  // namespace petzval::kernel
