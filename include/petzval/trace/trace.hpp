// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/lens/wavelength.hpp"

namespace petzval::inline v0 {

/// How to trace one ray.
struct TraceOptions {
  Travel travel = Travel::to_film;
  Wavelength wavelength = {};
  bool apertures = true;  ///< whether clear apertures and the iris clip
};

/// Traces one ray (double or float) through the whole lens, surface by surface in the order of travel.
///
/// ray: lens frame, unit direction (within a few ulp, and so is the result). A ray is a whole line: surfaces are met in
/// their order, also those behind the origin, so that it may start anywhere on its line. A ray that is not finite,
/// whose direction is not of unit length (|d|^2 within 1e-3), or whose wavelength was not compiled is lost as
/// missed_surface at the first surface met. It is returned as it was given (one that is not finite: at the origin along
/// the axis). Start rays of far objects near the lens: the rounding of a direction moves the hit by eps x distance. The
/// arithmetic is that of reproducible batches, to the bit; batches are faster for many rays. Accuracy: double within
/// 1e-13 relative, float within 1e-5, of 60-digit references (tests/trace).
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options = {}) noexcept;

/// The same, to the bit. Calls seen(surface, point) for each hit in the order of travel, lens frame, up to the one
/// where the ray is lost.
template <class T>
PETZVAL_API TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options,
                               const std::function<void(int surface, const Vec3<T>& point)>& seen);

}  // namespace petzval::inline v0
