// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval::trace_detail {

/// Where N rays meet the stop of a lens that has one, mm: x and y across the axis, 0 for rays that are lost before it.
/// Clear apertures stop none. rays: before the lens, N each; x, y: N.
template <class T>
PETZVAL_API void stop_points(const Lens& lens, std::size_t count, const RayArrays<const T>& rays, T* x, T* y,
                             BatchOptions options) noexcept;

}  // namespace petzval::trace_detail
