// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// How to trace: the way of travel, the position of the wavelength among the compiled ones, and whether clear apertures
/// clip.
struct TraceOptions {
  Travel travel = Travel::to_film;
  std::size_t wavelength = 0;
  bool apertures = true;
};

/// Traces one ray (double or float) through the whole lens. Sequential: every surface in its order, in either
/// direction.
///
/// ray: lens frame, direction of unit length. It counts as the whole line: surfaces are met in their order, also those
/// behind the origin, so that a ray may start anywhere on its line.
/// A ray that is not finite or whose direction is not of unit length (|d|^2 within 1e-3) counts as missed_surface at
/// the first surface met, and so does every ray at a wavelength that was not compiled; a finite origin and direction
/// come back. Start rays from infinity or far objects near the lens: the rounding of a direction alone moves the hit by
/// eps x distance. Accuracy: double within 1e-13 relative, float within 1e-5, of 60-digit references (tests/trace).
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options = {}) noexcept;

/// Rays as a structure of arrays: N values each, lens frame, unit directions.
template <class T>
struct RayArrays {
  T* x = nullptr;
  T* y = nullptr;
  T* z = nullptr;
  T* dx = nullptr;
  T* dy = nullptr;
  T* dz = nullptr;
};

/// Traces N rays. in, out: N each, same order; out may be in. fates and surfaces: N each, or null where not wanted.
/// Every slot of the results is written and finite.
template <class T>
PETZVAL_API void trace(const Lens& lens, std::size_t count, const RayArrays<const T>& in, const RayArrays<T>& out,
                       RayFate* fates, int* surfaces, const TraceOptions& options = {}) noexcept;

}  // namespace petzval
