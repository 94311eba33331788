// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/lens/lens.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// How near N rays come to the rims: the least of 1 - r^2 / R^2 over them, R their semi-diameters; at central
/// obscurations of radius i of (r^2 - i^2) / R^2, at the edges of the iris their distance / R. It is not negative
/// exactly for the rays that a batch with these options transmits with apertures.
///
/// 0 at a rim and continuous beside it. Negative for rays that a rim stops, v there gives v / (1 - v) in (-1, 0): with
/// apertures v of the first rim that stops the ray, without of the narrowest. Below -1 for rays that are lost
/// otherwise, lower the earlier.
///
/// rays: N each; they are replaced by their results, as by a batch whose `out` is `in`. clearances: N.
template <class T>
void clearances(const Lens& lens, std::size_t count, const RayArrays<T>& rays, T* clearances,
                const BatchOptions& options) noexcept;

}  // namespace petzval::trace_detail
