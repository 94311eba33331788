// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "lens/lens_view.hpp"
#include "light_view.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// Number of rays in a block: enough to hide the latency of square roots.
inline constexpr int block_rays = 64;

/// A path through a lens, for one ray or a batch.
template <class R>
struct Route {
  kernel::SurfaceSequence<R> sequence;
  std::size_t steps = 0;
  const kernel::Asphere<R>* aspheres = nullptr;
  std::size_t wavelength = 0;
  bool spectral = false;  ///< true if `nm` replaces `wavelength`
  R nm = 0;
  bool apertures = true;
  std::span<const kernel::StopEdge<R>> iris{};
};

/// Input and output of the loops over blocks. Every array holds `rays` values, rounded up to whole blocks.
template <class R>
struct BlockJob : Route<R> {
  Travel travel = Travel::to_film;
  std::size_t compiled_wavelengths = 1;
  const std::uint16_t* wavelengths = nullptr;  ///< by ray, or null
  const float* each_nm = nullptr;              ///< by ray, or null
  std::size_t rays = 0;
  RayArrays<const R> in;
  RayArrays<R> out;
  RayFate* fates = nullptr;                           ///< or null
  int* surfaces = nullptr;                            ///< or null
  const RayTangents<const R>* tangents_in = nullptr;  ///< null: no derivatives
  RayTangents<R> tangents_out;
  R* clearances = nullptr;              ///< or null; not with derivatives
  const LightView<R>* light = nullptr;  ///< or null; with `transmittances`, not with derivatives or clearances
  R* transmittances = nullptr;
};

template <class R>
using TraceBlocks = void (*)(const BlockJob<R>&) noexcept;

/// The same loops, compiled for each instruction set and arithmetic (block.cpp).
struct BlockTracer {
  TraceBlocks<float> single;
  TraceBlocks<double> twice;
};

extern const BlockTracer baseline;
#if defined(__x86_64__)
extern const BlockTracer avx2_fast, avx2_reproducible, avx512_fast, avx512_reproducible;
#endif

}  // namespace petzval::trace_detail
