// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/config.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// Traces one ray with its derivatives with respect to two parameters, as trace_differentials().
/// @param by_u, by_v derivatives of the given ray, replaced by the derivatives of the result; unchanged if the ray is
///   lost
template <class T>
PETZVAL_API TracedRay<T> trace_differential(const Lens& lens, const Ray<T>& ray, Ray<T>& by_u, Ray<T>& by_v,
                                            const TraceOptions& options) noexcept;

}  // namespace petzval::trace_detail
