// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"
#include "petzval/trace/iris.hpp"

namespace petzval::inline v0 {

/// How to trace one ray.
struct TraceOptions {
  Travel travel = Travel::to_film;
  Wavelength wavelength = {};
  bool apertures = true;  ///< whether clear apertures and the iris clip
  Iris iris = {};         ///< blades in the plane of the stop
};

/// Traces one ray (double or float) through the whole lens. Sequential: every surface in its order, in either
/// direction.
///
/// ray: lens frame, direction of unit length (within a few ulp, and so is what comes out). It counts as the whole line:
/// surfaces are met in their order, also those behind the origin, so that a ray may start anywhere on its line. A ray
/// that is not finite or whose direction is not of unit length (|d|^2 within 1e-3) counts as missed_surface at the
/// first surface met, and so does every ray at a wavelength that was not compiled; it comes back as it went in, or
/// where that was not finite at the origin along the axis. Start rays from infinity or far objects near the lens: the
/// rounding of a direction alone moves the hit by eps x distance. The arithmetic is that of reproducible batches, to
/// the bit; many rays are faster in a batch. Accuracy: double within 1e-13 relative, float within 1e-5, of 60-digit
/// references (tests/trace).
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options = {}) noexcept;

/// The same, to the bit, with a look at the way: seen(surface, point) for each hit in the order of travel, lens frame,
/// up to the one that ends the ray.
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options,
                               const std::function<void(int surface, const Vec3<T>& point)>& seen);

}  // namespace petzval::inline v0
