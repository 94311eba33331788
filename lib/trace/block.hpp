// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "petzval/trace/differentials.hpp"
#include "petzval/trace/iris.hpp"

namespace petzval::inline v0::trace_detail {

/// Rays in a block: so many that the latency of a root is hidden behind the others.
inline constexpr int block_rays = 64;

/// A ray before an asphere: vertex frame of the lens, direction of unit length.
template <class R>
struct BeforeAsphere {
  R x, y, z, dx, dy, dz;
};

enum class Found : std::uint8_t { hit, miss, beside, no_convergence };

/// Looks for the hit where the iteration over lanes is not sure of it; puts the point in the place of the ray's.
template <class R>
using AsphereSearch = Found (*)(const kernel::Asphere<R>& asphere, R sense, BeforeAsphere<R>& ray);

/// What the loops over blocks are to do: plain data. Every array holds `blocks` times block_rays values.
template <class R>
struct BlockJob {
  kernel::SurfaceSequence<R> course;
  std::size_t steps = 0;
  const kernel::Asphere<R>* aspheres = nullptr;
  AsphereSearch<R> search = nullptr;
  std::size_t wavelength = 0, compiled_wavelengths = 1;
  const std::uint16_t* wavelengths = nullptr;  ///< of each ray, or null
  bool apertures = true;
  Iris iris;
  std::size_t blocks = 0;
  RayArrays<const R> in;
  RayArrays<R> out;
  RayFate* fates = nullptr;                           ///< or null
  int* surfaces = nullptr;                            ///< or null
  const RayTangents<const R>* tangents_in = nullptr;  ///< null: no derivatives
  RayTangents<R> tangents_out;
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

}  // namespace petzval::inline v0::trace_detail
