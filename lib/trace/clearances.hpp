// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/lens/lens.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// Computes how close rays pass to the rims: not negative exactly if a batch with these options and apertures transmits
/// the ray.
///
/// The clearance is the minimum of 1 - r^2 / R^2 over all rims (R: semi-diameter), of (r^2 - i^2) / R^2 over central
/// obscurations of radius i, and of distance / R over the edges of the iris. It is continuous, and 0 at a rim. A ray
/// stopped by a rim has v / (1 - v), in (-1, 0), with v < 0 the value at that rim: the first such rim with apertures,
/// the narrowest without. A ray lost for another reason has a value below -1, the lower the earlier.
///
/// rays: `count` rays; replaced by their results, as by a batch with out = in. clearances: `count` values.
template <class T>
void clearances(const Lens& lens, std::size_t count, const RayArrays<T>& rays, T* clearances,
                const BatchOptions& options) noexcept;

}  // namespace petzval::trace_detail
