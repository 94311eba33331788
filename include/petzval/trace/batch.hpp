// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/instruction_set.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval::inline v0 {

/// Arithmetic of a batch. Either way the result of a ray depends on that ray alone, not on its neighbours, the size of
/// the batch or the number of threads.
enum class Arithmetic : std::uint8_t {
  fast,          ///< fused operations and approximate roots with Newton steps, if the processor has them
  reproducible,  ///< IEEE operations only: the same bits from every instruction set and compiler
};

/// "fast" or "reproducible".
PETZVAL_API std::string_view name(Arithmetic arithmetic) noexcept;

/// How to trace a batch.
struct BatchOptions {
  Travel travel = Travel::to_film;
  RayWavelengths wavelengths = {};
  bool apertures = true;  ///< whether clear apertures and the iris clip
  Arithmetic arithmetic = Arithmetic::fast;
  InstructionSet instruction_set = InstructionSet::avx512;  ///< the widest to use, if the processor has it
};

/// Traces N rays (double or float) through the whole lens, in blocks of 64 on the lanes of the processor.
///
/// in, out: N each, same order, any alignment (64 bytes is fastest); out may be in (the same arrays, not shifted ones).
/// fates and surfaces: N each, or null; the surface as in TracedRay. Rays are whole lines, and invalid rays are lost,
/// as in the trace of one ray. A lost ray is returned as it was given (one that is not finite: at the origin along the
/// axis), so that every result is written and finite. A transmitted ray has its point on the last surface met and its
/// new direction.
///
/// Reproducible batches equal rays traced one by one, to the bit. Fast ones differ by at most 8 times the effect of a
/// relative error eps in the ray itself (tests/trace), and in fates only as close to an edge. No allocation and no
/// threads: give parts of the arrays to parallel_for.
template <class T>
PETZVAL_API void trace(const Lens& lens, std::size_t count, const RayArrays<const T>& in, const RayArrays<T>& out,
                       RayFate* fates, int* surfaces, const BatchOptions& options = {}) noexcept;

/// The same for an array of structures, which is transposed block by block. rays, traced: N each.
template <class T>
PETZVAL_API void trace(const Lens& lens, std::span<const Ray<T>> rays, TracedRay<T>* traced,
                       const BatchOptions& options = {}) noexcept;

}  // namespace petzval::inline v0
