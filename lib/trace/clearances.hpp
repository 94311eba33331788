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
/// blocked by a rim has the clearance v / (1 - v), in (-1, 0), where v < 0 is the value at that rim: at the first such
/// rim with apertures, at the rim with the least value without apertures. A ray lost for another reason has a clearance
/// below -1, which is lower the earlier the ray is lost.
/// @param rays `count` rays, which are replaced by their results, as by a batch with out = in
/// @param clearances `count` values
template <class T>
void clearances(const Lens& lens, std::size_t count, const RayArrays<T>& rays, T* clearances,
                const BatchOptions& options) noexcept;

}  // namespace petzval::trace_detail
