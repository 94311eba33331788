// SPDX-License-Identifier: Apache-2.0
// Traces one ray: a batch with a single lane that returns as soon as the ray is lost and reports the surface.
#define PETZVAL_ONE_LANE
#define PETZVAL_FAST 0

#include "petzval/trace/trace.hpp"

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "lens/lens_view.hpp"
#include "lens_light.hpp"
#include "light_left.hpp"
#include "march.hpp"
#include "route.hpp"
#include "trace_differential.hpp"

namespace petzval {
namespace trace_detail {
namespace {

/// Converts to position and direction in the lens frame.
template <class R>
Ray<R> in_lens_frame(const Bundle<R>& b, R z, R pz, const kernel::Step<R>& s, R vertex_z, R per_n) noexcept {
  const Vec3<R> d{per_n * b.px[0].v, per_n * b.py[0].v, s.sense * (per_n * pz)};
  const R scale = R(1.5) - R(0.5) * (d.x * d.x + d.y * d.y + d.z * d.z);
  return {{b.x[0].v, b.y[0].v, s.sense * z + vertex_z}, d * scale};
}

/// z of the hit in the frame in front of the step.
template <class R>
R z_before_turning(const kernel::Step<R>& s, const Bundle<R>& behind) noexcept {
  return s.mirror ? -behind.z[0].v : behind.z[0].v;
}

/// Copies a ray if all its values are finite.
template <class R>
void keep_finite(const Ray<R>& found, Ray<R>& ray) noexcept {
  using kernel::finite;
  const auto& [o, d] = found;
  if (finite(o.x) && finite(o.y) && finite(o.z) && finite(d.x) && finite(d.y) && finite(d.z)) ray = found;
}

/// Sets the end of a ray that was lost at step j.
/// @param per_n2 one over the squared index in front of the step
/// @param before, after the states in front of the step and behind it, copied so that the values stay in registers
template <class R>
void set_lost_end(const Route<R>& route, const R* vertex_z, std::size_t j, R per_n2, bool unsettled, Bundle<R> before,
                  Bundle<R> after, TracedRay<R>& end) noexcept {
  const kernel::Step<R>& s = route.sequence.steps[j];
  const auto tally = after.tally[0] - static_cast<std::int32_t>(4 * j);
  end.fate = static_cast<RayFate>(lost_by(tally, unsettled));
  end.surface = s.surface;
  const R per_n = std::sqrt(per_n2);
  if (j > 0) {
    const auto last = route.sequence.steps[j - 1].surface;
    keep_finite(in_lens_frame(before, before.z[0].v, before.pz[0].v, s, vertex_z[last], per_n), end.ray);
  }
  if (tally > 0) {
    const R z = z_before_turning(s, after);
    before.x[0] = after.x[0];
    before.y[0] = after.y[0];
    keep_finite(in_lens_frame(before, z, before.pz[0].v, s, vertex_z[s.surface], per_n), end.ray);
  }
}

/// Derivatives of a ray; the trace replaces them by the derivatives behind the lens.
template <class R>
struct RayBy {
  Ray<R>&u, &v;
};
/// The light that a ray keeps; the trace sets `left`.
template <class R>
struct LightOfRay {
  const LightView<R>& view;
  R& left;
};
struct NoDerivatives {};

template <class T, class R>
RayArrays<T> arrays_of(R& ray) noexcept {
  auto& [o, d] = ray;
  return {&o.x, &o.y, &o.z, &d.x, &d.y, &d.z};
}

/// @param index, per_index the index in front of the lens, and one over the index behind the lens
/// @param media_at called once for each step, in order
/// @param follow the follower for `by`
template <class R, class Seen, class By, class MediaAt, class Follow>
TracedRay<R> trace_one(const Route<R>& route, const R* vertex_z, const Ray<R>& ray, const Seen& seen, const By& by,
                       R index, R per_index, MediaAt&& media_at, Follow follow) {
  constexpr bool derivatives = std::is_same_v<By, RayBy<R>>, lit = std::is_same_v<By, LightOfRay<R>>;
  const auto& sequence = route.sequence;
  TracedRay<R> end{ray, RayFate::missed_surface, sequence.steps[0].surface};
  auto& [origin, direction] = end.ray;
  const RayArrays<R> own{&origin.x, &origin.y, &origin.z, &direction.x, &direction.y, &direction.z};
  const RayArrays<const R> in = arrays_of<const R>(ray);
  Bundle<R> b;
  enter(route, in, &index, b);
  if (!any(b.alive[0])) {
    put_on_axis(route, 1, own);
    return end;
  }
  std::uint8_t unsettled = 0;
  if constexpr (derivatives) {
    enter(route, arrays_of<const R>(by.u), &index, follow.u);
    enter(route, arrays_of<const R>(by.v), &index, follow.v);
  }
  for (std::size_t j = 0; j < route.steps; ++j) {
    const Bundle<R> before = b;
    const auto media = media_at(j);
    pass(route, j, media, &unsettled, b, follow);
    if constexpr (!std::is_null_pointer_v<Seen>) {
      const kernel::Step<R>& s = sequence.steps[j];
      const Vec3<R> point{b.x[0].v, b.y[0].v, s.sense * z_before_turning(s, b) + vertex_z[s.surface]};
      const bool hit = b.tally[0] > static_cast<std::int32_t>(4 * j);
      if (hit && kernel::finite(point.x) && kernel::finite(point.y) && kernel::finite(point.z)) seen(s.surface, point);
    }
    if (!any(b.alive[0])) {
      set_lost_end(route, vertex_z, j, media.per_n2(0).v, unsettled != 0, before, b, end);
      return end;
    }
  }
  leave(route, in, &per_index, b, own);
  if constexpr (lit) follow.leave(b, &by.left);
  if constexpr (derivatives) {
    leave(route, &per_index, b, follow.u, arrays_of<R>(by.u));
    leave(route, &per_index, b, follow.v, arrays_of<R>(by.v));
  }
  end.surface = sequence.steps[route.steps - 1].surface;
  if (any(b.alive[0])) end.fate = RayFate::transmitted;
  return end;
}

template <class R, class Seen, class By>
TracedRay<R> trace_one(const Lens& lens, const Ray<R>& ray, const TraceOptions& options, const Seen& seen,
                       const By& by) {
  const auto& view = kernel::view<R>(lens);
  const auto route = route_of<R>(view, options, options.wavelength);
  const auto& sequence = route.sequence;
  // Calls of_follower with a follower for `by`.
  const auto follow = [&](const auto& row_at, const auto& of_follower) {
    if constexpr (std::is_same_v<By, LightOfRay<R>>) {
      return of_follower(LightLeft<R, std::remove_cvref_t<decltype(row_at)>>(by.view, options.travel, row_at));
    } else {
      return of_follower(std::conditional_t<std::is_same_v<By, RayBy<R>>, TwoTangents<R>, NoTangents>());
    }
  };
  LightRows<R> rows;
  if (route.spectral) {
    SpectralMedia<R> media(sequence, &route.nm);
    R index, per_index;
    media.indices(route.steps, &index, &per_index);
    LightNode<R> at;
    if constexpr (std::is_same_v<By, LightOfRay<R>>) {
      rows = by.view.between;
      at = light_node(rows, sequence.coordinate.at(route.nm));
    }
    const auto row_at = [&](std::uint32_t row, int) {
      const std::size_t node = row * rows.length + static_cast<std::size_t>(at.node);
      return Lanes<R>(rows.values[node] + at.fraction * rows.differences[node]);
    };
    return follow(row_at, [&](auto follower) {
      return trace_one(
          route, view.vertex_z, ray, seen, by, index, per_index, [&](std::size_t j) { return media.at(j); }, follower);
    });
  }
  const kernel::RefractionConstants<R>* bends = sequence.bends + route.wavelength * route.steps;
  if constexpr (std::is_same_v<By, LightOfRay<R>>) rows = by.view.compiled;
  const auto row_at = [&](std::uint32_t row, int) {
    return Lanes<R>(rows.values[row * rows.length + route.wavelength]);
  };
  return follow(row_at, [&](auto follower) {
    return trace_one(
        route, view.vertex_z, ray, seen, by, sequence.n_first[route.wavelength], sequence.per_n_last[route.wavelength],
        [&](std::size_t j) { return SharedMedia<R>{bends + j}; }, follower);
  });
}

}  // namespace

template <class T>
TracedRay<T> trace_differential(const Lens& lens, const Ray<T>& ray, Ray<T>& by_u, Ray<T>& by_v,
                                const TraceOptions& options) noexcept {
  return trace_one(lens, ray, options, nullptr, RayBy<T>{by_u, by_v});
}
template PETZVAL_API TracedRay<float> trace_differential(const Lens&, const Ray<float>&, Ray<float>&, Ray<float>&,
                                                         const TraceOptions&) noexcept;
template PETZVAL_API TracedRay<double> trace_differential(const Lens&, const Ray<double>&, Ray<double>&, Ray<double>&,
                                                          const TraceOptions&) noexcept;

template <class T>
TracedRay<T> trace_light(const Lens& lens, const LensLight& light, const Ray<T>& ray, T& transmittance,
                         const TraceOptions& options) noexcept {
  transmittance = 0;
  return trace_one(lens, ray, options, nullptr, LightOfRay<T>{light.view<T>(), transmittance});
}
template PETZVAL_API TracedRay<float> trace_light(const Lens&, const LensLight&, const Ray<float>&, float&,
                                                  const TraceOptions&) noexcept;
template PETZVAL_API TracedRay<double> trace_light(const Lens&, const LensLight&, const Ray<double>&, double&,
                                                   const TraceOptions&) noexcept;

}  // namespace trace_detail

template <class T>
TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options) noexcept {
  return trace_detail::trace_one(lens, ray, options, nullptr, trace_detail::NoDerivatives{});
}

template <class T>
TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options,
                   const std::function<void(int, const Vec3<T>&)>& seen) {
  return seen ? trace_detail::trace_one(lens, ray, options, seen, trace_detail::NoDerivatives{})
              : trace(lens, ray, options);
}

template PETZVAL_API TracedRay<float> trace(const Lens&, const Ray<float>&, const TraceOptions&) noexcept;
template PETZVAL_API TracedRay<double> trace(const Lens&, const Ray<double>&, const TraceOptions&) noexcept;
template PETZVAL_API TracedRay<float> trace(const Lens&, const Ray<float>&, const TraceOptions&,
                                            const std::function<void(int, const Vec3<float>&)>&);
template PETZVAL_API TracedRay<double> trace(const Lens&, const Ray<double>&, const TraceOptions&,
                                             const std::function<void(int, const Vec3<double>&)>&);

}  // namespace petzval
