// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// trace() of one ray with its derivatives by two parameters, as trace_differentials(). by_u, by_v: those of the ray,
/// and behind the lens those of the result; as they were for a lost ray.
template <class T>
PETZVAL_API TracedRay<T> trace_differential(const Lens& lens, const Ray<T>& ray, Ray<T>& by_u, Ray<T>& by_v,
                                            const TraceOptions& options) noexcept;

}  // namespace petzval::trace_detail
