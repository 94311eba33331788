// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/export.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// How N rays change with two parameters u and v, such as the steps of a pixel: the derivatives of their points and
/// directions, N values each.
template <class T>
struct RayTangents {
  RayArrays<T> u, v;
};

/// Traces N rays with their exact derivatives (double or float), by the chain rule through every surface: no step has
/// to be chosen, and a neighbour beyond an edge does no harm.
///
/// in, out, fates, surfaces, options: as for `trace`; the rays are the same, to the bit where they are reproducible,
/// else within some ulp. tangents_in: direction derivatives perpendicular to the directions (as those of unit vectors
/// are). tangents_out: of the point on the last surface met and of the unit direction behind it; zero for a ray that is
/// lost, not finite where it leaves along a surface to the last bit and has none. out may be in, and tangents_out
/// tangents_in.
template <class T>
PETZVAL_API void trace_differentials(const Lens& lens, std::size_t count, const RayArrays<const T>& in,
                                     const RayTangents<const T>& tangents_in, const RayArrays<T>& out,
                                     const RayTangents<T>& tangents_out, RayFate* fates, int* surfaces,
                                     const BatchOptions& options = {}) noexcept;

}  // namespace petzval::inline v0
