// SPDX-License-Identifier: Apache-2.0
// The loops over blocks of rays, compiled once for each instruction set and arithmetic: PETZVAL_TRACER names the
// result, PETZVAL_FAST chooses between Arithmetic::fast and reproducible.
#include "block.hpp"

#include <cstddef>
#include <cstdint>

#include "least_clearance.hpp"
#include "light_left.hpp"
#include "march.hpp"

namespace petzval::trace_detail {
namespace {

/// Arrays from a position on; null pointers stay null.
template <class R, class T>
RayArrays<T> from(const RayArrays<T>& a, std::size_t o) noexcept {
  const auto at = [o](T* p) { return p ? p + o : p; };
  return {at(a.x), at(a.y), at(a.z), at(a.dx), at(a.dy), at(a.dz)};
}

/// Writes fates and surfaces from the tallies.
template <class R>
void report(const BlockJob<R>& job, const Bundle<R>& b, const std::uint8_t* unsettled, std::size_t o) noexcept {
  constexpr int rays = Bundle<R>::rays;
  typename Native<R>::Bit tally[rays];
  __builtin_memcpy(tally, b.tally, sizeof tally);
  // Consecutive steps have consecutive surfaces, ascending or descending.
  const auto steps = static_cast<std::int32_t>(job.steps);
  const std::int32_t first = job.sequence.steps[0].surface;
  const std::int32_t by = first == 0 ? 1 : -1;
  if (job.surfaces) {
    for (int l = 0; l < rays; ++l) {
      const auto passed = static_cast<std::int32_t>(tally[l]) >> 2;
      job.surfaces[o + static_cast<std::size_t>(l)] = first + by * (passed < steps ? passed : steps - 1);
    }
  }
  if (job.fates) {
    for (int l = 0; l < rays; ++l) {
      const auto t = static_cast<std::int32_t>(tally[l]);
      const std::int32_t fate =
          t > 4 * steps ? static_cast<std::int32_t>(RayFate::transmitted) : lost_by(t & 3, unsettled[l] != 0);
      job.fates[o + static_cast<std::size_t>(l)] = static_cast<RayFate>(fate);
    }
  }
}

/// Passes all steps, but ends early if all rays are lost; this is tested at every fourth step.
template <class R, class MediaAt, class Follow>
PETZVAL_INLINE void march(const BlockJob<R>& job, MediaAt&& media_at, std::uint8_t* unsettled, Bundle<R>& b,
                          Follow& follow) {
  for (std::size_t j = 0; j < job.steps; ++j) {
    pass(job, j, media_at(j), unsettled, b, follow);
    if (j % 4 != 3) continue;
    Mask<R> left = b.alive[0];
    for (int i = 1; i < b.used; ++i) left = left | b.alive[i];
    if (!any(left)) return;
  }
}

/// Traces one bundle of a job, from ray `o` on.
/// @param index for each ray, the index in front of the lens
/// @param per_index one over the index behind the lens
/// @param row_at as in LightLeft, for jobs with light
template <class R, class MediaAt, class RowAt>
void trace_bundle(const BlockJob<R>& job, std::size_t o, const R* index, const R* per_index, MediaAt&& media_at,
                  const RowAt& row_at) {
  const auto in = from<R>(job.in, o);
  const auto out = from<R>(job.out, o);
  std::uint8_t unsettled[Bundle<R>::rays] = {};
  Bundle<R> b;
  const std::size_t left = job.rays - o;
  if (left < Bundle<R>::rays) b.used = (static_cast<int>(left) + Lanes<R>::width - 1) / Lanes<R>::width;
  enter(job, in, index, b);
  Mask<R> taken = b.alive[0];
  for (int i = 1; i < b.used; ++i) taken = taken & b.alive[i];
  if (job.tangents_in) {
    TwoTangents<R> tangents;
    enter(job, from<R>(job.tangents_in->u, o), index, tangents.u);
    enter(job, from<R>(job.tangents_in->v, o), index, tangents.v);
    march(job, media_at, unsettled, b, tangents);
    leave(job, in, per_index, b, out);
    leave(job, per_index, b, tangents.u, from<R>(job.tangents_out.u, o));
    leave(job, per_index, b, tangents.v, from<R>(job.tangents_out.v, o));
  } else if (job.clearances) {
    LeastClearance<R> clearance(b);
    march(job, media_at, unsettled, b, clearance);
    leave(job, in, per_index, b, out);
    clearance.leave(b, job.clearances + o);
  } else if (job.light) {
    LightLeft<R, RowAt> light(*job.light, job.travel, row_at);
    march(job, media_at, unsettled, b, light);
    leave(job, in, per_index, b, out);
    light.leave(b, job.transmittances + o);
  } else {
    NoTangents none;
    march(job, media_at, unsettled, b, none);
    leave(job, in, per_index, b, out);
  }
  if (!every(taken)) put_on_axis(job, b.used * Lanes<R>::width, out);
  report(job, b, unsettled, o);
}

/// Looks up numbers by wavelengths in nm: linear between nodes.
template <class R>
class RowsBetween {
  using V = Lanes<R>;

 public:
  /// @param nm wavelengths, one for each ray
  PETZVAL_INLINE RowsBetween(const LightRows<R>& rows, const kernel::SpectralCoordinate<R>& coordinate,
                             const R* nm) noexcept
      : rows_(rows) {
    typename Native<R>::Bit nodes[Bundle<R>::rays];
    for (int l = 0; l < Bundle<R>::rays; ++l) {
      const auto at = light_node(rows, coordinate.scale / nm[l] - coordinate.offset);
      nodes[l] = at.node, fractions_[l] = at.fraction;
    }
    __builtin_memcpy(nodes_, nodes, sizeof nodes);
  }
  PETZVAL_INLINE V operator()(std::uint32_t row, int i) const noexcept {
    const std::size_t at = row * rows_.length;
    return look_up(rows_.values + at, rows_.count, nodes_[i]) +
           load(fractions_ + i * V::width) * look_up(rows_.differences + at, rows_.count, nodes_[i]);
  }

 private:
  LightRows<R> rows_;
  typename Native<R>::Bits nodes_[Bundle<R>::vectors];
  R fractions_[Bundle<R>::rays];
};

template <class R>
void trace_blocks(const BlockJob<R>& job) noexcept {
  constexpr std::size_t rays = Bundle<R>::rays;
  const auto& sequence = job.sequence;
  R index[rays], per_index[rays];
  if (job.spectral) {
    for (std::size_t o = 0; o < job.rays; o += rays) {
      R nm[rays];
      for (std::size_t l = 0; l < rays; ++l) nm[l] = job.each_nm ? static_cast<R>(job.each_nm[o + l]) : job.nm;
      SpectralMedia<R> media(sequence, nm);
      media.indices(job.steps, index, per_index);
      const auto media_at = [&](std::size_t j) { return media.at(j); };
      if (job.light) {
        trace_bundle(job, o, index, per_index, media_at, RowsBetween<R>(job.light->between, sequence.coordinate, nm));
      } else {
        trace_bundle(job, o, index, per_index, media_at, [](std::uint32_t, int) { return Lanes<R>(R(0)); });
      }
    }
    return;
  }
  const LightRows<R> rows_of_light = job.light ? job.light->compiled : LightRows<R>{};
  if (!job.wavelengths) {
    const kernel::RefractionConstants<R>* bends = sequence.bends + job.wavelength * job.steps;
    for (std::size_t l = 0; l < rays; ++l) {
      index[l] = sequence.n_first[job.wavelength];
      per_index[l] = sequence.per_n_last[job.wavelength];
    }
    const R* const light = rows_of_light.values + job.wavelength;
    const std::size_t length = rows_of_light.length;
    for (std::size_t o = 0; o < job.rays; o += rays) {
      trace_bundle(
          job, o, index, per_index, [&](std::size_t j) { return SharedMedia<R>{bends + j}; },
          [=](std::uint32_t row, int) { return Lanes<R>(light[row * length]); });
    }
    return;
  }
  for (std::size_t o = 0; o < job.rays; o += rays) {
    const MediaByRay<R> media(sequence, job.wavelengths + o, job.compiled_wavelengths);
    media.indices(index, per_index);
    trace_bundle(
        job, o, index, per_index, [&](std::size_t j) { return media.at(j); },
        [&](std::uint32_t row, int i) { return media.in_row(rows_of_light.values + row * rows_of_light.length, i); });
  }
}

}  // namespace

const BlockTracer PETZVAL_TRACER{trace_blocks<float>, trace_blocks<double>};

}  // namespace petzval::trace_detail
