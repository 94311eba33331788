// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "petzval/core/config.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval {

/// Options for tracing one ray.
struct TraceOptions {
  Travel travel = Travel::to_film;
  Wavelength wavelength = {};
  bool apertures = true;  ///< true: clear apertures and the iris clip rays
};

/// Traces one ray (double or float) through the whole lens, surface by surface in the order of travel.
///
/// A ray is a whole line: surfaces are met in order, also behind the origin. Start rays of far objects near the lens,
/// because the rounding of a direction moves the hit by eps * distance. Results equal a reproducible batch to the bit;
/// batches are faster for many rays.
///
/// A ray is lost as missed_surface at the first surface if it is not finite, its direction is no unit vector
/// (unit_direction_tolerance), or the lens does not cover its wavelength. The ray is returned unchanged, or along the
/// axis from the origin if it is not finite. A ray is lost as vignetted, with or without apertures, if it meets a
/// surface 1e15 mm from the axis, or so far from the axis that the hit on the next sphere would lose half of its digits
/// (1 / eps^(1/4) of its radii: 8000, float 54).
///
/// @param lens     the lens
/// @param ray      lens frame, mm; unit direction within a few ulp. The result has the same precision, or 1000 eps in
///                 |d|^2 if the ray grazes a surface.
/// @param options  direction of travel, wavelength, apertures
///
/// Accuracy: double within 1e-13 relative, float within 1e-5, against 60-digit references (tests/trace).
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options = {}) noexcept;

/// Traces one ray and calls seen(surface, point) for each hit (lens frame, mm), in the order of travel, up to the hit
/// at which the ray is lost. The result equals trace() without `seen`, to the bit.
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options,
                               const std::function<void(int surface, const Vec3<T>& point)>& seen);

/// Arithmetic of a batch. Both kinds give results independent of the other rays, the batch size and the number of
/// threads.
enum class Arithmetic : std::uint8_t {
  fast,          ///< fused operations and approximate roots with Newton steps, if the processor has them; to 1e15 mm
  reproducible,  ///< IEEE operations only: the same bits from every instruction set and compiler
};

/// "fast" or "reproducible".
PETZVAL_API std::string_view name(Arithmetic arithmetic) noexcept;

/// Options for tracing a batch.
struct BatchOptions {
  Travel travel = Travel::to_film;
  RayWavelengths wavelengths = {};
  bool apertures = true;  ///< true: clear apertures and the iris clip rays
  Arithmetic arithmetic = Arithmetic::fast;
};

/// Traces N rays (double or float) through the whole lens, in blocks of 64 on the lanes of the processor.
///
/// Rays are whole lines, and invalid rays are lost, as in trace() of one ray. A transmitted ray has its origin on the
/// last surface and its new direction. A lost ray is returned unchanged, or along the axis from the origin if it is not
/// finite, so that all results are finite. The function does not allocate and starts no threads: use parallel_for.
///
/// @param lens      the lens
/// @param count     N
/// @param in        N rays, any alignment (64 bytes is fastest)
/// @param out       N rays in the same order; may be `in`, but must not overlap it otherwise
/// @param fates     N fates, or null
/// @param surfaces  N surfaces as in TracedRay, or null
/// @param options   wavelengths are positions, or nm between compiled ones (Lens::index_error), which take 5 to 25 %
///                  more time than a single wavelength
///
/// Accuracy: reproducible batches equal rays traced one by one, to the bit. Fast batches differ by at most 8 times the
/// effect of a relative error eps in the ray (tests/trace), and in fates only within this distance of an edge.
template <class T>
PETZVAL_API void trace(const Lens& lens, std::size_t count, const RayArrays<const T>& in, const RayArrays<T>& out,
                       RayFate* fates, int* surfaces, const BatchOptions& options = {}) noexcept;

/// Traces an array of structures, transposed block by block; writes traced[0] to traced[rays.size() - 1].
template <class T>
PETZVAL_API void trace(const Lens& lens, std::span<const Ray<T>> rays, TracedRay<T>* traced,
                       const BatchOptions& options = {}) noexcept;

/// Derivatives of the origins and directions of N rays by two parameters u and v, such as raster x and y.
template <class T>
struct RayTangents {
  RayArrays<T> u, v;
};

/// Traces N rays with their exact derivatives (double or float), by the chain rule through every surface.
///
/// Rays equal the results of trace(): to the bit if reproducible, else within some ulp.
///
/// @param lens          the lens
/// @param count         N
/// @param in            as in trace()
/// @param tangents_in   derivatives of `in`; derivatives of a direction must be perpendicular to this direction
/// @param out           as in trace()
/// @param tangents_out  derivatives of the point and the unit direction behind the last surface; 0 for a lost ray, not
///                      finite for a ray that leaves exactly along a surface; may be `tangents_in`
/// @param fates         as in trace()
/// @param surfaces      as in trace()
/// @param options       as in trace()
template <class T>
PETZVAL_API void trace_differentials(const Lens& lens, std::size_t count, const RayArrays<const T>& in,
                                     const RayTangents<const T>& tangents_in, const RayArrays<T>& out,
                                     const RayTangents<T>& tangents_out, RayFate* fates, int* surfaces,
                                     const BatchOptions& options = {}) noexcept;

}  // namespace petzval
