// SPDX-License-Identifier: Apache-2.0
#include "petzval/trace/trace.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "block.hpp"
#include "clearances.hpp"
#include "core/instruction_set.hpp"
#include "lens/lens_view.hpp"
#include "lens_light.hpp"
#include "route.hpp"

namespace petzval {
namespace {

using trace_detail::block_rays;
using trace_detail::BlockJob;

constexpr std::size_t block = block_rays;

const trace_detail::BlockTracer& tracer([[maybe_unused]] Arithmetic arithmetic) noexcept {
#if defined(__x86_64__)
  const bool fast = arithmetic == Arithmetic::fast;
  switch (batch_instruction_set()) {
    case InstructionSet::avx512: return fast ? trace_detail::avx512_fast : trace_detail::avx512_reproducible;
    case InstructionSet::avx2: return fast ? trace_detail::avx2_fast : trace_detail::avx2_reproducible;
    case InstructionSet::baseline: break;
  }
#endif
  return trace_detail::baseline;
}

template <class R>
trace_detail::TraceBlocks<R> loops(const trace_detail::BlockTracer& tracer) noexcept {
  if constexpr (sizeof(R) == sizeof(float)) {
    return tracer.single;
  } else {
    return tracer.twice;
  }
}

/// Ignores the wavelength of the batch if each ray has its own wavelength.
template <class R>
BlockJob<R> job_for(const Lens& lens, const BatchOptions& options) noexcept {
  const auto& view = kernel::view<R>(lens);
  const auto& [all, each, each_nm] = options.wavelengths;
  BlockJob<R> job;
  static_cast<trace_detail::Route<R>&>(job) =
      trace_detail::route_of<R>(view, options, each || each_nm ? Wavelength(0) : all);
  job.travel = options.travel;
  job.compiled_wavelengths = view.wavelengths;
  job.wavelengths = each;
  job.each_nm = each_nm;
  job.spectral = options.wavelengths.in_nm();
  return job;
}

/// Memory for a block of rays and their derivatives: for the last rays of a batch and for arrays of structures.
template <class R>
struct Block {
  alignas(64) std::array<std::array<R, block>, 18> v;
  std::array<R, block> clearances, transmittances;
  std::array<RayFate, block> fates;
  std::array<int, block> surfaces;
  std::array<std::uint16_t, block> wavelengths{};
  std::array<float, block> nm{};

  /// Unused rays are placed on the axis.
  explicit Block(bool with_tangents = false) noexcept {
    for (std::size_t k = 0; k < (with_tangents ? 18 : 6); ++k) v[k].fill(R(0));
    v[5].fill(R(1));
  }

  template <class T = R>
  RayArrays<T> arrays(std::size_t first = 0) noexcept {
    const auto at = [&](std::size_t k) { return v[first + k].data(); };
    return {at(0), at(1), at(2), at(3), at(4), at(5)};
  }
  template <class T = R>
  RayTangents<T> tangents() noexcept {
    return {arrays<T>(6), arrays<T>(12)};
  }
};

template <class T>
std::array<T*, 6> pointers(const RayArrays<T>& a) noexcept {
  return {a.x, a.y, a.z, a.dx, a.dy, a.dz};
}

template <class T, class R>
void copy(std::size_t count, const RayArrays<T>& from, std::size_t begin, const RayArrays<R>& to,
          std::size_t to_begin) noexcept {
  for (std::size_t k = 0; k < 6; ++k) std::copy_n(pointers(from)[k] + begin, count, pointers(to)[k] + to_begin);
}

/// Directs a job to the first `count` rays of a block.
template <class R>
void use(Block<R>& rays, std::size_t count, BlockJob<R>& job) noexcept {
  job.rays = count;
  job.in = rays.template arrays<const R>();
  job.out = rays.arrays();
  job.fates = rays.fates.data();
  job.surfaces = rays.surfaces.data();
  if (job.wavelengths) job.wavelengths = rays.wavelengths.data();
  if (job.each_nm) job.each_nm = rays.nm.data();
}

template <class R>
void copy_wavelengths(std::size_t count, const RayWavelengths& from, std::size_t begin, Block<R>& to) noexcept {
  if (from.each) std::copy_n(from.each + begin, count, to.wavelengths.begin());
  if (from.each_nm) std::copy_n(from.each_nm + begin, count, to.nm.begin());
}

template <class R>
void trace_all(const Lens& lens, std::size_t count, const RayArrays<const R>& in,
               const RayTangents<const R>* tangents_in, const RayArrays<R>& out, const RayTangents<R>& tangents_out,
               RayFate* fates, int* surfaces, const BatchOptions& options, R* clearances = nullptr,
               const trace_detail::LightView<R>* light = nullptr, R* transmittances = nullptr) noexcept {
  const auto trace_blocks = loops<R>(tracer(options.arithmetic));
  auto job = job_for<R>(lens, options);
  job.rays = count - count % block;
  job.in = in;
  job.out = out;
  job.fates = fates;
  job.surfaces = surfaces;
  job.tangents_in = tangents_in;
  job.tangents_out = tangents_out;
  job.clearances = clearances;
  job.light = light;
  job.transmittances = transmittances;
  trace_blocks(job);

  const std::size_t done = job.rays, rest = count - done;
  if (rest == 0) return;
  Block<R> last(tangents_in != nullptr);
  copy(rest, in, done, last.arrays(), 0);
  copy_wavelengths(rest, options.wavelengths, done, last);
  use(last, rest, job);
  const auto tangents = last.template tangents<const R>();
  if (tangents_in) {
    copy(rest, tangents_in->u, done, last.arrays(6), 0);
    copy(rest, tangents_in->v, done, last.arrays(12), 0);
    job.tangents_in = &tangents;
    job.tangents_out = last.tangents();
  }
  if (clearances) job.clearances = last.clearances.data();
  job.transmittances = last.transmittances.data();
  trace_blocks(job);
  copy(rest, last.arrays(), 0, out, done);
  if (tangents_in) {
    copy(rest, last.arrays(6), 0, tangents_out.u, done);
    copy(rest, last.arrays(12), 0, tangents_out.v, done);
  }
  if (clearances) std::copy_n(last.clearances.begin(), rest, clearances + done);
  if (light) std::copy_n(last.transmittances.begin(), rest, transmittances + done);
  if (fates) std::copy_n(last.fates.begin(), rest, fates + done);
  if (surfaces) std::copy_n(last.surfaces.begin(), rest, surfaces + done);
}

}  // namespace

template <class T>
void trace_detail::clearances(const Lens& lens, std::size_t count, const RayArrays<T>& rays, T* clearances,
                              const BatchOptions& options) noexcept {
  const RayArrays<const T> in{rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz};
  trace_all<T>(lens, count, in, nullptr, rays, {}, nullptr, nullptr, options, clearances);
}

template <class T>
void trace_detail::trace_light(const Lens& lens, const LensLight& light, std::size_t count,
                               const RayArrays<const T>& in, const RayArrays<T>& out, RayFate* fates, T* transmittances,
                               const BatchOptions& options) noexcept {
  trace_all<T>(lens, count, in, nullptr, out, {}, fates, nullptr, options, nullptr, &light.view<T>(), transmittances);
}

std::string_view name(Arithmetic arithmetic) noexcept {
  return arithmetic == Arithmetic::fast ? "fast" : "reproducible";
}

template <class T>
void trace(const Lens& lens, std::size_t count, const RayArrays<const T>& in, const RayArrays<T>& out, RayFate* fates,
           int* surfaces, const BatchOptions& options) noexcept {
  trace_all<T>(lens, count, in, nullptr, out, {}, fates, surfaces, options);
}

template <class T>
void trace_differentials(const Lens& lens, std::size_t count, const RayArrays<const T>& in,
                         const RayTangents<const T>& tangents_in, const RayArrays<T>& out,
                         const RayTangents<T>& tangents_out, RayFate* fates, int* surfaces,
                         const BatchOptions& options) noexcept {
  trace_all<T>(lens, count, in, &tangents_in, out, tangents_out, fates, surfaces, options);
}

template <class T>
void trace(const Lens& lens, std::span<const Ray<T>> rays, TracedRay<T>* traced, const BatchOptions& options) noexcept {
  const auto trace_blocks = loops<T>(tracer(options.arithmetic));
  auto job = job_for<T>(lens, options);
  Block<T> buffers;
  use(buffers, block, job);
  const auto& [x, y, z, dx, dy, dz] = buffers.arrays();
  for (std::size_t begin = 0; begin < rays.size(); begin += block) {
    const std::size_t count = std::min(block, rays.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [origin, direction] = rays[begin + i];
      x[i] = origin.x, y[i] = origin.y, z[i] = origin.z;
      dx[i] = direction.x, dy[i] = direction.y, dz[i] = direction.z;
    }
    copy_wavelengths(count, options.wavelengths, begin, buffers);
    job.rays = count;
    trace_blocks(job);
    for (std::size_t i = 0; i < count; ++i) {
      traced[begin + i] = {{{x[i], y[i], z[i]}, {dx[i], dy[i], dz[i]}}, buffers.fates[i], buffers.surfaces[i]};
    }
  }
}

template PETZVAL_API void trace(const Lens&, std::size_t, const RayArrays<const float>&, const RayArrays<float>&,
                                RayFate*, int*, const BatchOptions&) noexcept;
template PETZVAL_API void trace(const Lens&, std::size_t, const RayArrays<const double>&, const RayArrays<double>&,
                                RayFate*, int*, const BatchOptions&) noexcept;
template PETZVAL_API void trace_detail::clearances(const Lens&, std::size_t, const RayArrays<double>&, double*,
                                                   const BatchOptions&) noexcept;
template PETZVAL_API void trace_detail::trace_light(const Lens&, const LensLight&, std::size_t,
                                                    const RayArrays<const float>&, const RayArrays<float>&, RayFate*,
                                                    float*, const BatchOptions&) noexcept;
template PETZVAL_API void trace_detail::trace_light(const Lens&, const LensLight&, std::size_t,
                                                    const RayArrays<const double>&, const RayArrays<double>&, RayFate*,
                                                    double*, const BatchOptions&) noexcept;
template PETZVAL_API void trace_differentials(const Lens&, std::size_t, const RayArrays<const float>&,
                                              const RayTangents<const float>&, const RayArrays<float>&,
                                              const RayTangents<float>&, RayFate*, int*, const BatchOptions&) noexcept;
template PETZVAL_API void trace_differentials(const Lens&, std::size_t, const RayArrays<const double>&,
                                              const RayTangents<const double>&, const RayArrays<double>&,
                                              const RayTangents<double>&, RayFate*, int*, const BatchOptions&) noexcept;
template PETZVAL_API void trace(const Lens&, std::span<const Ray<float>>, TracedRay<float>*,
                                const BatchOptions&) noexcept;
template PETZVAL_API void trace(const Lens&, std::span<const Ray<double>>, TracedRay<double>*,
                                const BatchOptions&) noexcept;

}  // namespace petzval
