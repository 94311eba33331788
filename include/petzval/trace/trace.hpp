// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/instruction_set.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// How to trace one ray.
struct TraceOptions {
  Travel travel = Travel::to_film;
  Wavelength wavelength = {};
  bool apertures = true;  ///< whether clear apertures and the iris clip
};

/// Traces one ray (double or float) through the whole lens, surface by surface in the order of travel.
///
/// ray: lens frame, unit direction (within a few ulp, and so is the result, but within 1000 eps of |d|^2 where the ray
/// grazes a surface). A ray is a whole line: surfaces are met in their order, also those behind the origin, so that it
/// may start anywhere on its line. A ray that is not finite, whose direction is no unit vector
/// (unit_direction_tolerance), or whose wavelength the lens does not cover is lost as missed_surface at the first
/// surface met. It is returned as it was given (one that is not finite: at the origin along the axis). A ray that meets
/// a surface so far from the axis that the hit on the next sphere would lose half of its digits (1 / eps^(1/4) of its
/// radii: 8000, float 54), or 1e15 mm from it, is lost there as vignetted, apertures or none. Start rays of far objects
/// near the lens: the rounding of a direction moves the hit by eps x distance. The arithmetic is that of reproducible
/// batches, to the bit; batches are faster for many rays. Accuracy: double within 1e-13 relative, float within 1e-5, of
/// 60-digit references (tests/trace).
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options = {}) noexcept;

/// The same, to the bit. Calls seen(surface, point) for each hit in the order of travel, lens frame, up to the one
/// where the ray is lost.
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options,
                               const std::function<void(int surface, const Vec3<T>& point)>& seen);

/// Arithmetic of a batch. Either way the result of a ray depends on that ray alone, not on its neighbours, the size of
/// the batch or the number of threads.
enum class Arithmetic : std::uint8_t {
  fast,          ///< fused operations and approximate roots with Newton steps, if the processor has them; to 1e15 mm
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
/// options.wavelengths: positions, or nm between compiled ones (Lens::index_error), for 5 to 25 % more time than one
/// wavelength takes. fates and surfaces: N each, or null; the surface as in TracedRay. Rays are whole lines, and
/// invalid rays are lost, as in the trace of one ray. A lost ray is returned as it was given (one that is not finite:
/// at the origin along the axis), so that every result is written and finite. A transmitted ray has its point on the
/// last surface met and its new direction.
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

/// Derivatives of the points and directions of N rays by two parameters u and v, such as the steps of a pixel; N values
/// each.
template <class T>
struct RayTangents {
  RayArrays<T> u, v;
};

/// Traces N rays with their exact derivatives (double or float), by the chain rule through every surface. There is no
/// step to choose.
///
/// in, out, fates, surfaces, options: as for `trace`. The rays are those of `trace`: to the bit if reproducible, else
/// within some ulp. tangents_in: derivatives of directions are perpendicular to them, as those of unit vectors are.
/// tangents_out: derivatives of the point on the last surface met and of the unit direction behind it; zero for a lost
/// ray, not finite for a ray that leaves exactly along a surface. out may be in, and tangents_out tangents_in.
template <class T>
PETZVAL_API void trace_differentials(const Lens& lens, std::size_t count, const RayArrays<const T>& in,
                                     const RayTangents<const T>& tangents_in, const RayArrays<T>& out,
                                     const RayTangents<T>& tangents_out, RayFate* fates, int* surfaces,
                                     const BatchOptions& options = {}) noexcept;

}  // namespace petzval
