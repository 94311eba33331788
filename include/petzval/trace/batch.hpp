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
#include "petzval/trace/iris.hpp"

namespace petzval::inline v0 {

/// How a batch computes. Either way a ray's answer depends on that ray alone, not on its neighbours, the size of the
/// batch or the number of threads.
enum class Arithmetic : std::uint8_t {
  fast,          ///< fused operations and approximate roots with Newton steps, where the processor has them
  reproducible,  ///< IEEE operations only: the same bits from every instruction set and compiler
};

/// "fast" or "reproducible".
PETZVAL_API std::string_view name(Arithmetic arithmetic) noexcept;

/// How to trace a batch.
struct BatchOptions {
  Travel travel = Travel::to_film;
  RayWavelengths wavelengths = {};
  bool apertures = true;  ///< whether clear apertures and the iris clip
  Iris iris = {};         ///< blades in the plane of the stop
  Arithmetic arithmetic = Arithmetic::fast;
  InstructionSet instruction_set = InstructionSet::avx512;  ///< at most: the widest up to it that the processor has
};

/// Traces N rays (double or float) through the whole lens, in blocks of 64 on the lanes of the processor.
///
/// in, out: N each, same order, any alignment (of 64 bytes is fastest); out may be in (the same arrays, not shifted
/// ones). fates and surfaces: N each, or null where not wanted; the surface as in TracedRay. Rays count as whole lines,
/// as for the trace of one ray, and the same rays are refused. A ray that is lost comes back as it went in (at the
/// origin along the axis where it was not finite): every slot of the results is written and finite. A transmitted ray
/// has its point on the last surface met and its new direction.
///
/// Reproducible batches are rays traced one by one, to the bit; fast ones agree with them within 8 eps of what an eps
/// in the ray itself does (tests/trace), fates except as close to an edge. Direction errors by lens: README. No
/// allocation, no threads: give parts of the arrays to parallel_for.
template <class T>
PETZVAL_API void trace(const Lens& lens, std::size_t count, const RayArrays<const T>& in, const RayArrays<T>& out,
                       RayFate* fates, int* surfaces, const BatchOptions& options = {}) noexcept;

/// The same for rays as an array of structures: they are transposed block by block. rays, traced: N each.
template <class T>
PETZVAL_API void trace(const Lens& lens, std::span<const Ray<T>> rays, TracedRay<T>* traced,
                       const BatchOptions& options = {}) noexcept;

}  // namespace petzval::inline v0
